# SPDX-License-Identifier: BSD-3-Clause
"""Deforms a volume with the driver from PyPI."""

import unittest

import numpy

from moving_cube import deform


class Deform(unittest.TestCase):
    def test_at_rest(self):
        volume, output, coverage = deform()
        numpy.testing.assert_array_equal(output, volume)
        self.assertTrue((coverage == 1).all())

    # The arrays have the axes z, y, x.
    def test_whole_voxels(self):
        volume, output, coverage = deform(shift=(3.0, -2.0, 1.0))
        numpy.testing.assert_array_equal(output[1:, :-2, 3:], volume[:-1, 2:, :-3])
        covered = numpy.zeros(volume.shape, numpy.int8)
        covered[1:, :-2, 3:] = 1
        numpy.testing.assert_array_equal(coverage, covered)
        self.assertTrue((output[covered == 0] == -1).all())

    # pyopencl also loads PoCL, which is in the folder of pyopencl. The two packages must not affect each other.
    def test_beside_pyopencl(self):
        try:
            from pyopencl import get_platforms
        except ImportError:
            self.skipTest("pyopencl is not installed")
        before = [platform.name for platform in get_platforms()]
        volume, output, _ = deform()
        numpy.testing.assert_array_equal(output, volume)
        self.assertEqual([platform.name for platform in get_platforms()], before)


if __name__ == "__main__":
    unittest.main()
