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
from vtkmodules.vtkCommonCore import vtkIdTypeArray
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

# UTM coordinates: a warning states by how much the single precision of a NIfTI file shifts voxels at most.
far = make_ball(spacing=(0.2, 0.3, 0.4), origin=(500000.123, 5000000.456, 7.0), direction=turned)
write_vti(far, path("far.vti"))
small = ("--lattice", "3,3,3", "--push", "500000,5000000,7,0.00001,0,0,1000", "--bounds", "volume", "--quiet")
_, errors = call(program, path("far.vti"), *small, "-o", path("far.nii"))
with open(path("far.nii"), "rb") as file:
    stored = numpy.reshape(struct.unpack_from("<12f", file.read(), 280), (3, 4))
corners = numpy.array([[x, y, z, 1] for x in (0, 24) for y in (0, 21) for z in (0, 18)])
shift = numpy.linalg.norm(corners @ (stored - get_matrix(far)).T, axis=1).max()
found = re.findall(r"shifts voxels of \S+/far\.nii by up to (\S+), (\S+) times the smallest spacing", errors)
most, voxels = numpy.array(found, float)[0]
assert 0.04 < shift < most < 1 and numpy.isclose(voxels, most / 0.2, rtol=1e-2), (errors, shift)
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

# Numbers of the type vtkIdType become 64-bit integers.
numbers = vtkIdTypeArray()
numbers.SetName("Ids")
for number in range(values.size):
    numbers.InsertNextValue(number - 7)
ids = vtkImageData()
ids.CopyStructure(volume)
ids.GetPointData().SetScalars(numbers)
write_vti(ids, path("ids.vti"))
for name in ("ids.nii", "ids.nii.gz", "ids.mha"):
    convert("ids.vti", name)
    same(convert(name, "e.vti"), (numpy.arange(values.size) - 7).reshape(values.shape), matrix)
with open(path("ids.nii"), "rb") as file:
    assert struct.unpack_from("<h", file.read(), 70) == (1024,), "the type is not INT64"

# Lengths of NRRD and MetaImage files in other units become mm.
diagonal = numpy.array([[1.0, 0, 0, 10], [0, 2, 0, 20], [0, 0, 3, -30]])


def write_nrrd(name, *lines):
    header = ["NRRD0005", "type: short", "dimension: 3", "sizes: 25 22 19", "endian: little", "encoding: raw", *lines]
    with open(path(name), "wb") as file:
        file.write("\n".join(header).encode() + b"\n\n" + values.astype("<i2").tobytes())


def write_world(name, *units):
    write_nrrd(name, "space: left-posterior-superior", "space directions: (1,0,0) (0,2,0) (0,0,3)",
               "space origin: (10,20,-30)",
               *(["space units: " + " ".join(f'"{unit}"' for unit in units)] if units else []))


def convert_quietly(name):
    """Returns the image of a file, and the warnings."""
    _, errors = call(program, path(name), "--carve", "sphere:-9,-9,-9,0.001", "-o", path("e.vti"), "--quiet", *(
        "--bounds", "volume"))
    return read_vti(path("e.vti")), errors


for unit, length in (("", 1), ("mm", 1), ("millimeter", 1), ("m", 1000), ("meters", 1000), ("cm", 10), ("um", 1e-3),
                     ("\u00b5m", 1e-3), ("\u03bcm", 1e-3), ("microns", 1e-3), ("micrometre", 1e-3), ("nm", 1e-6)):
    write_world("unit.nrrd", unit, unit, unit)
    image, errors = convert_quietly("unit.nrrd")
    same(image, values, diagonal * length)
    assert "unit" not in errors.replace("unit.nrrd", ""), errors
write_world("unit.nrrd")
same(convert_quietly("unit.nrrd")[0], values, diagonal)
write_world("unit.nrrd", "furlong", "furlong", "furlong")
image, errors = convert_quietly("unit.nrrd")
same(image, values, diagonal)
assert f'The unit of length of {path("unit.nrrd")}, "furlong", is not known' in errors, errors
write_world("unit.nrrd", "cm", "cm", "cm")
call(program, path("unit.nrrd"), *still, "-o", path("f.vti"), "--quiet", "--bounds", "volume", "--file-coordinates")
same(read_vti(path("f.vti")), values, diagonal)
for unit, length in (("mm", 1), ("cm", 10), ("um", 1e-3)):
    with open(path("unit.mha"), "wb") as file:
        file.write(f"ObjectType = Image\nNDims = 3\nBinaryData = True\nOffset = 10 20 -30\nElementSpacing = 1 2 3\n"
                   f"DistanceUnits = {unit}\nDimSize = 25 22 19\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"
                   .encode() + values.astype("<i2").tobytes())
    same(convert_quietly("unit.mha")[0], values, diagonal * length)

# The grid of an NRRD file without directions. Minima and maxima are at the borders of the outermost voxels (cell), or
# at their centers (node).
write_nrrd("axes.nrrd", "spacings: 1 2 3", 'units: "cm" "cm" "cm"')
same(convert_quietly("axes.nrrd")[0], values, 10 * numpy.diag([1.0, 2, 3, 0])[:3])
for centers, counts, shift in (("", (25, 22, 19), 0.5), ("cell cell cell", (25, 22, 19), 0.5),
                               ("node node node", (24, 21, 18), 0.0)):
    write_nrrd("axes.nrrd", "axis mins: 10 20 -30", "axis maxs: " + " ".join(
        str(first + step * count) for first, step, count in zip((10, 20, -30), (0.5, 2, 3), counts)),
               *([f"centers: {centers}"] if centers else []))
    spacing = numpy.array([0.5, 2, 3])
    same(convert_quietly("axes.nrrd")[0], values,
         numpy.column_stack([numpy.diag(spacing), numpy.array([10, 20, -30]) + shift * spacing]))

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
