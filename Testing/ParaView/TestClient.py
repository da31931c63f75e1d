# SPDX-License-Identifier: BSD-3-Clause
"""Tests the graphical client in an X server of its own: it loads the plugin and a state, shows the volume as pvpython
does, and reports one error for a filter with a mesh at rest but without a deformation."""

import os
import re
import shutil
import signal
import subprocess
import time

import numpy
from paraview import simple
from vtkmodules.util import numpy_support
from vtkmodules.vtkIOImage import vtkPNGReader

from PluginTesting import OUTPUT, PLUGIN, bent_lattice, check, load_plugin, wavelet
from XWindowDump import read_window_dump, write_png

FOLDER = os.path.join(OUTPUT, "TestClient")
STATE = os.path.join(FOLDER, "state.pvsm")
MARKER = os.path.join(FOLDER, "process")
LOG = os.path.join(FOLDER, "log.txt")
SIZE = [320, 240]

# The client runs this script. It cannot load a state and run a script, so the script loads the state.
SCRIPT = """
import os
from paraview import servermanager, simple
simple.LoadState({state!r})
filter_ = [item for item in simple.GetSources().values() if item.GetXMLName() == "DeformVolume"][0]
simple.SetActiveSource(filter_)
view = simple.GetActiveView()
simple.Render(view)
simple.SaveScreenshot({picture!r}, view, ImageResolution={size})
wrong = servermanager.filters.DeformVolume(Volume=filter_.Volume, RestMesh=filter_.Deformation)
wrong.UpdatePipeline()
with open({marker!r} + ".new", "w") as file:
    file.write(str(os.getpid()))
os.rename({marker!r} + ".new", {marker!r})
"""


def read_png(path):
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    values = numpy_support.vtk_to_numpy(image.GetPointData().GetScalars())
    width, height, _ = image.GetDimensions()
    return values.reshape(height, width, -1)[..., :3].astype(float)


def save_state():
    load_plugin()
    volume = wavelet(20)
    mesh = bent_lattice(volume, function="0.02*coordsY*coordsY*iHat")
    view = simple.GetActiveViewOrCreate("RenderView")
    view.OrientationAxesVisibility = 0
    simple.Show(simple.DeformVolume(Volume=volume, Deformation=mesh), view)
    simple.ResetCamera(view)
    picture = os.path.join(FOLDER, "pvpython.png")
    simple.SaveScreenshot(picture, view, ImageResolution=SIZE)
    simple.SaveState(STATE)
    return read_png(picture)


def start_client():
    home = os.path.join(FOLDER, "home")
    # These settings disable the welcome dialog, and replace those of the user.
    settings = os.path.join(home, ".config", "ParaView")
    os.makedirs(settings)
    version = ".".join(
        str(getattr(simple.servermanager.vtkSMProxyManager, f"GetVersion{part}")())
        for part in ("Major", "Minor", "Patch")
    )
    # ParaView 6.1 has one settings file for all versions. Earlier versions have one file for each version.
    for name in (f"ParaView{version}.ini", "ParaView.ini"):
        with open(os.path.join(settings, name), "w", encoding="ascii") as file:
            file.write("[General]\nGeneralSettings.ShowWelcomeDialog=false\n")
    script = os.path.join(FOLDER, "script.py")
    with open(script, "w", encoding="utf-8") as file:
        picture = os.path.join(FOLDER, "client.png")
        file.write(SCRIPT.format(state=STATE, picture=picture, size=SIZE, marker=MARKER))
    environment = dict(os.environ, HOME=home, XDG_CONFIG_HOME=os.path.join(home, ".config"))
    display = f"-noreset -screen 0 1152x764x24 -fbdir {FOLDER}"
    plugins = os.path.dirname(PLUGIN)
    with open(LOG, "w", encoding="utf-8") as log:
        return subprocess.Popen(
            ["xvfb-run", "-a", "-s", display, os.environ["DEFORMVOLUME_CLIENT"]]
            + [f"--plugin-search-paths={plugins}", "--plugins=DeformVolume"]
            + [f"--script={script}"],
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            env=environment,
        )


def client_log():
    with open(LOG, encoding="utf-8", errors="replace") as log:
        return log.read()


def check_picture(picture, what):
    """Checks that a large part of the picture is drawn, and in more than one color."""
    background = numpy.median(picture.reshape(-1, 3), axis=0)
    covered = numpy.abs(picture - background).max(axis=2) > 30.0
    check(covered.mean() > 0.1, f"{what} is drawn in {covered.mean()} of the pixels only")
    spread = picture[covered].std(axis=0).max()
    check(spread > 10.0, f"{what} has one color only: the standard deviation is {spread}")


def main():
    shutil.rmtree(FOLDER, ignore_errors=True)
    os.makedirs(FOLDER)
    expected = save_state()
    check_picture(expected, "pvpython's view")
    client = start_client()
    try:
        end = time.monotonic() + 120.0
        while not os.path.exists(MARKER):
            check(
                client.poll() is None
                and time.monotonic() < end
                and "Traceback" not in client_log(),
                f"The client has not started: {client_log()}",
            )
            time.sleep(0.2)
        # The event loop continues meanwhile: the client fills panels and draws the view.
        time.sleep(4.0)
        check(client.poll() is None, f"The client has ended: {client_log()}")
        window = read_window_dump(os.path.join(FOLDER, "Xvfb_screen0"))
    finally:
        if os.path.exists(MARKER):
            with open(MARKER, encoding="ascii") as file:
                os.kill(int(file.read()), signal.SIGKILL)
        else:
            client.terminate()
        client.wait(timeout=30)
    write_png(window, os.path.join(FOLDER, "window.png"))
    check_picture(window.astype(float), "The client's window")
    check(len(numpy.unique(window.reshape(-1, 3), axis=0)) > 1000, "The window has 1000 colors or fewer")

    shown = read_png(os.path.join(FOLDER, "client.png"))
    check_picture(shown, "The client's view")
    difference = numpy.abs(shown - expected).mean()
    # Moved by one pixel, the picture differs by 0.7.
    check(difference < 0.3, f"Client and pvpython differ by {difference} of 255 on average")
    # Leave out the messages of VTK's executive, which state the request that has failed.
    errors = [error for error in re.findall(r"ERR\|.*", client_log())
              if "returned failure for request" not in error]
    check(
        errors and all("no deformation on input port 1" in error for error in errors),
        f"Expected errors about the missing deformation only: {client_log()}",
    )


main()
