# SPDX-License-Identifier: BSD-3-Clause
"""Tests that squished-head, in C++ and in Python, draws a picture that equals a baseline: a head at rest, and the head
pulled by its nose, with finite elements and with springs.
Usage: TestSquishedHead.py PROGRAM SCRIPT BASELINE FOLDER"""
import gzip
import os
import re

import numpy
from PictureTwins import check_twins
from Volumes import call


def check_panels(rest, elements, springs):
    # The pictures of the pulled head differ from that of the head at rest.
    assert numpy.abs(elements - rest).mean() > 2.0, numpy.abs(elements - rest).mean()
    assert numpy.abs(springs - rest).mean() > 2.0, numpy.abs(springs - rest).mean()


def check_words(output):
    # The nose moves by 31 mm. The displacements of the two models differ by less than 6 mm.
    assert float(re.search("by up to ([0-9.]+) mm", output).group(1)) < 6.0


def check_faults(program, script, path, volume):
    """Checks that volumes that are no such head are an error of one line."""
    with open(path("text.nii.gz"), "w", encoding="utf-8") as file:
        file.write("no volume")
    with gzip.open(volume) as file:
        head = file.read()
    with open(path("cut.nii"), "wb") as file:
        file.write(head[:len(head) // 2])
    with open(path("air.nii"), "wb") as file:
        file.write(head[:352] + bytes(len(head) - 352))
    for name, words in (("none.nii.gz", "there is no such file"), ("text.nii.gz", "not a NIfTI file"),
                        ("cut.nii", "damaged or not complete"), ("air.nii", "it has no nose 90 mm to the right")):
        for command, title in ((program, "squished-head"), (script, "squished_head.py")):
            output, errors = call(*command, path(name), path("x.png"), 99, code=1, quiet=True)
            assert output == "", output
            assert errors.splitlines()[-1].startswith(f"{title}: cannot use {path(name)}: "), errors
            assert words in errors.splitlines()[-1], errors
            # VTK's reader prints a message about damaged data, too.
            assert errors.count("\n") == 1 or name == "cut.nii", errors
            assert not os.path.exists(path("x.png"))


check_twins("SquishedHead", "ch2.nii.gz", check_panels, check_words, check_faults)
