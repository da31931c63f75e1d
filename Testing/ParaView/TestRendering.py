# SPDX-License-Identifier: BSD-3-Clause
"""Tests that the output of the filter is drawn as a volume, in the colors of its input: the MRI of a head, pushed in
from the front."""

import os
import sys

import numpy
from paraview import simple

from Baselines import read_picture
from PluginTesting import (
    OUTPUT,
    bent_lattice,
    check,
    check_messages,
    check_silent,
    head_file,
    load_plugin,
    messages,
    wavelet,
)


def main(baseline):
    load_plugin()
    head = simple.OpenDataFile(head_file())
    head.UpdatePipeline()
    name = head.PointData.keys()[0]
    view = simple.GetActiveViewOrCreate("RenderView")
    view.ViewSize = [300, 300]
    view.OrientationAxesVisibility = 0
    view.UseColorPaletteForBackground = 0
    view.Background = [0.2, 0.2, 0.3]

    # The user has chosen colors for the volume at rest.
    shown = simple.Show(head, view)
    shown.SetRepresentationType("Volume")
    simple.ColorBy(shown, ("POINTS", name))
    colors = simple.GetColorTransferFunction(name)
    colors.RGBPoints = [0.0, 0.1, 0.0, 0.0, 60.0, 0.8, 0.5, 0.3, 160.0, 1.0, 1.0, 0.9]
    # The default differs between versions.
    colors.ColorSpace = "Diverging"
    opacity = simple.GetOpacityTransferFunction(name)
    points = [(0.0, 0.0), (30.0, 0.0), (90.0, 0.5), (160.0, 0.9)]
    opacity.Points = [item for value, amount in points for item in (value, amount, 0.5, 0.0)]

    mesh = bent_lattice(
        head, nodes=13, function="-45*exp(-((coordsX-90)^2+(coordsZ-60)^2)/2000)*jHat"
    )
    deformed = simple.DeformVolume(Volume=head, Deformation=mesh)
    representation = simple.Show(deformed, view)
    simple.Hide(head, view)
    check(representation.Representation == "Volume", f"Shown as {representation.Representation}")
    check(
        list(representation.ColorArrayName) == ["POINTS", name],
        f"Colored by {list(representation.ColorArrayName)}",
    )
    check(representation.LookupTable.SMProxy == colors.SMProxy, "The colors are not the input's")
    representation.Shade = 1

    view.CameraFocalPoint = [90.0, 108.0, 90.0]
    view.CameraPosition = [450.0, 480.0, 180.0]
    view.CameraViewUp = [0.0, 0.0, 1.0]
    view.CameraViewAngle = 28.0
    picture = os.path.join(OUTPUT, "TestParaViewRendering.png")
    simple.SaveScreenshot(picture, view, ImageResolution=[300, 300])
    check(os.path.exists(baseline), f"There is no {baseline}; look at {picture}")
    shown, expected = read_picture(picture), read_picture(baseline)
    check(shown.shape == expected.shape, f"{picture} has another size than {baseline}")
    # If the head is pushed in by 3 voxels less, the picture differs by 1.1; if it is shifted, by 1.4; if it is not
    # deformed, by 6.1. Pictures of different renderers differ by 0.001.
    error = numpy.abs(shown - expected).mean()
    check(error < 0.1, f"{picture} differs from {baseline} by {error} of 255 on average")


    # Each view displays the error when it updates.
    deformed.Device = "no such device"
    with messages() as texts:
        simple.Render(view)
    check_messages(texts, ["no such device"])
    deformed.Device = ""
    with messages() as texts:
        failing = simple.DeformVolume(Volume=head, Deformation=mesh, MemoryLimit=1000.0)
        simple.Show(failing, view)
        simple.Render(view)
    check_messages(texts, ["Not enough memory"])
    simple.Delete(failing)

    # With valid settings the output is shown, also after an error.
    volume = wavelet(6)
    small = simple.DeformVolume(Volume=volume, Deformation=bent_lattice(volume))
    representation = simple.Show(small, view)
    output = small.GetClientSideObject().GetOutputDataObject
    for kind in ("Surface", "Volume", "Slice", "Outline"):
        representation.SetRepresentationType(kind)
        simple.Render(view)
        for name, wrong, words, right in (
            ("MemoryLimit", 1000.0, "Not enough memory", 0.0),
            ("Device", "no such device", "no such device", "best"),
            ("MemoryLimit", 1000.0, "Not enough memory", 0.0),
        ):
            with messages() as texts:
                setattr(small, name, wrong)
                simple.Render(view)
            check_messages(texts, [words])
            check(output(0).GetNumberOfPoints() == 0, f"{kind}: an error and an output")
            with messages() as texts:
                setattr(small, name, right)
                simple.Render(view)
            check_silent(texts)
            check(output(0).GetNumberOfPoints() > 0, f"{kind}: after the correction, {name} is not shown")


main(sys.argv[1])
