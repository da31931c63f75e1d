# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume draws a picture with the volume at rest on the left, and the deformed volume on the right.
Usage: TestPicture.py PROGRAM FOLDER"""

import numpy
from Baselines import read_picture
from Volumes import begin_test, call, make_ball, write_vti

program, path = begin_test("Picture")
write_vti(make_ball(dimensions=(41, 36, 31), spacing=(1.0, 1.0, 1.0)), path("in.vti"))


def draw(name, push, *arguments):
    file = path(name)
    call(program, path("in.vti"), "--lattice", "12,12,12", "--push", push, "--image",
         file, "--quiet", *arguments)
    picture = read_picture(file)
    assert picture.shape == (700, 1400, 3), picture.shape
    # Without the captions.
    return picture[60:, :700], picture[60:, 700:]


def is_ball(half):
    """Whether pixels have the color of skin; the background is dark."""
    return half[:, :, 0] > half[:, :, 2] + 15


left, right = draw("still.png", "0,0,0,0.0001,0,0,1000")
assert 0.1 < is_ball(left).mean() < 0.8, f"the ball fills {is_ball(left).mean()} of the picture"
# If no voxel moves, single pixels at the rim of the ball may change.
assert (numpy.abs(left - right).max(axis=2) > 8).mean() < 0.002, (numpy.abs(left - right).max(axis=2) > 8).mean()

# Pushed from above, towards -z.
left, right = draw("pushed.png", "17,22.5,31,0,0,-8,16")
assert (numpy.abs(left - right).max(axis=2) > 8).mean() > 0.02, "the push changes 2 % of the pixels or less"
top = [numpy.flatnonzero(is_ball(half).any(axis=1)).max() for half in (left, right)]
assert top[1] < top[0] - 20, top
