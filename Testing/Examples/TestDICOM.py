# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume reads DICOM series as pydicom and SimpleITK do, and reports errors for invalid series.
Usage: TestDICOM.py PROGRAM FOLDER"""

import Readers
from Volumes import begin_test

program, path = begin_test("DICOM")
Readers.run("DICOMFiles.py", path())
for name, words in Readers.load(path(), "wrong.json"):
    Readers.fails(program, path(), name, words)
Readers.fails(program, path(), "plain", "one frame, number 0", "--frame", "1")
for case in Readers.load(path(), "cases.json"):
    Readers.check(program, path(), case)
