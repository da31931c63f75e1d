# SPDX-License-Identifier: BSD-3-Clause
"""Draws paraview-window.png and paraview-before-after.png, the pictures of Documents/paraview.md.

Usage: pvpython paraview_pictures.py <ParaView's client> <DeformVolume.so> <NIfTI plugin>

Needs xvfb and the packages mricron-data, python3-numpy and, for the icons of the client, libqt5svg5.
ParaView comes with the plugin for NIfTI files: AnalyzeNIfTIReaderWriter.so. The client runs this file,
too, for the pipeline of the worked example.
"""

import gzip
import os
import signal
import subprocess
import sys
import tempfile
import time

import numpy
from paraview import simple
from vtkmodules.util import numpy_support
from vtkmodules.vtkIOImage import vtkPNGReader

MRI = "/usr/share/mricron/templates/ch2.nii.gz"
FILE = os.path.abspath(__file__)
HERE = os.path.dirname(FILE)
SIZE = (1280, 800)

sys.path.insert(0, os.path.join(HERE, "..", "..", "Testing", "ParaView"))
from XWindowDump import read_window_dump, write_png  # noqa: E402


def make_pipeline(folder, plugins):
    """In the client: the worked example, up to the last Apply."""
    for plugin in plugins:
        simple.LoadPlugin(plugin, ns=vars(simple))
    head = simple.OpenDataFile(os.path.join(folder, "ch2.nii"))
    simple.RenameSource("ch2.nii", head)
    head.UpdatePipeline()
    view = simple.GetActiveViewOrCreate("RenderView")
    view.OrientationAxesVisibility = 0
    view.UseColorPaletteForBackground = 0
    view.Background = [0.18, 0.19, 0.25]

    name = head.PointData.keys()[0]
    shown = simple.Show(head, view)
    shown.SetRepresentationType("Volume")
    simple.ColorBy(shown, ("POINTS", name))
    shown.Shade = 1
    colors = simple.GetColorTransferFunction(name)
    colors.RGBPoints = [0.0, 0.1, 0.0, 0.0, 60.0, 0.8, 0.5, 0.3, 160.0, 1.0, 1.0, 0.9]
    points = [(0.0, 0.0), (30.0, 0.0), (90.0, 0.5), (160.0, 0.9)]
    opacity = simple.GetOpacityTransferFunction(name)
    opacity.Points = [item for value, amount in points for item in (value, amount, 0.5, 0.0)]

    lattice = simple.TetrahedralLatticeOfVolume(Volume=head)
    displaced = simple.Calculator(Input=lattice)
    displaced.ResultArrayName = "Displacement"
    displaced.Function = "-45*exp(-((coordsX-90)^2+(coordsZ-60)^2)/2000)*jHat"
    displaced.UpdatePipeline()
    deformed = simple.DeformVolume(Volume=head, Deformation=displaced)
    after = simple.Show(deformed, view)
    after.Shade = 1

    view.CameraFocalPoint = [90.0, 108.0, 90.0]
    view.CameraPosition = [450.0, 480.0, 180.0]
    view.CameraViewUp = [0.0, 0.0, 1.0]
    view.CameraViewAngle = 28.0
    for source, other, picture in ((head, deformed, "before"), (deformed, head, "after")):
        simple.Show(source, view)
        simple.Hide(other, view)
        path = os.path.join(folder, picture + ".png")
        simple.SaveScreenshot(path, view, ImageResolution=[300, 300])
    simple.SetActiveSource(deformed)
    simple.Render(view)
    with open(os.path.join(folder, "process"), "w", encoding="ascii") as file:
        file.write(str(os.getpid()))


def start_client(client, plugins, folder):
    settings = os.path.join(folder, ".config", "ParaView")
    os.makedirs(settings)
    manager = simple.servermanager.vtkSMProxyManager
    version = f"{manager.GetVersionMajor()}.{manager.GetVersionMinor()}.{manager.GetVersionPatch()}"
    with open(os.path.join(settings, f"ParaView{version}.ini"), "w", encoding="ascii") as file:
        file.write("[General]\nGeneralSettings.ShowWelcomeDialog=false\n")
    with gzip.open(MRI) as packed, open(os.path.join(folder, "ch2.nii"), "wb") as file:
        file.write(packed.read())
    script = os.path.join(folder, "script.py")
    with open(script, "w", encoding="utf-8") as file:
        file.write(
            f"names = {{'__name__': 'pictures', '__file__': {FILE!r}}}\n"
            f"exec(open({FILE!r}).read(), names)\n"
            f"names['make_pipeline']({folder!r}, {plugins!r})\n"
        )
    environment = dict(os.environ, HOME=folder, XDG_CONFIG_HOME=os.path.join(folder, ".config"))
    screen = f"-noreset -screen 0 {SIZE[0]}x{SIZE[1]}x24 -fbdir {folder}"
    return subprocess.Popen(
        ["xvfb-run", "-a", "-s", screen, client, "-geometry", f"{SIZE[0]}x{SIZE[1]}+0+0"]
        + [f"--script={script}"],
        stdin=subprocess.DEVNULL,
        env=environment,
    )


def main(client, *plugins):
    with tempfile.TemporaryDirectory() as folder:
        process = start_client(client, plugins, folder)
        marker = os.path.join(folder, "process")
        while not os.path.exists(marker) or not os.path.getsize(marker):
            if process.poll() is not None:
                sys.exit("The client has ended")
            time.sleep(0.5)
        time.sleep(15.0)  # the event loop fills the panels and draws the view
        window = read_window_dump(os.path.join(folder, "Xvfb_screen0"))
        with open(marker, encoding="ascii") as file:
            os.kill(int(file.read()), signal.SIGKILL)
        process.wait()
        pictures = []
        for name in ("before", "after"):
            reader = vtkPNGReader()
            reader.SetFileName(os.path.join(folder, name + ".png"))
            reader.Update()
            values = numpy_support.vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
            width, height, _ = reader.GetOutput().GetDimensions()
            pictures.append(values.reshape(height, width, -1)[::-1, :, :3])
    write_png(window, os.path.join(HERE, "paraview-window.png"))
    write_png(numpy.hstack(pictures), os.path.join(HERE, "paraview-before-after.png"))


if __name__ == "__main__":
    main(*sys.argv[1:])
