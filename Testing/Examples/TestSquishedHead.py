# SPDX-License-Identifier: BSD-3-Clause
"""squished-head draws what one of its baselines shows, and so does its twin in Python: a head at rest, and one pulled by
its nose, by finite elements and by springs. Usage: TestSquishedHead.py PROGRAM SCRIPT BASELINE FOLDER"""
import os
import re
import sys

import numpy
from Baselines import find_difference, read_baselines
from Volumes import call, make_folder

VOLUME = "/usr/share/mricron/templates/ch2.nii.gz"
SIZE = 200
LIMIT = 0.05  # of 255, the mean of all colours: a head at rest differs by more than 2

program, script, baseline = sys.argv[1:4]
folder = make_folder(sys.argv[4], "SquishedHead")
if not os.path.exists(VOLUME):
    print(f"skipped: {VOLUME} is missing, install the package mricron-data")
    sys.exit(125)

call(program, code=2)
call(program, VOLUME, os.path.join(folder, "x.png"), "none", code=2)
call(sys.executable, script, code=1)
baselines = read_baselines(baseline)
for expected in baselines:
    assert expected.shape == (SIZE, 3 * SIZE, 3)
    rest, elements, springs = (expected[:, SIZE * k:SIZE * (k + 1)] for k in range(3))
    assert numpy.abs(elements - rest).mean() > 2.0
    assert numpy.abs(springs - rest).mean() > 2.0
words = None
for name, command in (("cxx.png", [program]), ("python.png", [sys.executable, script])):
    path = os.path.join(folder, name)
    output, _ = call(*command, VOLUME, path, SIZE)
    assert words in (None, output), (words, output)
    words = output
    assert " 0 tetrahedra inverted" in output
    # The nose goes by 31 mm: the two models agree on most of that.
    assert float(re.search("at most ([0-9.]+) mm", output).group(1)) < 6.0
    assert find_difference(path, baselines) < LIMIT
