# SPDX-License-Identifier: BSD-3-Clause
"""cut-and-pull draws what one of its baselines shows, and so does its twin in Python.
Usage: TestCutAndPull.py PROGRAM SCRIPT BASELINE FOLDER"""
import os
import sys

import numpy
from Baselines import find_difference, read_baselines
from Volumes import call, make_folder

VOLUME = "/usr/share/mricron/templates/ch2better.nii.gz"
SIZE = 200
LIMIT = 0.05  # of 255, the mean of all colours: a cut that stays closed differs by more than 1

program, script, baseline = sys.argv[1:4]
folder = make_folder(sys.argv[4], "CutAndPull")
if not os.path.exists(VOLUME):
    print(f"skipped: {VOLUME} is missing, install the package mricron-data")
    sys.exit(125)

call(program, code=2)
call(program, VOLUME, os.path.join(folder, "x.png"), "none", code=2)
call(sys.executable, script, code=1)
baselines = read_baselines(baseline)
for expected in baselines:
    assert expected.shape == (SIZE, 3 * SIZE, 3)
    before, cut, opened = (expected[:, SIZE * k:SIZE * (k + 1)] for k in range(3))
    assert numpy.abs(opened - before).mean() > 1.0
    assert numpy.abs(cut - before).mean() > 1.0
words = None
for name, command in (("cxx.png", [program]), ("python.png", [sys.executable, script])):
    path = os.path.join(folder, name)
    output, _ = call(*command, VOLUME, path, SIZE)
    assert words in (None, output)
    words = output
    assert " 0 tetrahedra inverted" in output
    assert find_difference(path, baselines) < LIMIT
