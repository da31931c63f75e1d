# SPDX-License-Identifier: BSD-3-Clause
"""Tests pictures of the plugin's filters. A scene passes if it is within its limit of the baseline, and if a wrong
variant and the scene shifted by one voxel differ from the baseline by at least twice the limit.

Usage: TestScenes.py FOLDER_OF_BASELINES [--update]"""

import os
import sys

import numpy
from paraview import simple
from vtkmodules.util import numpy_support
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkPNGWriter

from Baselines import read_picture
from PluginTesting import OUTPUT, bent_lattice, check, load_plugin, wavelet

BEND = "(0.04*coordsZ*coordsZ-2+%d)*iHat+0.1*coordsX*kHat"
FINE = {"OutputSpacingMode": "Custom Spacing", "CustomSpacing": [0.25] * 3, "Padding": 1}


def deform(volume, function, version, **properties):
    """Returns a volume with a fine spacing that a lattice deforms by a function."""
    shift = 1 if version == "shifted" else 0
    mesh = bent_lattice(volume, nodes=11, function=function % shift)
    return simple.DeformVolume(Volume=volume, Deformation=mesh, **FINE, **properties)


def show(view, source, array=None):
    shown = simple.Show(source, view)
    shown.SetRepresentationType("Surface")
    if array is None:
        simple.ColorBy(shown, None)
        shown.DiffuseColor = [0.9, 0.75, 0.6]
    else:
        simple.ColorBy(shown, ("POINTS", array))
        colors = simple.GetColorTransferFunction(array)
        colors.ColorSpace = "RGB"
        colors.RGBPoints = [50, 0.1, 0.2, 0.5, 150, 0.95, 0.9, 0.7, 280, 0.6, 0.1, 0.1]
        shown.SetScalarBarVisibility(view, False)
        shown.Ambient, shown.Diffuse = 1.0, 0.0


def show_slice(view, source):
    cut = simple.Slice(Input=source)
    cut.SliceType.Origin, cut.SliceType.Normal = [0.0, 0.1, 0.0], [0.0, 1.0, 0.0]
    body = simple.Threshold(Input=cut, Scalars=["POINTS", "vtkValidPointMask"])
    body.LowerThreshold, body.UpperThreshold = 1.0, 1.0
    show(view, body, "RTData")
    return [0.0, -90.0, 0.0], 32.0


def draw_slice(view, version):
    """Draws a slice. Wrong variant: the deformation has the opposite direction."""
    scale = -1.0 if version == "spoiled" else 1.0
    source = deform(wavelet(), BEND, version, DisplacementScale=scale)
    return show_slice(view, source)


def draw_contour(view, version):
    """Draws an isosurface. Wrong variant: samples have the values of single voxels."""
    names = ["RTData"] if version == "spoiled" else []
    source = deform(wavelet(), BEND, version, CategoricalArrays=names)
    contour = simple.Contour(Input=source, ContourBy=["POINTS", "RTData"], Isosurfaces=[157.0])
    show(view, contour)
    return [30.0, -80.0, 40.0], 30.0


def draw_edits(view, version):
    """Draws a cube that is cut, opened and carved. Wrong variant: whole tetrahedra are left out."""
    is_smooth = 0 if version == "spoiled" else 1
    volume = wavelet()
    plane = simple.Plane()
    plane.Origin, plane.Point1, plane.Point2 = [-5.3, -20, -20], [3.7, 20, -20], [-5.3, -20, 20]
    cut = simple.CutVolume(Volume=volume, Sheet=plane, SmoothCut=is_smooth)
    carve = simple.CarveVolume(Volume=cut, SmoothBoundary=is_smooth)
    carve.Body = "Sphere"
    carve.Body.Center, carve.Body.Radius = [5.0, -10.0, 4.0], 5.0
    side = "coordsX+5.3-9*(coordsY+20)/40"
    field = simple.Calculator(Input=volume, ResultArrayName="Displacement")
    field.Function = "(if(%s<0,-2,2)+%d)*iHat" % (side, version == "shifted")
    field.UpdatePipeline()
    source = simple.DeformVolume(Volume=carve, Deformation=field, **FINE)
    source.DisplacementArray = "Displacement"
    contour = simple.Contour(Input=source, ContourBy=["POINTS", "RTData"], Isosurfaces=[18.0])
    show(view, contour)
    return [20.0, -80.0, 60.0], 36.0


def draw_hidden(view, version):
    """Draws a volume that is cut and carved, without Deform Volume. Wrong variant: the volume is whole."""
    shift = 1 if version == "shifted" else 0
    is_blank = 0 if version == "spoiled" else 1
    volume = wavelet()
    volume.UpdatePipeline()
    cut = simple.CutVolumeWithPlane(Volume=volume, BlankCells=is_blank)
    cut.Plane.Center, cut.Plane.Normal = [-3.5 + shift, 0, 0], [1, 0.2, 0]
    carve = simple.CarveVolume(Volume=cut, BlankCells=is_blank)
    carve.Body.Center, carve.Body.Radius = [4 + shift, -10, 4], 5
    shown = simple.Show(carve, view)
    check(shown.Representation == "Volume", f"It is shown as {shown.Representation}")
    simple.ColorBy(shown, ("POINTS", "RTData"))
    colors = simple.GetColorTransferFunction("RTData")
    colors.ColorSpace = "RGB"
    colors.RGBPoints = [50, 0.1, 0.2, 0.5, 150, 0.95, 0.9, 0.7, 280, 0.6, 0.1, 0.1]
    simple.GetOpacityTransferFunction("RTData").Points = [0, 0.7, 0.5, 0, 300, 0.9, 0.5, 0]
    shown.SetScalarBarVisibility(view, False)
    return [20.0, -80.0, 60.0], 32.0


def draw_chain_mail(view, version):
    """Draws a volume whose stiff middle is dragged in soft tissue. Wrong variant: the middle is soft."""
    volume = wavelet()
    handle = simple.DeformationHandle(RestPosition=[0, 0, 0], Position=[4, 0, 3])
    drag = simple.ChainMailDeformation(Volume=volume, Handles=handle)
    drag.MaterialRanges = [] if version == "spoiled" else [190, 1000, 4]
    field = simple.Calculator(Input=drag, ResultArrayName="Displacement")
    field.Function = "Displacement+%d*iHat" % (version == "shifted")
    field.UpdatePipeline()
    source = simple.DeformVolume(Volume=volume, Deformation=field, **FINE)
    source.DisplacementArray = "Displacement"
    return show_slice(view, source)


# Limits of the mean difference, 0 to 255: at most half of the smaller difference of the two pictures that must fail.
SCENES = {
    "ParaViewSlice": (draw_slice, 2.5),
    "ParaViewContour": (draw_contour, 2.8),
    "ParaViewEdits": (draw_edits, 1.2),
    "ParaViewHidden": (draw_hidden, 3.0),
    "ParaViewChainMail": (draw_chain_mail, 3.0),
}


def draw(scene, version, path):
    view = simple.CreateView("RenderView")
    view.ViewSize = [300, 300]
    view.OrientationAxesVisibility = 0
    view.UseColorPaletteForBackground = 0
    view.Background = [0.15, 0.2, 0.3]
    position, height = scene(view, version)
    view.CameraParallelProjection = 1
    view.CameraParallelScale = 0.5 * height
    view.CameraFocalPoint = [0.0, 0.0, 0.0]
    view.CameraPosition = position
    view.CameraViewUp = [0.0, 0.0, 1.0]
    simple.SaveScreenshot(path, view, ImageResolution=[300, 300])
    simple.Delete(view)
    for source in reversed(list(simple.GetSources().values())):
        simple.Delete(source)


def write(path, values):
    image = vtkImageData()
    image.SetDimensions(values.shape[1], values.shape[0], 1)
    pixels = numpy.ascontiguousarray(values.reshape(-1, values.shape[2]))
    image.GetPointData().SetScalars(numpy_support.numpy_to_vtk(pixels, deep=True))
    writer = vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputData(image)
    writer.Write()


def main(baselines, is_update):
    load_plugin()
    wrong = []
    for name, (scene, limit) in SCENES.items():
        baseline = os.path.join(baselines, name + ".png")
        if is_update:
            draw(scene, "intact", baseline)
        expected = read_picture(baseline)
        for version in ("intact", "spoiled", "shifted"):
            path = os.path.join(OUTPUT, f"{name}.{version}.png")
            draw(scene, version, path)
            differences = numpy.abs(read_picture(path) - expected)
            mean = differences.mean()
            print(f"{name} {version}: difference {mean:.6g}, limit {limit}")
            if not (mean <= limit if version == "intact" else mean >= 2.0 * limit):
                write(path.replace(".png", ".difference.png"), differences.astype(numpy.uint8))
                wrong.append(path)
    check(not wrong, "Wrong, with pictures of the differences beside them: " + ", ".join(wrong))


main(sys.argv[1], "--update" in sys.argv)
