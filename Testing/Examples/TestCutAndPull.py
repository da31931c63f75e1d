# SPDX-License-Identifier: BSD-3-Clause
"""cut-and-pull draws what one of its baselines shows, and so does its twin in Python. As with VTK's own regression tests
the others are called BASELINE_1.png and so on: VTK 9.6 shades volumes otherwise.
Usage: TestCutAndPull.py PROGRAM SCRIPT BASELINE FOLDER"""
import glob
import os
import sys

import numpy
from Volumes import call, make_folder
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

VOLUME = "/usr/share/mricron/templates/ch2better.nii.gz"
SIZE = 200
LIMIT = 0.05  # of 255, the mean of all colours: a cut that stays closed differs by more than 1

program, script, baseline = sys.argv[1:4]
folder = make_folder(sys.argv[4], "CutAndPull")
if not os.path.exists(VOLUME):
    print(f"skipped: {VOLUME} is missing, install the package mricron-data")
    sys.exit(125)


def read(path):
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, 3).astype(float)


call(program, code=2)
call(program, VOLUME, os.path.join(folder, "x.png"), "none", code=2)
call(sys.executable, script, code=1)
baselines = [read(path) for path in [baseline, *glob.glob(baseline.replace(".png", "_*.png"))]]
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
    drawn = read(path)
    assert drawn.shape == baselines[0].shape
    difference = min(numpy.abs(drawn - expected).mean() for expected in baselines)
    print(f"{path} differs from the baseline by {difference}")
    assert difference < LIMIT
