# SPDX-License-Identifier: BSD-3-Clause
"""Tests that VTK's mappers of volumes and slices draw outputs that stay on a device as they draw other outputs."""

import numpy as np

import deformvolume_vtk
import vtkmodules.vtkInteractionStyle  # noqa: F401  (these modules register the classes of windows and mappers)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkImageSlice,
    vtkRenderer,
    vtkRenderWindow,
    vtkVolume,
    vtkVolumeProperty,
    vtkWindowToImageFilter,
)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper, vtkGPUVolumeRayCastMapper

from lattice import make_mesh
from reported import reported

try:
    from vtkmodules.vtkRenderingImage import vtkImageResliceMapper as vtkSliceMapper
except ImportError:  # ParaView's Python has no such module
    from vtkmodules.vtkRenderingCore import vtkImageSliceMapper as vtkSliceMapper

SHAPE = (40, 48, 44)


def make_volume():
    z, y, x = np.meshgrid(*(np.linspace(-1, 1, size) for size in SHAPE), indexing="ij")
    values = (1000 * np.exp(-3 * (x * x + y * y + z * z))).astype(np.uint16)
    image = vtkImageData()
    image.SetDimensions(*reversed(SHAPE))
    made = numpy_to_vtk(values.ravel(), deep=True)
    made.SetName("value")
    image.GetPointData().SetScalars(made)
    return image


def move(mesh, amount):
    vectors = mesh.GetPointData().GetVectors()
    points = vtk_to_numpy(mesh.GetPoints().GetData())
    vtk_to_numpy(vectors)[:, 0] = amount * np.sin(0.1 * points[:, 1])
    vectors.Modified()


def make_actor(mapper):
    if isinstance(mapper, vtkSliceMapper):
        mapper.SliceFacesCameraOn()
        mapper.SliceAtFocalPointOn()
        actor = vtkImageSlice()
        actor.SetMapper(mapper)
        actor.GetProperty().SetColorWindow(1000)
        actor.GetProperty().SetColorLevel(500)
        return actor
    opacity = vtkPiecewiseFunction()
    opacity.AddPoint(200, 0.0)
    opacity.AddPoint(900, 0.4)
    color = vtkColorTransferFunction()
    color.AddRGBPoint(200, 0.1, 0.2, 0.9)
    color.AddRGBPoint(900, 1.0, 0.9, 0.2)
    properties = vtkVolumeProperty()
    properties.SetScalarOpacity(opacity)
    properties.SetColor(color)
    properties.ShadeOn()
    actor = vtkVolume()
    actor.SetMapper(mapper)
    actor.SetProperty(properties)
    return actor


def draw(mapper_class, image, mesh, on_device):
    """Returns three pictures. Before the last one there is an update whose output is not drawn."""
    deform = deformvolume_vtk.vtkDeformVolumeFilter()
    deform.SetInputData(image)
    deform.SetDeformationData(mesh)
    deform.SetOutputBoundsModeToVolumeBounds()
    deform.SetOutputOnDevice(on_device)
    mapper = mapper_class()
    mapper.SetInputConnection(deform.GetOutputPort())
    renderer = vtkRenderer()
    renderer.AddViewProp(make_actor(mapper))
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetSize(200, 200)
    window.SetMultiSamples(0)
    window.AddRenderer(renderer)
    pictures = []
    for step, amount in enumerate((2.0, 4.0, 6.0, 3.0)):
        move(mesh, amount)
        if step == 2:
            deform.Update()
            assert reported(deform, "Arrays on the device") == (2 if on_device else 0)
            continue
        if step == 0:
            renderer.ResetCamera()
        window.Render()
        assert reported(deform, "Arrays on the device") < 2  # the values are read
        shot = vtkWindowToImageFilter()
        shot.SetInput(window)
        shot.Update()
        pictures.append(vtk_to_numpy(shot.GetOutput().GetPointData().GetScalars()).copy())
    return pictures


volume = make_volume()
lattice = make_mesh(volume, 6)
for mapper_kind in (vtkGPUVolumeRayCastMapper, vtkFixedPointVolumeRayCastMapper, vtkSliceMapper):
    found, expected = (draw(mapper_kind, volume, lattice, way) for way in (True, False))
    for picture, wanted in zip(found, expected):
        assert wanted.std() > 10, f"the picture is empty: its standard deviation is {wanted.std()}"
        assert np.array_equal(picture, wanted), mapper_kind.__name__
    assert not np.array_equal(found[0], found[1]) and not np.array_equal(found[1], found[2])
