# SPDX-License-Identifier: BSD-3-Clause
"""squished-head, in C++ and in Python, draws one of its baselines: a head at rest, and one pulled by
its nose, by finite elements and by springs. Usage: TestSquishedHead.py PROGRAM SCRIPT BASELINE FOLDER"""
import re

import numpy
from PictureTwins import check_twins


def check_panels(rest, elements, springs):
    # A head at rest differs by more than 2.
    assert numpy.abs(elements - rest).mean() > 2.0
    assert numpy.abs(springs - rest).mean() > 2.0


def check_words(output):
    # The nose goes by 31 mm: the two models agree on most of that.
    assert float(re.search("at most ([0-9.]+) mm", output).group(1)) < 6.0


check_twins("SquishedHead", "ch2.nii.gz", check_panels, check_words)
