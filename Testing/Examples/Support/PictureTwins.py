# SPDX-License-Identifier: BSD-3-Clause
"""Tests of an example that draws three pictures side by side, in C++ and in Python."""
import os
import sys

from Baselines import find_difference, read_baselines, read_picture
from Volumes import begin_test, call

SIZE = 200  # width and height of a picture
LIMIT = 0.05  # limit of the mean difference of color components (0 to 255)
FOLDER = "/usr/share/mricron/templates"


def check_twins(name, volume, check_panels, check_words=None, check_faults=None):
    """Checks the misuse of the program and the script, and lets both draw a volume of the package mricron-data.
    check_panels gets the three pictures that each of them has drawn, and check_words gets the text that they have
    printed, which must be the same. check_faults gets the commands of both, a function path(file) and the path of the
    volume. The arguments of the test are PROGRAM SCRIPT BASELINE FOLDER."""
    program, script, baseline, path = begin_test(name)
    volume = os.path.join(FOLDER, volume)
    if not os.path.exists(volume):
        print(f"skipped: {volume} is missing, install the package mricron-data")
        sys.exit(125)
    call(program, code=2)
    call(program, volume, path("x.png"), "none", code=2)
    call(sys.executable, script, code=1)
    if check_faults:
        check_faults([program], [sys.executable, script], path, volume)
    baselines = read_baselines(baseline)
    words = None
    for file, command in (("cxx.png", [program]), ("python.png", [sys.executable, script])):
        output, _ = call(*command, volume, path(file), SIZE)
        assert words in (None, output), (words, output)
        words = output
        assert " 0 tetrahedra inverted" in output
        if check_words:
            check_words(output)
        made = read_picture(path(file))
        assert made.shape == (SIZE, 3 * SIZE, 3), (made.shape, (SIZE, 3 * SIZE, 3))
        check_panels(*(made[:, SIZE * k:SIZE * (k + 1)] for k in range(3)))
        assert find_difference(path(file), baselines) < LIMIT
