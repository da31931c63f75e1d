# SPDX-License-Identifier: BSD-3-Clause
"""Makes interaction.png and interaction.gif beside this file: events of a window that deform-interactive
replays, of ch2 of the package mricron-data. Usage: interaction.py PROGRAM, with an X display."""
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image

here = pathlib.Path(__file__).parent
sys.path.insert(0, str(here / ".." / ".." / "Testing" / "Examples" / "Support"))
from WindowEvents import WindowEvents  # noqa: E402

SIZE = (800, 600)


def replay(events, folder, *options):
    events.write(folder + "/events.log")
    subprocess.run([sys.argv[1], "--size", f"{SIZE[0]},{SIZE[1]}", "--replay", folder + "/events.log",
                    *options], check=True)


events = WindowEvents().keys("i2..").wait(1)
events.keys("c").stroke((331, 362), (412, 381), (500, 362), steps=4).wait(1)
events.keys("v--").stroke((281, 388), (362, 438), (438, 438), steps=3).wait(1)
events.keys("g").stroke((412, 360), (447, 306), (472, 261), steps=5, shift=True).wait(6)
events.turn((400, 300), (362, 275), steps=5).wait(2)
with tempfile.TemporaryDirectory() as folder:
    replay(events, folder, "--frames", folder)
    paths = sorted(pathlib.Path(folder).glob("frame*.png"))
    frames = [Image.open(path).convert("RGB").resize((480, 360)) for path in paths]
palette = frames[-1].quantize(96)  # one for all, so that colors do not flicker
frames = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
frames[0].save(here / "interaction.gif", save_all=True, append_images=frames[1:], duration=150, loop=0,
               optimize=True)
with tempfile.TemporaryDirectory() as folder:
    # Until tissue rests, and is drawn at full resolution.
    replay(events.wait(40), folder, "--screenshot", str(here / "interaction.png"))
