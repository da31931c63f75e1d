# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume deforms a volume by fields that SimpleITK has written as SimpleITK's resampling does.
Usage: TestItkFields.py PROGRAM FOLDER"""
import gzip
import itertools
import struct

import numpy
import Readers
from Volumes import begin_test, call, get_values, read_vti

program, path = begin_test("ItkFields")
Readers.run("ItkFields.py", path())

with gzip.open(path("fine-1006.nii.gz"), "rb") as file:
    assert struct.unpack("<h", file.read()[68:70]) == (1006,)

suffixes = (".nii.gz", ".nii", ".mha", ".mhd", ".nrrd", ".nhdr", "-zip.nrrd", "-zip.mha", "-1006.nii.gz")
for name, suffix, volume in itertools.product(("fine", "coarse"), suffixes,
                                              ("moving.nii.gz", "moving.mha")):
    target = path("out.vti")
    call(program, path(volume), "--field", path(name + suffix),
         "--field-is-inverse", "--bounds", "volume", "--quiet", "-o", target)
    result = read_vti(target)
    values, covered = get_values(result), get_values(result, "vtkValidPointMask") != 0
    expected = numpy.load(path(name + ".npy"))
    # ITK extends the volume by half a voxel on each side, and deform-volume by 1/256 voxel.
    assert not (covered & (expected == -100)).any()
    assert covered.sum() > 0.5 * covered.size, covered.sum()
    # Errors: single precision of ITK's field and of the matrices of NIfTI, for numbers up to 4.5.
    wrong = numpy.abs(values - expected)[covered].max()
    assert wrong < 5e-4, (name, suffix, volume, wrong)
