# SPDX-License-Identifier: BSD-3-Clause
"""Tests that squished-head, in C++ and in Python, draws a picture that equals a baseline: a head at rest, and the head
pulled by its nose, with finite elements and with springs.
Usage: TestSquishedHead.py PROGRAM SCRIPT BASELINE FOLDER"""
import re

import numpy
from PictureTwins import check_twins


def check_panels(rest, elements, springs):
    # The pictures of the pulled head differ from that of the head at rest.
    assert numpy.abs(elements - rest).mean() > 2.0, numpy.abs(elements - rest).mean()
    assert numpy.abs(springs - rest).mean() > 2.0, numpy.abs(springs - rest).mean()


def check_words(output):
    # The nose moves by 31 mm. The displacements of the two models differ by less than 6 mm.
    assert float(re.search("by up to ([0-9.]+) mm", output).group(1)) < 6.0


check_twins("SquishedHead", "ch2.nii.gz", check_panels, check_words)
