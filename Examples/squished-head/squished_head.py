# SPDX-License-Identifier: BSD-3-Clause
"""Pulls a head by its nose: squished_head.py VOLUME.nii.gz PICTURE.png [SIZE]
draws three pictures side by side: the head at rest, in equilibrium by finite elements, and after
half a second of mass-spring dynamics. Each has SIZE x SIZE pixels (default: 700). The values of the
voxels say where the head is stiff bone and where it is soft tissue. Written for ch2.nii.gz of the
package mricron-data. Coordinates are in mm from the first voxel: x to the right, y to the front,
z upwards."""
import sys

import deformvolume_vtk
import numpy
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (rendering backend)
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction, vtkUnstructuredGrid
from vtkmodules.vtkFiltersCore import vtkConnectivityFilter, vtkThreshold
from vtkmodules.vtkImagingMorphological import vtkImageContinuousDilate3D
from vtkmodules.vtkIOImage import vtkNIFTIImageReader, vtkPNGWriter
from vtkmodules.vtkRenderingCore import (
    vtkCamera,
    vtkColorTransferFunction,
    vtkRenderer,
    vtkRenderWindow,
    vtkVolume,
    vtkWindowToImageFilter,
)
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkSmartVolumeMapper

NOSE = numpy.array((90.0, 207.0, 32.0))
NOSE_RADIUS = 18.0
PULL = numpy.array((0.0, 30.0, 8.0))
FRAMES = 30
AIR, SOFT, BONE = range(3)
AIR_DENSITY = 100.0


def find_fault(reader):
    """Returns why the volume of a reader is not a head like ch2.nii.gz; "" if it is."""
    if not reader.CanReadFile(reader.GetFileName()):
        return "there is no such file, or it is not a NIfTI file"
    reader.Update()
    volume = reader.GetOutput()
    values = volume.GetPointData().GetScalars()
    if reader.GetErrorCode() != 0 or values is None:
        return "its data are damaged or not complete"
    voxel = volume.FindPoint(NOSE)
    if voxel < 0 or not values.GetComponent(voxel, 0) >= 1.0:
        return ("it has no nose 90 mm to the right, 207 mm to the front and 32 mm above its first voxel, "
                "where ch2.nii.gz has it")
    return ""


def make_mesh(volume, cells):
    """Makes a mesh of cubes, each of five tetrahedra, which have the materials of their voxels.
    cells: number of cubes along x. Leaves out tetrahedra that hold air only, and noise in a corner
    of the volume."""
    lattice = deformvolume_vtk.vtkLatticeTetrahedraSource()
    lattice.SetInputConnection(volume)
    lattice.SetNumberOfNodes(cells + 1, cells // 5 * 6 + 1, cells + 1)
    # The outermost voxels of the skin are as dark as bone. The dilation gives them the value of a
    # brighter neighbor. Bone is thick enough to remain.
    brighter = vtkImageContinuousDilate3D()
    brighter.SetInputConnection(volume)
    brighter.SetKernelSize(3, 3, 3)
    material = deformvolume_vtk.vtkMaterialFromVolume()
    material.SetInputConnection(lattice.GetOutputPort())
    material.SetVolumeConnection(brighter.GetOutputPort())
    material.ClearMaterials()
    material.SetMaterial(AIR, 100.0, 0.25, AIR_DENSITY)  # in Pa and kg/m^3
    material.SetMaterial(SOFT, 1e4, 0.3, 1000.0)
    material.SetMaterial(BONE, 1e6, 0.3, 1900.0)
    material.AddMaterialRange(0.0, 1.0, AIR)
    material.AddMaterialRange(1.0, 30.0, BONE)
    material.AddMaterialRange(30.0, 256.0, SOFT)
    body = vtkThreshold()
    body.SetInputConnection(material.GetOutputPort())
    body.SetInputArrayToProcess(0, 0, 0, 1, "Density")
    body.SetThresholdFunction(vtkThreshold.THRESHOLD_UPPER)
    body.SetUpperThreshold(1.01 * AIR_DENSITY)
    largest = vtkConnectivityFilter()
    largest.SetInputConnection(body.GetOutputPort())
    largest.SetExtractionModeToLargestRegion()
    largest.Update()
    mesh = vtkUnstructuredGrid()
    mesh.ShallowCopy(largest.GetOutput())
    # The lowest plane of the volume goes through the neck.
    heights = vtk_to_numpy(mesh.GetPoints().GetData())[:, 2]
    fixed = numpy_to_vtk((heights < 1.0).astype(numpy.uint8), deep=True)
    fixed.SetName("Fixed")
    mesh.GetPointData().AddArray(fixed)
    return mesh


def move_handle(handle, part):
    """Moves the handle in the nose by a fraction of PULL. part: 0 to 1."""
    handle.SetRestPosition(*NOSE)
    handle.SetPosition(*(NOSE + part * PULL))


def hold(body, mesh):
    body.SetInputData(mesh)
    body.SetHandleRadius(NOSE_RADIUS)
    body.SetLengthUnitToMillimetre()


def deform(volume, body, scale):
    deformed = deformvolume_vtk.vtkDeformVolumeFilter()
    deformed.SetInputConnection(volume)
    deformed.SetDeformationConnection(body.GetOutputPort())
    deformed.SetInputArrayToProcess(0, 1, 0, 0, "Displacement")
    deformed.SetDisplacementScale(scale)
    deformed.SetPadding(2)  # a border, so that the skin is closed at the bounds of the volume
    return deformed


def make_renderer(volume, column):
    mapper = vtkSmartVolumeMapper()
    mapper.SetInputConnection(volume.GetOutputPort())
    mapper.AutoAdjustSampleDistancesOff()  # the same picture on slow machines
    mapper.SetSampleDistance(0.5)
    opacity = vtkPiecewiseFunction()
    opacity.AddPoint(25.0, 0.0)
    opacity.AddPoint(55.0, 1.0)
    color = vtkColorTransferFunction()
    color.AddRGBPoint(25.0, 0.87, 0.62, 0.51)
    color.AddRGBPoint(110.0, 0.96, 0.82, 0.72)
    color.AddRGBPoint(200.0, 1.0, 1.0, 0.98)
    actor = vtkVolume()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetScalarOpacity(opacity)
    look.SetColor(color)
    look.SetScalarOpacityUnitDistance(1.0)
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


def find_largest_difference(first, second):
    """Returns the largest distance, in mm, between the displacements that two models give to a
    common node of their meshes."""
    found = []
    for body in (first, second):
        points = vtk_to_numpy(body.GetOutput().GetPoints().GetData())
        vectors = vtk_to_numpy(body.GetOutput().GetPointData().GetArray("Displacement")).astype(float)
        found.append(dict(zip(map(tuple, points.round(3)), vectors)))
    common = found[0].keys() & found[1].keys()
    return max(numpy.linalg.norm(found[0][point] - found[1][point]) for point in common)


if len(sys.argv) not in (3, 4):
    sys.exit("usage: squished_head.py VOLUME.nii.gz PICTURE.png [SIZE]")
size = int(sys.argv[3]) if len(sys.argv) > 3 else 700

reader = vtkNIFTIImageReader()
reader.SetFileName(sys.argv[1])
fault = find_fault(reader)
if fault:
    sys.exit(f"squished_head.py: cannot use {sys.argv[1]}: {fault}")
# Cubes of 12 mm and 9 mm: the coarser mesh is for finite elements, which add mid-side nodes.
mesh = make_mesh(reader.GetOutputPort(), 15)
fine_mesh = make_mesh(reader.GetOutputPort(), 20)
elements = deformvolume_vtk.vtkFiniteElementDeformation()
hold(elements, mesh)
elements.SetModeToConverged()
handle = deformvolume_vtk.vtkDeformationHandleSource()
move_handle(handle, 1.0)
elements.SetHandlesConnection(handle.GetOutputPort())
elements.Update()
if not elements.GetIsConverged():
    sys.exit(f"squished_head.py: no equilibrium was found for {sys.argv[1]}")
springs = deformvolume_vtk.vtkMassSpringDeformation()
hold(springs, fine_mesh)
slow_handle = deformvolume_vtk.vtkDeformationHandleSource()
springs.SetHandlesConnection(slow_handle.GetOutputPort())
for frame in range(1, FRAMES + 1):
    # The handle reaches its last position after half of the time.
    move_handle(slow_handle, min(1.0, 2.0 * frame / FRAMES))
    springs.Modified()  # simulates one more frame, even if the handle rests
    springs.Update()
at_rest = deform(reader.GetOutputPort(), elements, 0.0)
by_elements = deform(reader.GetOutputPort(), elements, 1.0)
by_springs = deform(reader.GetOutputPort(), springs, 1.0)

camera = vtkCamera()  # to the right and in front of the head
camera.SetFocalPoint(90.0, 133.0, 83.0)
camera.SetPosition(472.0, 420.0, 121.0)
camera.SetViewUp(0.0, 0.0, 1.0)
camera.SetViewAngle(28.0)
window = vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetMultiSamples(0)
window.SetSize(3 * size, size)
for column, shown in enumerate((at_rest, by_elements, by_springs)):
    renderer = make_renderer(shown, column)
    renderer.SetActiveCamera(camera)
    renderer.ResetCameraClippingRange()
    window.AddRenderer(renderer)
picture = vtkWindowToImageFilter()
picture.SetInput(window)
writer = vtkPNGWriter()
writer.SetInputConnection(picture.GetOutputPort())
writer.SetFileName(sys.argv[2])
writer.Write()
inverted = (by_elements.GetNumberOfInvertedTetrahedra() +
            by_springs.GetNumberOfInvertedTetrahedra())
print(f"{mesh.GetNumberOfCells()} tetrahedra in equilibrium after "
      f"{elements.GetNumberOfNewtonSteps()} Newton steps. Displacements by springs differ by up to "
      f"{find_largest_difference(elements, springs):.1f} mm. {inverted} tetrahedra inverted")
