# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume reads DICOM series as pydicom and SimpleITK do, and reports errors for invalid series.
Usage: TestDICOM.py PROGRAM FOLDER"""
import shutil
import sys

import Readers
from Volumes import make_folder

program = sys.argv[1]
shutil.rmtree(make_folder(sys.argv[2], "DICOM"))
folder = make_folder(sys.argv[2], "DICOM")
Readers.run("DICOMFiles.py", folder)
for name, words in Readers.load(folder, "wrong.json"):
    Readers.fails(program, folder, name, words)
Readers.fails(program, folder, "plain", "one frame, number 0", "--frame", "1")
for case in Readers.load(folder, "cases.json"):
    Readers.check(program, folder, case)
