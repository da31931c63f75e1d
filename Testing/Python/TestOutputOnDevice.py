# SPDX-License-Identifier: BSD-3-Clause
"""Tests outputs that stay on a device with memory of its own, and are read by numpy and by VTK's filters."""

import numpy as np

import deformvolume_vtk
from vtkmodules.numpy_interface import dataset_adapter
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

from lattice import make_mesh
from reported import reported

TYPES = (np.int8, np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64, np.float32, np.float64)
SHAPE = (12, 14, 16)


def make_volume():
    """Returns a volume with one array of each type, and one array of two components."""
    random = np.random.default_rng(1)
    image = vtkImageData()
    image.SetDimensions(*reversed(SHAPE))
    count = int(np.prod(SHAPE))
    arrays = {}
    for kind in TYPES:
        low, high = (-1e3, 1e3) if kind().dtype.kind == "f" else (np.iinfo(kind).min, np.iinfo(kind).max)
        integers = kind().dtype.kind != "f"
        arrays[kind.__name__] = (random.integers(low, high, count, dtype=kind, endpoint=True) if integers
                                 else random.uniform(low, high, count).astype(kind))
    arrays["two"] = random.normal(size=(count, 2)).astype(np.float32)
    for name, values in arrays.items():
        made = numpy_to_vtk(values, deep=True)
        made.SetName(name)
        image.GetPointData().AddArray(made)
    image.GetPointData().SetActiveScalars("int16")
    return image


def move(mesh, amount):
    vectors = mesh.GetPointData().GetVectors()
    values = vtk_to_numpy(vectors)
    values[:] = amount * np.random.default_rng(2).normal(size=values.shape)
    vectors.Modified()


def make_filter(image, mesh, on_device):
    deform = deformvolume_vtk.vtkDeformVolumeFilter()
    deform.SetInputData(image)
    deform.SetDeformationData(mesh)
    deform.SetOutputBoundsModeToVolumeBounds()
    deform.SetOutputOnDevice(on_device)
    return deform


def names(image):
    return [image.GetPointData().GetArrayName(i) for i in range(image.GetPointData().GetNumberOfArrays())]


def check_equal(found, expected):
    assert names(found) == names(expected), (names(found), names(expected))
    for name in names(found):
        values = vtk_to_numpy(found.GetPointData().GetArray(name))
        wanted = vtk_to_numpy(expected.GetPointData().GetArray(name))
        assert values.dtype == wanted.dtype and values.shape == wanted.shape, name
        assert values.tobytes() == wanted.tobytes(), name


def test_numpy():
    image = make_volume()
    mesh = make_mesh(image, 4)
    found = make_filter(image, mesh, True)
    expected = make_filter(image, mesh, False)
    assert reported(found, "Arrays on the device") == 0, reported(found, "Arrays on the device")
    kept = []
    for amount in (0.1, 0.2, 0.15):
        move(mesh, amount)
        found.Update()
        expected.Update()
        arrays = len(names(found.GetOutput()))
        assert reported(found, "Arrays on the device") == arrays - 2  # the integers of 64 bits
        assert reported(expected, "Arrays on the device") == 0, reported(expected, "Arrays on the device")
        check_equal(found.GetOutput(), expected.GetOutput())
        assert reported(found, "Arrays on the device") == 0, reported(found, "Arrays on the device")
        # An output that numpy refers to is not overwritten.
        values = vtk_to_numpy(found.GetOutput().GetPointData().GetArray("two"))
        kept.append((values, values.copy()))
        for values, copy in kept:
            assert np.array_equal(values, copy)
    # An output that is not read before the next update.
    held = vtkImageData()
    wanted = vtkImageData()
    move(mesh, 0.3)
    found.Update()
    expected.Update()
    held.ShallowCopy(found.GetOutput())
    wanted.DeepCopy(expected.GetOutput())
    move(mesh, 0.1)
    found.Update()
    adapted = dataset_adapter.WrapDataObject(held)
    for name in names(wanted):
        assert np.array_equal(np.asarray(adapted.PointData[name]), vtk_to_numpy(wanted.GetPointData().GetArray(name)))
    # The filter has been deleted.
    move(mesh, 0.3)
    found.Update()
    held.ShallowCopy(found.GetOutput())
    del found
    check_equal(held, wanted)
    scalars = held.GetPointData().GetScalars()
    assert scalars.GetRange() == wanted.GetPointData().GetScalars().GetRange()


def test_pipeline():
    image = make_volume()
    mesh = make_mesh(image, 4)
    surfaces = []
    for on_device in (True, False):
        deform = make_filter(image, mesh, on_device)
        contour = vtkFlyingEdges3D()
        contour.SetInputConnection(deform.GetOutputPort())
        contour.SetInputArrayToProcess(0, 0, 0, 0, "float64")
        contour.SetValue(0, 0.0)
        for amount in (0.1, 0.2):
            move(mesh, amount)
            contour.Update()
        surfaces.append(vtk_to_numpy(contour.GetOutput().GetPoints().GetData()).copy())
    assert len(surfaces[0]) > 100 and np.array_equal(*surfaces)


test_numpy()
test_pipeline()
