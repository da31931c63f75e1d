# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume reads and writes volumes at their position in the world. TestVolumeFiles and TestDICOM test
further formats.
Usage: TestFormats.py PROGRAM FOLDER"""
import gzip
import math
import re
import struct

import numpy
import Readers
from Volumes import begin_test, call, get_values, make_ball, read_vti, write_vti
from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes, vtkImageData

program, path = begin_test("Formats")

# A push that moves no voxel by as much as 1/512 voxel, so that values do not change.
still = ("--lattice", "3,3,3", "--push", "0,0,0,0.0001,0,0,1000")


def convert(source, *targets):
    for target in targets:
        call(program, path(source), *still, "-o", path(target), "--quiet", "--bounds", "volume")
    return read_vti(path(targets[-1])) if targets[-1].endswith(".vti") else None


def get_matrix(image):
    """Returns the matrix from an index, counted from the first voxel of the extent, to the world, without its last row."""
    return Readers.get_matrix(image)[:3]


def same(image, values, matrix):
    assert numpy.array_equal(get_values(image), values), "the values differ"
    assert numpy.allclose(get_matrix(image), matrix, atol=1e-5), (get_matrix(image), matrix)


# Oblique axes: turned by 30 degrees about z, then x and y exchanged.
c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
turned = (c, -s, 0, s, c, 0, 0, 0, 1)
volume = make_ball(direction=turned)
values = get_values(volume)
matrix = get_matrix(volume)
write_vti(volume, path("in.vti"))

# If the world is not known, axes do not change.
same(convert("in.vti", "a.vti"), values, matrix)
convert("in.vti", "a.nii.gz")
same(convert("a.nii.gz", "b.vti"), values, matrix)
convert("in.vti", "a.nii")
same(convert("a.nii", "b.vti"), values, matrix)
convert("in.vti", "a.mhd")
same(convert("a.mhd", "b.vti"), values, matrix)

# If the world is known, axes are converted: right and anterior become left and posterior.
flip = numpy.diag([-1.0, -1.0, 1.0])
convert("a.nii.gz", "c.mhd")
same(convert("c.mhd", "c.vti"), values, flip @ matrix)
convert("c.mhd", "d.nii.gz")
same(convert("d.nii.gz", "d.vti"), values, matrix)

# A mirrored volume. VTK's reader of NIfTI files reverses the order of its slices; the program reverses it again.
mirrored = make_ball(direction=(-1, 0, 0, 0, 1, 0, 0, 0, 1))
write_vti(mirrored, path("mirrored.vti"))
convert("mirrored.vti", "mirrored.mhd")
same(convert("mirrored.mhd", "e.vti"), get_values(mirrored), get_matrix(mirrored))
convert("mirrored.vti", "mirrored.nii.gz")
same(convert("mirrored.nii.gz", "e.vti"), get_values(mirrored), get_matrix(mirrored))

# Only .vti files have negative spacings. In the other formats, the direction of the axis is negated instead.
negative = make_ball(spacing=(1.0, 1.5, -2.0), direction=turned)
write_vti(negative, path("negative.vti"))
for name in ("negative.mhd", "negative.nrrd", "negative.nii"):
    convert("negative.vti", name)
    same(convert(name, "e.vti"), get_values(negative), get_matrix(negative))
with open(path("negative.nii"), "rb") as file:
    assert struct.unpack_from("<3f", file.read(), 80) == (1.0, 1.5, 2.0), "the q-form needs positive spacings"

# UTM coordinates: a warning states how far the single precision of a NIfTI file shifts voxels, here by 0.044 in y.
far = make_ball(spacing=(0.2, 0.3, 0.4), origin=(500000.123, 5000000.456, 7.0), direction=turned)
write_vti(far, path("far.vti"))
small = ("--lattice", "3,3,3", "--push", "500000,5000000,7,0.00001,0,0,1000", "--bounds", "volume", "--quiet")
_, errors = call(program, path("far.vti"), *small, "-o", path("far.nii"))
with open(path("far.nii"), "rb") as file:
    stored = numpy.reshape(struct.unpack_from("<12f", file.read(), 280), (3, 4))
corners = numpy.array([[x, y, z, 1] for x in (0, 24) for y in (0, 21) for z in (0, 18)])
shift = numpy.linalg.norm(corners @ (stored - get_matrix(far)).T, axis=1).max()
found = re.findall(r"shifts voxels of \S+/far\.nii by up to (\S+), (\S+) times the smallest spacing", errors)
# The numbers have three digits.
assert found and numpy.allclose(numpy.array(found, float), [[shift, shift / 0.2]], rtol=5e-3), (errors, shift)
for source, name in (("far.vti", "far.mhd"), ("far.vti", "far.nrrd"), ("in.vti", "near.nii")):
    _, errors = call(program, path(source), *small, "-o", path(name))
    assert "shifts voxels" not in errors, errors
for name in ("far.mhd", "far.nrrd"):
    wrong = numpy.abs(get_matrix(convert(name, "e.vti")) - get_matrix(far)).max()
    assert wrong < 1e-8, wrong  # double precision

# A volume whose extent does not start at 0 keeps its position in the world, also in formats whose indices start at 0.
shifted = make_ball(direction=turned)
shifted.SetExtent(-4, 20, 3, 24, -1, 17)
shifted.GetPointData().ShallowCopy(volume.GetPointData())
write_vti(shifted, path("shifted.vti"))
for name in ("shifted.nii.gz", "shifted.mhd"):
    convert("shifted.vti", name)
    same(convert(name, "e.vti"), values, get_matrix(shifted))

# The values of cells: the cells of this image have the positions of the voxels of the shifted one. One cell is hidden.
cells = vtkImageData()
cells.SetExtent(-4, 21, 3, 25, -1, 18)
cells.SetSpacing(shifted.GetSpacing())
cells.SetDirectionMatrix(shifted.GetDirectionMatrix())
corner = [0.0, 0.0, 0.0]
shifted.TransformContinuousIndexToPhysicalPoint((-0.5, -0.5, -0.5), corner)
cells.SetOrigin(corner)
cells.GetCellData().ShallowCopy(volume.GetPointData())
write_vti(cells, path("cells.vti"))
same(convert("cells.vti", "e.vti"), values, get_matrix(shifted))
cells.AllocateCellGhostArray()
cells.GetCellGhostArray().SetValue(7, vtkDataSetAttributes.HIDDENCELL)
write_vti(cells, path("cells.vti"))
coverage = convert("cells.vti", "e.vti").GetPointData().GetArray("vtkValidPointMask")
covered = [coverage.GetValue(voxel) for voxel in range(coverage.GetNumberOfTuples())]
assert covered.count(0) == 1 and covered[7] == 0, covered.count(0)

# A reference image of one slice.
single = vtkImageData()
single.SetDimensions(volume.GetDimensions()[0], volume.GetDimensions()[1], 1)
single.SetSpacing(volume.GetSpacing())
single.SetDirectionMatrix(volume.GetDirectionMatrix())
volume.TransformIndexToPhysicalPoint(0, 0, 9, corner)
single.SetOrigin(corner)
write_vti(single, path("single.vti"))
call(program, path("in.vti"), *still, "-o", path("e.vti"), "--reference", path("single.vti"), "--quiet")
same(read_vti(path("e.vti")), values[9:10], get_matrix(single))

# --file-coordinates: the output has the coordinates that VTK's reader gives for a NIfTI file.
call(program, path("a.nii.gz"), *still, "-o", path("f.vti"), "--quiet", "--bounds", "volume",
     "--file-coordinates")
plain = numpy.column_stack([numpy.diag(volume.GetSpacing()), (0, 0, 0)])
same(read_vti(path("f.vti")), values, plain)
call(program, path("mirrored.nii.gz"), *still, "-o", path("f.vti"), "--quiet", "--bounds", "volume",
     "--file-coordinates")
same(read_vti(path("f.vti")), get_values(mirrored)[::-1], plain)

# Slope and intercept are applied once.
with gzip.open(path("a.nii.gz"), "rb") as file:
    raw = bytearray(file.read())
raw[112:120] = struct.pack("<ff", 2.5, -100.0)
with gzip.open(path("r.nii.gz"), "wb") as file:
    file.write(raw)
call(program, path("r.nii.gz"), *still, "-o", path("q.nii.gz"), "--quiet")
with gzip.open(path("q.nii.gz"), "rb") as file:
    assert struct.unpack("<ff", file.read()[112:120]) in ((0.0, 0.0), (1.0, 0.0))
