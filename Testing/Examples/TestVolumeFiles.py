# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume reads MetaImage, NRRD and NIfTI files as SimpleITK, pynrrd and nibabel do, and that these
programs read the files that it writes. Usage: TestVolumeFiles.py PROGRAM FOLDER"""
import json
import os

import numpy
import Readers
from Volumes import begin_test, call, get_values, make_ball, write_vti

program, path = begin_test("VolumeFiles")

# Files of other programs, and the files that deform-volume writes from them.
Readers.run("VolumeFiles.py", path())
written_again = {f"{kind}.{suffix}" for kind, suffix in (
    ("uint8", "mha"), ("int8", "mhd"), ("uint16", "nii"), ("int16", "nii.gz"), ("uint32", "mha"),
    ("int32", "mhd"), ("uint64", "nii"), ("int64", "nii.gz"), ("float32", "mha"), ("float64", "mhd"),
    ("color", "mha"), ("color", "nrrd"), ("vector", "mhd"), ("vector", "nrrd"),
    ("q", "nii.gz"), ("q-mirrored", "nii.gz"),
    ("both", "nii"), ("s-mirrored", "nii"), ("one-mirrored", "nii"), ("both-mirrored", "nii.gz"),
    ("scaled-mirrored", "nii"), ("scaled-form", "nii"),
    ("unit1", "nii"), ("two", "nii.gz"), ("RAS", "nhdr"), ("las", "nrrd"))}
suffixes = ("nii", "nii.gz", "mha", "mhd", "nrrd", "nhdr")
written = []
for case in Readers.load(path(), "cases.json"):
    outputs = []
    if case["file"] in written_again:
        outputs = [path(f"{case['file']}.again.{suffix}") for suffix in suffixes]
        written.append({**case, "outputs": outputs, "padding": 0})
        written_again.remove(case["file"])
    Readers.check(program, path(), case, *outputs)
assert not written_again, written_again

# A volume whose extent does not start at 0. The world of .vti files is not known, so coordinates are not converted.
ball = make_ball()
shifted = make_ball(direction=(0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1))
shifted.SetExtent(-4, 20, 3, 24, -1, 17)
shifted.GetPointData().ShallowCopy(ball.GetPointData())
write_vti(shifted, path("shifted.vti"))
outputs = [path(f"shifted.{suffix}") for suffix in suffixes]
call(program, path("shifted.vti"), *Readers.still, *(word for name in outputs for word in ("-o", name)))
numpy.save(path("shifted.npy"), get_values(shifted))
written.append({"file": "shifted.vti", "values": "shifted.npy", "outputs": outputs, "ras": None,
                "place": Readers.get_matrix(shifted).tolist(), "padding": 0})
both = [case for case in written if case["file"] == "both.nii"][0]
call(program, path("both.nii"), *Readers.still, "--padding", "2", "--background", "0", "-o",
     path("padded.again.nii.gz"))
numpy.save(path("padded.npy"), numpy.pad(numpy.load(path(both["values"])), 2))
place = numpy.array(both["place"])
place[:3, 3] -= place[:3, :3] @ [2, 2, 2]
written.append({**both, "values": "padded.npy", "outputs": [path("padded.again.nii.gz")], "padding": 2,
                "place": place.tolist()})
# A result on the grid of a left-handed file is that file.
with open(path("nothing.tfm"), "w", encoding="ascii") as file:
    file.write("#Insight Transform File V1.0\n#Transform 0\nTransform: TranslationTransform_double_3_3\n"
               "Parameters: 0 0 0\nFixedParameters:\n")
left = path("both-mirrored.nii.gz")
call(program, left, "--transform", path("nothing.tfm"), "--reference", left, "-q", "-o", path("same.again.nii.gz"))
written.append({**[case for case in written if case["file"] == "both-mirrored.nii.gz"][0],
                "outputs": [path("same.again.nii.gz")]})
with open(path("written.json"), "w", encoding="utf-8") as file:
    json.dump(written, file)
Readers.run("WrittenVolumeFiles.py", path())

# NIfTI has no vectors of two real components.
_, errors = call(program, path("time-vectors.nii"), "--frame", "1", *Readers.still, "-o",
                 path("no.nii"), code=1)
assert "complex" in errors and not os.path.exists(path("no.nii")), errors
