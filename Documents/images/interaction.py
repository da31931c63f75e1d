# SPDX-License-Identifier: BSD-3-Clause
"""Makes interaction.png and interaction.gif beside this file: events of a window that deform-interactive
replays, of ch2 of the package mricron-data. Usage: interaction.py PROGRAM, with an X display."""
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image

here = pathlib.Path(__file__).parent
sys.path.insert(0, str(here / ".." / ".." / "Testing" / "Examples"))
from WindowEvents import WindowEvents  # noqa: E402

SIZE = (720, 540)
STEP = 2  # one of so many frames is in the animation

events = WindowEvents().keys("2..").wait(1)
events.keys("c").stroke((300, 330), (370, 345), (450, 330), steps=6).wait(1)
events.keys("v--").stroke((270, 400), (330, 425), (400, 425), steps=6).wait(1)
events.keys("g").stroke((370, 325), (400, 275), (425, 235), steps=8, shift=True).wait(6)
events.turn((360, 270), (300, 270), steps=8).wait(2)
with tempfile.TemporaryDirectory() as folder:
    events.write(folder + "/events.log")
    subprocess.run(
        [sys.argv[1], "--size", f"{SIZE[0]},{SIZE[1]}", "--replay", folder + "/events.log", "--frames",
         folder, "--screenshot", str(here / "interaction.png")],
        check=True,
    )
    paths = sorted(pathlib.Path(folder).glob("frame*.png"))
    frames = [Image.open(path).convert("RGB").resize((480, 360)) for path in paths[::STEP]]
palette = frames[-1].quantize(96)  # one for all, so that colours do not flicker
frames = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
frames[0].save(here / "interaction.gif", save_all=True, append_images=frames[1:], duration=150, loop=0,
               optimize=True)
