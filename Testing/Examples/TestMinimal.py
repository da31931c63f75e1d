# SPDX-License-Identifier: BSD-3-Clause
"""The minimal examples in C++ and Python do the same, and what they say.
Usage: TestMinimal.py PROGRAM SCRIPT FOLDER"""
import os
import sys

import numpy
from Volumes import call, get_values, make_ball, make_folder, read_vti, write_vti

program, script = sys.argv[1:3]
folder = make_folder(sys.argv[3], "Minimal")
source, first, second = (os.path.join(folder, name) for name in ("in.vti", "cxx.vti", "py.vti"))

call(program, code=2)
call(program, os.path.join(folder, "missing.vti"), first, code=1, quiet=True)
call(sys.executable, script, os.path.join(folder, "missing.vti"), first, code=1, quiet=True)

volume = make_ball(origin=(0.0, 0.0, 0.0))
write_vti(volume, source)
call(program, source, first)
call(sys.executable, script, source, second)
result = read_vti(first)
other = read_vti(second)
assert result.GetExtent() == other.GetExtent()
assert numpy.array_equal(get_values(result, "Values"), get_values(other, "Values"))

# The slice at a quarter of the height moves by a tenth of the height along +x, which is 3.6 voxels.
height = 36.0
index = result.FindPoint((0.0, 15.75, 0.25 * height)) // (
    result.GetDimensions()[0] * result.GetDimensions()[1])
before = get_values(volume, "Values")[4:6].astype(float)
after = get_values(result, "Values")[index:index + 2].astype(float)


def centre(slices, first_x):
    bright = numpy.where(slices > 400, slices, 0.0)
    x = numpy.arange(slices.shape[2]) + first_x
    return (bright * x).sum() / bright.sum()


shift = centre(after, result.GetExtent()[0]) - centre(before, 0)
assert 2.5 < shift < 4.5, shift
