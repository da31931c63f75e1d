# SPDX-License-Identifier: BSD-3-Clause
"""Tests that cut-and-pull, in C++ and in Python, draws a picture that equals a baseline.
Usage: TestCutAndPull.py PROGRAM SCRIPT BASELINE FOLDER"""
import numpy
from PictureTwins import check_twins


def check_panels(before, cut, opened):
    # The picture of the open cut differs from that of the volume before the cut.
    assert numpy.abs(opened - before).mean() > 1.0, numpy.abs(opened - before).mean()
    assert numpy.abs(cut - before).mean() > 1.0, numpy.abs(cut - before).mean()


check_twins("CutAndPull", "ch2better.nii.gz", check_panels)
