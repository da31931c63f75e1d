# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume reports errors for MetaImage, NRRD and NIfTI files that it cannot read.
Usage: TestWrongVolumeFiles.py PROGRAM FOLDER"""
import os
import sys

import Readers
from Volumes import call, make_folder

program = sys.argv[1]
folder = make_folder(sys.argv[2], "WrongVolumeFiles")
Readers.run("WrongVolumeFiles.py", folder)
for name, words, *arguments in Readers.load(folder, "wrong.json"):
    Readers.fails(program, folder, name, words, *arguments)
_, errors = call(program, os.path.join(folder, "time.nii"), *Readers.still, "--frame", "-1", "-o",
                 os.path.join(folder, "no.vti"), code=2)
assert "--frame" in errors, errors
