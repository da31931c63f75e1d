# SPDX-License-Identifier: BSD-3-Clause
"""Tests the inverse field that deform-volume writes, by which SimpleITK resamples the volume to the same result, the
Jacobian, and densities, whose sum is preserved.
Usage: TestMaps.py PROGRAM FOLDER"""
import re

import numpy
import Readers
from Volumes import begin_test, call, get_values, read_vti, write_vti

program, path = begin_test("Maps")
Readers.run("Maps.py", "make", path())
forward = ("--field", path("forward.mha"))


def fails(words, *options, code=1):
    _, errors = call(program, path("moving.mha"), "--lattice", "3,3,3", *options, code=code)
    assert words in errors, f"{words} is not in {errors}"


same = ["--push", "0,0,0,1,0,0,5"]
fails("the name must end in", *same, "--jacobian", path("jacobian.png"), code=2)
fails("the name must end in", *same, "--inverse-field", path("field.h5"), code=2)
fails("--density-array dose: the volume has no such array of numbers. It has ", *same, "--density-array", "dose",
      "-o", path("a.vti"))

background = -123.0
for volume, field, grid in (("moving.nii.gz", ".nii.gz", None), ("moving.nii.gz", ".mha", None),
                            ("moving.mha", ".nii.gz", None), ("moving.nrrd", ".nrrd", None),
                            ("moving.mha", ".mha", "fixed.mha"), ("moving.nii.gz", ".nii.gz", "fixed.mha")):
    names = {name: name + field for name in ("result", "inverse", "jacobian")}
    _, errors = call(program, path(volume), *forward,
                     *(("--reference", path(grid)) if grid else ()), "--background", str(background),
                     "-o", path(names["result"]), "--inverse-field", path(names["inverse"]),
                     "--jacobian", path(names["jacobian"]), "-q")
    Readers.run("Maps.py", "check", path(), volume, names["result"], names["inverse"], names["jacobian"],
                str(background))
    found = re.findall(r"inverse field is 0 at (\d+) of (\d+) voxels", errors)
    # The whole grid of the volume is covered, because the deformation is zero at the border. So only a run with another
    # grid warns.
    assert len(found) == (1 if grid else 0), errors
    assert all(0 < int(uncovered) < int(voxels) for uncovered, voxels in found), errors

# A .vti file has vectors in the world of the volume. The deformed volume has none of these arrays.
call(program, path("moving.nii.gz"), *forward, "-o", path("result.vti"),
     "--inverse-field", path("inverse.vti"), "--jacobian", path("jacobian.vti"), "-q")
result, inverse = read_vti(path("result.vti")), read_vti(path("inverse.vti"))
arrays = result.GetPointData()
assert not arrays.HasArray("Jacobian") and not arrays.HasArray("RestPosition")
vectors, covered = Readers.get_array(inverse), get_values(result, "vtkValidPointMask") != 0
call(program, path("moving.nii.gz"), *Readers.still, "-o", path("rest.vti"))
rest = read_vti(path("rest.vti"))
assert covered.sum() > 10000, covered.sum()
indices = numpy.argwhere(covered)[::997]
for k, j, i in indices.tolist():
    extent = result.GetExtent()
    place = [0.0] * 3
    result.TransformIndexToPhysicalPoint(i + extent[0], j + extent[2], k + extent[4], place)
    seen = [0.0] * 3
    rest.TransformPhysicalPointToContinuousIndex((numpy.array(place) + vectors[k, j, i]).tolist(), seen)
    # The reader of NIfTI files may have reversed the order of slices.
    values = get_values(rest)
    low = numpy.clip(numpy.floor(seen).astype(int), 0, numpy.array(rest.GetDimensions()) - 2)
    t = numpy.array(seen) - low
    corner = values[low[2], low[1], low[0]]
    slopes = (values[low[2], low[1], low[0] + 1] - corner, values[low[2], low[1] + 1, low[0]] - corner,
              values[low[2] + 1, low[1], low[0]] - corner)
    assert abs(corner + numpy.dot(t, slopes) - get_values(result)[k, j, i]) < 2e-3

# If the inverse field and the Jacobian are not requested, arrays of the volume with their names are deformed.
for name in ("Jacobian", "RestPosition"):
    array = rest.GetPointData().GetScalars().NewInstance()
    array.DeepCopy(rest.GetPointData().GetScalars())
    array.SetName(name)
    rest.GetPointData().AddArray(array)
write_vti(rest, path("named.vti"))
call(program, path("named.vti"), *Readers.still, "-o", path("named-out.vti"))
named = read_vti(path("named-out.vti"))
for name in ("Jacobian", "RestPosition"):
    assert numpy.array_equal(get_values(named, name), get_values(named)), name
for name, option in (("Jacobian", "--jacobian"), ("RestPosition", "--inverse-field")):
    _, errors = call(program, path("named.vti"), *Readers.still, option, path("a.vti"), code=1, quiet=True)
    assert f'has a point array "{name}"' in errors, errors

# The sum of a density is preserved if the border of the volume does not move. Its background is 0.
call(program, path("moving.mha"), *forward, "--density-array", "MetaImage",
     "--padding", "3", "-o", path("density.vti"), "-q")
before = get_values(rest).sum()
assert abs(get_values(read_vti(path("density.vti"))).sum() / before - 1) < 0.005
assert get_values(read_vti(path("density.vti"))).dtype == numpy.float32
