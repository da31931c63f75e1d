# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume reports errors for MetaImage, NRRD and NIfTI files that it cannot read.
Usage: TestWrongVolumeFiles.py PROGRAM FOLDER"""

import Readers
from Volumes import begin_test, call

program, path = begin_test("WrongVolumeFiles")
Readers.run("WrongVolumeFiles.py", path())
for name, words, *arguments in Readers.load(path(), "wrong.json"):
    Readers.fails(program, path(), name, words, *arguments)
_, errors = call(program, path("time.nii"), *Readers.still, "--frame", "-1", "-o",
                 path("no.vti"), code=2)
assert "--frame" in errors, errors
