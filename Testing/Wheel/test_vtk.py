# SPDX-License-Identifier: BSD-3-Clause
"""The filter for VTK pipelines. The tests are skipped without VTK."""

import unittest

import numpy

try:
    from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
except ImportError:
    vtkRTAnalyticSource = None


def values(image):
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[::-1])


def add_vectors(data, vectors):
    from vtkmodules.util.numpy_support import numpy_to_vtk

    array = numpy_to_vtk(numpy.asarray(vectors, dtype=float), deep=True)
    array.SetName("vectors")
    data.GetPointData().SetVectors(array)
    return data


def make_field(shift):
    from vtkmodules.vtkCommonDataModel import vtkImageData

    field = vtkImageData()
    field.SetDimensions(2, 2, 2)
    field.SetOrigin(-10, -10, -10)
    field.SetSpacing(20, 20, 20)
    return add_vectors(field, numpy.tile(shift, (8, 1)))


def make_mesh(shift, kind=None):
    """A box of the size of the volume, as one cell."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints
    from vtkmodules.vtkCommonDataModel import VTK_HEXAHEDRON, vtkUnstructuredGrid

    corners = [(x, y, z) for z in (-10, 10) for x, y in ((-10, -10), (10, -10), (10, 10), (-10, 10))]
    points = vtkPoints()
    points.SetData(numpy_to_vtk(numpy.array(corners, dtype=float), deep=True))
    numbers = vtkIdList()
    for number in range(8):
        numbers.InsertNextId(number)
    mesh = vtkUnstructuredGrid()
    mesh.SetPoints(points)
    mesh.InsertNextCell(VTK_HEXAHEDRON if kind is None else kind, numbers)
    return add_vectors(mesh, numpy.tile(shift, (8, 1)))


class Pipeline(unittest.TestCase):
    SHIFT = [3.0, -2.0, 1.0]

    def setUp(self):
        # Skip each test and not the class: Python 3.12.1 reports a failure if a program has no tests.
        if vtkRTAnalyticSource is None:
            self.skipTest("VTK is not installed")
        from deformvolume.vtk import DeformVolume

        self.source = vtkRTAnalyticSource()
        self.filter = DeformVolume()
        self.filter.SetInputConnection(self.source.GetOutputPort())
        self.filter.SetOutputBoundsMode(DeformVolume.VOLUME_BOUNDS)

    def expect_shift(self):
        volume, output = values(self.source.GetOutput()), values(self.filter.GetOutputDataObject(0))
        numpy.testing.assert_array_equal(output[1:, :-2, 3:], volume[:-1, 2:, :-3])

    def test_field(self):
        from vtkmodules.vtkImagingCore import vtkImageFlip

        self.filter.SetDeformationData(make_field(self.SHIFT))
        # With a filter downstream, VTK requests information, extents and data.
        flip = vtkImageFlip()
        flip.SetInputConnection(self.filter.GetOutputPort())
        flip.Update()
        self.expect_shift()
        output = values(self.filter.GetOutputDataObject(0))
        numpy.testing.assert_array_equal(values(flip.GetOutput())[:, :, ::-1], output)

    def test_mesh(self):
        self.filter.SetDeformationData(make_mesh(self.SHIFT))
        self.filter.Update()
        self.expect_shift()
        # Another deformation.
        self.filter.SetDeformationData(make_mesh([0.0, 0.0, 0.0]))
        self.filter.Update()
        numpy.testing.assert_array_equal(values(self.filter.GetOutputDataObject(0)), values(self.source.GetOutput()))

    def expect_error(self, words, deformation):
        self.filter.SetDeformationData(deformation)
        with self.assertRaisesRegex(Exception, words):
            self.filter.Update()

    # As in the C++ filter, arrays of bits are left out.
    def test_bits(self):
        from vtkmodules.vtkCommonCore import vtkBitArray

        self.source.Update()
        volume = self.source.GetOutput()
        bits = vtkBitArray()
        bits.SetName("bits")
        bits.SetNumberOfTuples(volume.GetNumberOfPoints())
        volume.GetPointData().AddArray(bits)
        self.filter.SetInputDataObject(0, volume)
        self.filter.SetDeformationData(make_field(self.SHIFT))
        self.filter.Update()
        self.expect_shift()
        self.assertFalse(self.filter.GetOutputDataObject(0).GetPointData().HasArray("bits"))
        volume.GetPointData().RemoveArray("RTData")
        self.expect_error("no numeric point array", make_field(self.SHIFT))

    # VTK prints these errors, too.
    def test_misuse(self):
        from vtkmodules.vtkCommonDataModel import VTK_TRIANGLE_STRIP, vtkImageData, vtkPolyData, vtkUnstructuredGrid

        with self.assertRaisesRegex(AttributeError, "has no SetSamplingFactor"):
            self.filter.SetSamplingFactor(2)
        self.expect_error("no active vectors", vtkImageData())
        self.expect_error("no cells", vtkUnstructuredGrid())
        self.expect_error("vtkPolyData", vtkPolyData())
        self.expect_error("is not finite", make_mesh([numpy.nan, 0.0, 0.0]))
        self.expect_error("no tetrahedra, but 1 triangle strip", make_mesh(self.SHIFT, VTK_TRIANGLE_STRIP))
        field = make_field(self.SHIFT)
        field.SetDimensions(3, 2, 2)
        self.expect_error('"vectors" has 8 tuples, but its grid needs 12', field)
        mesh = make_mesh(self.SHIFT)
        mesh.GetPointData().Initialize()
        self.expect_error("no active vectors", mesh)
        # The filter works again with a valid deformation.
        self.filter.SetDeformationData(make_mesh(self.SHIFT))
        self.filter.Update()
        self.expect_shift()


if __name__ == "__main__":
    unittest.main()
