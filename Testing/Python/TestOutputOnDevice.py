# SPDX-License-Identifier: BSD-3-Clause
"""Tests outputs that stay on a device with memory of its own, and are read by numpy."""

import numpy as np

import deformvolume_vtk
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

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


test_numpy()
