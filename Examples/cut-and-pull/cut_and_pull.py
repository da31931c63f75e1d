# SPDX-License-Identifier: BSD-3-Clause
"""Cuts a brain and pulls the cut open: cut_and_pull.py VOLUME.nii.gz PICTURE.png [SIZE]
draws three pictures side by side: the volume at rest, cut along a sheet, and opened by ChainMail.
Each has SIZE x SIZE pixels (default: 700). Written for ch2better.nii.gz of the package
mricron-data."""
import math
import sys

import deformvolume_vtk
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (rendering backend)
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction, vtkPolyData
from vtkmodules.vtkFiltersSources import vtkPlaneSource
from vtkmodules.vtkIOImage import vtkNIFTIImageReader, vtkPNGWriter
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkCamera,
    vtkColorTransferFunction,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkVolume,
    vtkWindowToImageFilter,
)
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkSmartVolumeMapper

SHEET_X = 99.0  # mm from the first voxel: x to the right, y to the front, z upwards
HANDLES_PER_SIDE = 21


def make_sheet():
    """Makes a vertical sheet along y, from above the brain down into it."""
    sheet = vtkPlaneSource()
    sheet.SetOrigin(SHEET_X, 35.0, 75.0)
    sheet.SetPoint1(SHEET_X, 150.0, 75.0)
    sheet.SetPoint2(SHEET_X, 35.0, 165.0)
    sheet.SetResolution(10, 10)
    return sheet


def make_handles():
    """Makes handles on both sides of the cut, with their positions at rest and after the pull."""
    points = vtkPoints()
    rest = vtkDoubleArray()
    rest.SetName("RestPosition")
    rest.SetNumberOfComponents(3)
    for handle in range(HANDLES_PER_SIDE):
        along = handle / (HANDLES_PER_SIDE - 1)
        pull = 13.0 * math.sin(math.pi * (0.08 + 0.84 * along))
        for side in (-1.0, 1.0):
            start = (SHEET_X + side * 4.0, 48.0 + 90.0 * along, 128.0)
            rest.InsertNextTuple(start)
            points.InsertNextPoint(start[0] + side * pull, start[1], start[2])
    handles = vtkPolyData()
    handles.SetPoints(points)
    handles.GetPointData().AddArray(rest)
    return handles


def make_renderer(volume, column):
    mapper = vtkSmartVolumeMapper()
    mapper.SetInputConnection(volume.GetOutputPort())
    mapper.AutoAdjustSampleDistancesOff()  # the same picture on slow machines
    mapper.SetSampleDistance(0.25)
    opacity = vtkPiecewiseFunction()
    opacity.AddPoint(45.0, 0.0)
    opacity.AddPoint(75.0, 1.0)
    color = vtkColorTransferFunction()
    color.AddRGBPoint(45.0, 0.65, 0.45, 0.42)
    color.AddRGBPoint(110.0, 0.90, 0.72, 0.66)
    color.AddRGBPoint(150.0, 1.0, 0.97, 0.92)
    actor = vtkVolume()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetScalarOpacity(opacity)
    look.SetColor(color)
    look.SetScalarOpacityUnitDistance(0.5)
    look.SetInterpolationTypeToLinear()
    look.ShadeOn()
    look.SetAmbient(0.15)
    look.SetDiffuse(0.8)
    look.SetSpecular(0.0)  # highlights differ between versions of VTK
    renderer = vtkRenderer()
    renderer.SetViewport(column / 3.0, 0.0, (column + 1) / 3.0, 1.0)
    renderer.SetBackground(0.10, 0.12, 0.15)
    renderer.AddVolume(actor)
    return renderer


def make_actor(surface):
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(surface.GetOutputPort())
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(0.75, 0.85, 0.95)
    actor.GetProperty().SetAmbient(0.4)
    return actor


def deform(volume, field, scale):
    deformed = deformvolume_vtk.vtkDeformVolumeFilter()
    deformed.SetInputConnection(volume.GetOutputPort())
    deformed.SetDeformationConnection(field.GetOutputPort())
    deformed.SetInputArrayToProcess(0, 1, 0, 0, "Displacement")
    deformed.SetDisplacementScale(scale)
    return deformed


if len(sys.argv) not in (3, 4):
    sys.exit("usage: cut_and_pull.py VOLUME.nii.gz PICTURE.png [SIZE]")
size = int(sys.argv[3]) if len(sys.argv) > 3 else 700

reader = vtkNIFTIImageReader()
reader.SetFileName(sys.argv[1])
sheet = make_sheet()
cut = deformvolume_vtk.vtkCutVolume()
cut.SetInputConnection(reader.GetOutputPort())
cut.SetSheetConnection(sheet.GetOutputPort())
chain_mail = deformvolume_vtk.vtkChainMailDeformation()
chain_mail.SetInputConnection(cut.GetOutputPort())
chain_mail.SetHandlesData(make_handles())
chain_mail.SetHandleRadius(3.0)
chain_mail.SetRelaxationSweeps(20)
opened = deform(cut, chain_mail, 1.0)
closed = deform(cut, chain_mail, 0.0)

camera = vtkCamera()  # in front of and above the brain
camera.SetFocalPoint(75.0, 92.0, 78.0)
camera.SetPosition(190.0, 250.0, 395.0)
camera.SetViewUp(0.0, -1.0, 0.5)
camera.SetViewAngle(29.0)
window = vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetMultiSamples(0)
window.SetSize(3 * size, size)
for column, shown in enumerate((reader, closed, opened)):
    renderer = make_renderer(shown, column)
    if shown is closed:
        renderer.AddActor(make_actor(sheet))
    renderer.SetActiveCamera(camera)
    renderer.ResetCameraClippingRange()
    window.AddRenderer(renderer)
picture = vtkWindowToImageFilter()
picture.SetInput(window)
writer = vtkPNGWriter()
writer.SetInputConnection(picture.GetOutputPort())
writer.SetFileName(sys.argv[2])
writer.Write()
print(f"{cut.GetNumberOfSwitchedOffTetrahedra()} tetrahedra cut, "
      f"{chain_mail.GetNumberOfMovedVoxels()} voxels pulled, "
      f"{opened.GetNumberOfInvertedTetrahedra()} tetrahedra inverted")
