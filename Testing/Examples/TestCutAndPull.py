# SPDX-License-Identifier: BSD-3-Clause
"""cut-and-pull, in C++ and in Python, draws one of its baselines.
Usage: TestCutAndPull.py PROGRAM SCRIPT BASELINE FOLDER"""
import numpy
from PictureTwins import check_twins


def check_panels(before, cut, opened):
    # A cut that stays closed differs by more than 1.
    assert numpy.abs(opened - before).mean() > 1.0
    assert numpy.abs(cut - before).mean() > 1.0


check_twins("CutAndPull", "ch2better.nii.gz", check_panels)
