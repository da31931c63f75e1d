# SPDX-License-Identifier: BSD-3-Clause
"""The filter for VTK pipelines, where there is VTK."""

import unittest

import numpy

try:
    from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
except ImportError:
    vtkRTAnalyticSource = None


@unittest.skipIf(vtkRTAnalyticSource is None, "there is no VTK")
class Pipeline(unittest.TestCase):
    def test_shift(self):
        from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
        from vtkmodules.vtkCommonDataModel import vtkImageData
        from vtkmodules.vtkImagingCore import vtkImageFlip

        from deformvolume.vtk import DeformVolume

        source = vtkRTAnalyticSource()
        field = vtkImageData()
        field.SetDimensions(2, 2, 2)
        field.SetOrigin(-10, -10, -10)
        field.SetSpacing(20, 20, 20)
        vectors = numpy_to_vtk(numpy.tile([3.0, -2.0, 1.0], (8, 1)), deep=True)
        vectors.SetName("vectors")
        field.GetPointData().SetVectors(vectors)
        filter_ = DeformVolume()
        filter_.SetInputConnection(source.GetOutputPort())
        filter_.SetDeformationData(field)
        filter_.SetOutputBoundsMode(DeformVolume.VOLUME_BOUNDS)
        # A filter behind it, so that VTK asks for information, extents and data.
        flip = vtkImageFlip()
        flip.SetInputConnection(filter_.GetOutputPort())
        flip.Update()
        source.Update()

        def values(image):
            return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[::-1])

        volume, output = values(source.GetOutput()), values(filter_.GetOutputDataObject(0))
        numpy.testing.assert_array_equal(output[1:, :-2, 3:], volume[:-1, 2:, :-3])
        numpy.testing.assert_array_equal(values(flip.GetOutput())[:, :, ::-1], output)
        with self.assertRaises(AttributeError):
            filter_.SetSamplingFactor(2)
        filter_.SetDeformationData(vtkImageData())
        with self.assertRaises(Exception):
            filter_.Update()


if __name__ == "__main__":
    unittest.main()
