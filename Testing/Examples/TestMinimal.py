# SPDX-License-Identifier: BSD-3-Clause
"""Tests that the minimal examples in C++ and Python have the same output, and that it is the one which their comments
describe.
Usage: TestMinimal.py PROGRAM SCRIPT FOLDER"""
import sys

import numpy
from Volumes import begin_test, call, get_values, make_ball, read_vti, write_vti

program, script, path = begin_test("Minimal")
source, first, second = (path(name) for name in ("in.vti", "cxx.vti", "py.vti"))

call(program, code=2)
call(program, path("missing.vti"), first, code=1, quiet=True)
call(sys.executable, script, path("missing.vti"), first, code=1, quiet=True)

volume = make_ball(origin=(0.0, 0.0, 0.0))
write_vti(volume, source)
call(program, source, first)
call(sys.executable, script, source, second)
result = read_vti(first)
other = read_vti(second)
assert result.GetExtent() == other.GetExtent(), (result.GetExtent(), other.GetExtent())
assert numpy.array_equal(get_values(result, "Values"), get_values(other, "Values"))

# Each slice is shifted along x by a sine of its height, which is linear between the 20 nodes of the mesh. The amplitude
# is a tenth of the height of the volume. Values are interpolated linearly between the voxels of a row.
height = 36.0
nodes = numpy.linspace(0.0, height, 20)
first, last = result.GetExtent()[:2]
before = get_values(volume, "Values").astype(float)
after = get_values(result, "Values")
for z in range(volume.GetDimensions()[2]):
    shift = numpy.interp(2.0 * z, nodes, 0.1 * height * numpy.sin(2.0 * numpy.pi * nodes / height))
    rest = numpy.arange(first, last + 1) - shift
    # Positions are rounded to 1/256 voxel, so voxels on the border may be covered or not.
    inside = (rest > 0.01) & (rest < volume.GetDimensions()[0] - 1.01)
    outside = (rest < -0.01) | (rest > volume.GetDimensions()[0] - 0.99)
    for y in range(volume.GetDimensions()[1]):
        expected = numpy.interp(rest, numpy.arange(volume.GetDimensions()[0]), before[z, y])
        # Values differ by at most 850 from voxel to voxel, and are rounded to integers.
        assert numpy.abs(after[z, y] - expected)[inside].max() <= 850 / 256 + 0.5, (z, y)
        assert (after[z, y][outside] == 0).all(), (z, y)
