# SPDX-License-Identifier: BSD-3-Clause
"""Tests arrays of numpy that the filter deforms and numpy reads: values, labels, errors and devices in Python."""

import numpy as np

import deformvolume_vtk
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkCommand
from vtkmodules.vtkCommonDataModel import vtkImageData

from reported import reported


def make_volume(shape):
    """Returns a volume of shape (z, y, x) with values and labels."""
    random = np.random.default_rng(1)
    values = random.integers(-1000, 1000, size=shape, dtype=np.int16)
    labels = random.integers(2**60, 2**62, size=shape, dtype=np.int64)
    image = vtkImageData()
    image.SetDimensions(*reversed(shape))
    for name, array in (("value", values), ("label", labels)):
        made = numpy_to_vtk(array.ravel(), deep=True)
        made.SetName(name)
        image.GetPointData().AddArray(made)
    image.GetPointData().SetActiveScalars("value")
    return image, values, labels


def make_mesh(image, displacement):
    source = deformvolume_vtk.vtkLatticeTetrahedraSource()
    source.SetNumberOfNodes(4, 4, 4)
    source.SetInputData(image)
    source.Update()
    mesh = source.GetOutput()
    vectors = np.tile(np.asarray(displacement, dtype=np.float32), (mesh.GetNumberOfPoints(), 1))
    made = numpy_to_vtk(vectors, deep=True)
    made.SetName("displacement")
    mesh.GetPointData().SetVectors(made)
    return mesh


def to_numpy(image, name):
    array = vtk_to_numpy(image.GetPointData().GetArray(name))
    return array.reshape(tuple(reversed(image.GetDimensions())))


def record_errors(algorithm):
    """Collects the messages of an algorithm and of its executive instead of printing them."""
    messages = []

    def observe(caller, event, text):
        messages.append(text)

    observe.CallDataType = "string0"
    algorithm.AddObserver(vtkCommand.ErrorEvent, observe)
    algorithm.GetExecutive().AddObserver(vtkCommand.ErrorEvent, lambda caller, event: None)
    return messages


def test_shift():
    image, values, labels = make_volume((6, 7, 8))
    deform = deformvolume_vtk.vtkDeformVolumeFilter()
    deform.SetInputData(image)
    deform.SetDeformationData(make_mesh(image, (2, -1, 3)))
    deform.AddCategoricalArray("label")
    deform.Update()
    output = deform.GetOutput()
    assert output.GetExtent() == (2, 9, -1, 5, 3, 8), output.GetExtent()
    assert np.array_equal(to_numpy(output, "value"), values)
    assert np.array_equal(to_numpy(output, "label"), labels)
    assert to_numpy(output, "label").dtype == np.int64, (to_numpy(output, "label").dtype, np.int64)
    assert to_numpy(output, "vtkValidPointMask").all()
    assert output.GetPointData().GetScalars().GetName() == "value", output.GetPointData().GetScalars().GetName()
    assert deform.GetNumberOfCoveredVoxels() == values.size, (deform.GetNumberOfCoveredVoxels(), values.size)


def test_half_a_voxel():
    image, values, labels = make_volume((6, 7, 8))
    deform = deformvolume_vtk.vtkDeformVolumeFilter()
    deform.SetInputData(image)
    deform.SetDeformationData(make_mesh(image, (0.5, 0, 0)))
    deform.AddCategoricalArray("label")
    deform.SetBackgroundValue(-5)
    deform.SetPadding(1)
    deform.Update()
    output = deform.GetOutput()
    means = (values[:, :, :-1].astype(float) + values[:, :, 1:]) / 2
    inside = np.s_[1:-1, 1:-1, 1:-1]
    # Means that end in .5 are rounded to the even integer, as numpy does.
    assert np.array_equal(to_numpy(output, "value")[inside], np.rint(means).astype(np.int16))
    # Both voxels are equally near: the one with the lower index is taken.
    assert np.array_equal(to_numpy(output, "label")[inside], labels[:, :, :-1])
    mask = to_numpy(output, "vtkValidPointMask").astype(bool)
    assert mask.sum() == means.size and mask[inside].all()
    assert (to_numpy(output, "value")[~mask] == -5).all()


def test_errors():
    image, values, _ = make_volume((6, 7, 8))
    deform = deformvolume_vtk.vtkDeformVolumeFilter()
    messages = record_errors(deform)
    deform.SetInputData(image)
    deform.SetDeformationData(make_mesh(image, (0, 0, 0)))
    deform.SetDevice("there is no such device")
    deform.Update()
    assert len(messages) == 1 and "there is no such device" in messages[0], messages
    assert deform.GetOutput().GetNumberOfPoints() == 0, deform.GetOutput().GetNumberOfPoints()
    deform.SetDevice("")
    deform.Update()
    assert len(messages) == 1, messages
    assert np.array_equal(to_numpy(deform.GetOutput(), "value"), values)


def test_devices():
    names = deformvolume_vtk.vtkDeformVolumeFilter.GetDeviceNames()
    assert names.GetNumberOfValues() > 0, names.GetNumberOfValues()
    image, _, _ = make_volume((3, 3, 3))
    for index in range(names.GetNumberOfValues()):
        deform = deformvolume_vtk.vtkDeformVolumeFilter()
        deform.SetInputData(image)
        deform.SetDeformationData(make_mesh(image, (0, 0, 0)))
        deform.SetDevice(names.GetValue(index))
        deform.Update()
        assert deform.GetDeviceInUse() == names.GetValue(index), deform.GetDeviceInUse()
        assert reported(deform, "Seconds for resampling") > 0, reported(deform, "Seconds for resampling")


def test_values_in_place():
    """Tests that a volume which shares its values with a numpy array follows changes of that array."""
    values = np.arange(4 * 5 * 6, dtype=np.float32)
    image = vtkImageData()
    image.SetDimensions(6, 5, 4)
    scalars = numpy_to_vtk(values)
    scalars.SetName("value")
    image.GetPointData().SetScalars(scalars)
    deform = deformvolume_vtk.vtkDeformVolumeFilter()
    deform.SetInputData(image)
    deform.SetDeformationData(make_mesh(image, (0, 0, 0)))
    deform.Update()
    values *= 2
    scalars.Modified()
    deform.Update()
    assert np.array_equal(to_numpy(deform.GetOutput(), "value").ravel(), values)
    assert reported(deform, "Volumes sent") == 2, reported(deform, "Volumes sent")
    assert reported(deform, "Static mappings made") == 1, reported(deform, "Static mappings made")


if __name__ == "__main__":
    test_shift()
    test_half_a_voxel()
    test_errors()
    test_devices()
    test_values_in_place()
