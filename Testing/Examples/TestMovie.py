# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume draws the frames of a simulation, as pictures, and as a video if VTK has Ogg Theora.
Usage: TestMovie.py PROGRAM FOLDER"""
import os

import numpy
from Baselines import read_picture
from Volumes import begin_test, call, get_values, make_ball, read_vti, write_vti

program, path = begin_test("Movie")
ball = make_ball(dimensions=(25, 22, 19), spacing=(1.0, 1.0, 1.0))
write_vti(ball, path("in.vti"))
bounds = ball.GetBounds()
pull = f"{0.5 * (bounds[0] + bounds[1])},{0.5 * (bounds[2] + bounds[3])},{bounds[5] - 3},6,0,2,3"
common = ("--lattice", "5,5,5", "--fix", f"below:{bounds[4] + 2}", "--pull", pull)


def read(name):
    picture = read_picture(path(name))
    assert picture.shape == (700, 1400, 3), picture.shape
    return picture


def count_packets(name):
    """Returns the number of packets in an Ogg file. A page begins with 27 bytes, the last of which is the number of
    segments. The lengths of the segments follow. A segment of less than 255 bytes ends a packet."""
    with open(name, "rb") as file:
        data = file.read()
    begin = packets = 0
    while begin < len(data):
        assert data[begin:begin + 4] == b"OggS", begin
        lengths = data[begin + 27:begin + 27 + data[begin + 26]]
        packets += sum(length < 255 for length in lengths)
        begin += 27 + len(lengths) + sum(lengths)
    assert begin == len(data), (begin, len(data))
    return packets


call(program, path("in.vti"), "--model", "fem", *common, "--movie", path("m.png"), "--frames", "2", "-o",
     path("o.vti"), "--quiet")
frames = [read(f"m{i:04}.png") for i in (1, 2)]
assert not os.path.exists(path("m0003.png")) and not os.path.exists(path("m.png"))
# The camera does not move: the volume at rest on the left is the same in all frames.
assert (frames[0][:, :700] == frames[1][:, :700]).all()
moved = [(numpy.abs(frame[60:, :700] - frame[60:, 700:]).max(axis=2) > 24).mean() for frame in frames]
assert 0.002 < moved[0] < 0.8 * moved[1] < 0.3, moved
# The output is that of the last frame, with the whole pull.
call(program, path("in.vti"), "--model", "fem", *common, "-o", path("whole.vti"), "--quiet")
difference = numpy.abs(get_values(read_vti(path("o.vti"))).astype(float) -
                       get_values(read_vti(path("whole.vti"))))
assert difference.max() <= 1, difference.max()

# Springs that are pulled too far in this short time would invert tetrahedra, with a warning. The output does not
# depend on whether frames are drawn.
gently = [part.replace(",6,0,2,3", ",2,0,1,3") for part in common]
springs = [program, path("in.vti"), "--model", "mass-spring", *gently, "--duration", "0.05", "--quiet", "-o"]
call(*springs, path("o.vti"), "--movie", path("s.png"), "--frames", "2")
frames = [read(f"s{i:04}.png") for i in (1, 2)]
assert (frames[0][60:, 700:] != frames[1][60:, 700:]).any()
call(*springs, path("whole.vti"))
movie, whole = [get_values(read_vti(path(name))).astype(float) for name in ("o.vti", "whole.vti")]
difference = numpy.abs(movie - whole)
assert difference.max() <= 1, difference.max()

output, errors = call(program, path("in.vti"), "--model", "mass-spring", *gently, "--duration", "0.05",
                      "--movie", path("m.ogv"), "--frames", "2", code=None)
if "Ogg Theora" in errors:
    print("movies are not tested: this VTK cannot write Ogg Theora")
else:
    assert errors == "" and "deform and draw frames" in output, errors + output
    # After three packets of headers there is one for each frame.
    assert count_packets(path("m.ogv")) == 3 + 2, (count_packets(path("m.ogv")), 3 + 2)
