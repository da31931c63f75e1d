# SPDX-License-Identifier: BSD-3-Clause
"""Tests that deform-volume reads displacement fields as registration programs write them, and converts them to the
world of the volume. Usage: TestFields.py PROGRAM FOLDER"""
import itertools
import os

import Messages
import numpy
from FieldFiles import LPS, RAS, flip, write_meta, write_nifti, write_nrrd
from MeshFiles import to_vtk
from Rotation import turn
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from Volumes import begin_test, call, read_vti, write_vti

program, path = begin_test("Fields")


def get_points(size, matrix):
    """Returns the world coordinates of all voxels as an array [z, y, x, axis]."""
    index = numpy.stack(numpy.meshgrid(*(numpy.arange(n) for n in reversed(size)), indexing="ij"),
                        axis=-1)[..., ::-1]
    return index @ matrix[:, :3].T + matrix[:, 3]


def make_image(size, matrix, name, values):
    image = vtkImageData()
    image.SetDimensions(*size)
    spacing = numpy.linalg.norm(matrix[:, :3], axis=0)
    image.SetSpacing(*spacing)
    image.SetOrigin(*matrix[:, 3])
    image.SetDirectionMatrix(*(matrix[:, :3] / spacing).ravel())
    image.GetPointData().AddArray(
        to_vtk(name, values.reshape(-1, values.shape[3]) if values.ndim == 4 else values.ravel()))
    if values.ndim == 3:
        image.GetPointData().SetActiveScalars(name)
    return image


def to(world, matrix):
    """Converts a matrix with rows in RAS to another world."""
    return matrix if world == RAS else flip @ matrix


# The volume and the field are defined in RAS. Values and displacements are affine functions of the position, so
# trilinear interpolation and interpolation in tetrahedra are exact.
size = (15, 12, 13)
axes = turn(2, 25) @ turn(0, -15) @ numpy.diag([1.0, 1.5, 2.0])
origin = numpy.array([-31.0, 12.0, -7.0])
volume = numpy.column_stack([axes, origin])
slope = numpy.array([3.0, -5.0, 7.0])
volume_values = (get_points(size, volume) @ slope).astype(numpy.float32)
middle = volume[:, :3] @ ((numpy.array(size) - 1) / 2) + origin
gradient = numpy.array([[0.08, 0.05, -0.02], [-0.04, -0.06, 0.03], [0.02, 0.07, 0.05]])
shift = numpy.array([1.5, -2.0, 3.0])

field_size = (7, 6, 5)
field_axes = turn(1, 40) @ turn(0, 10) @ numpy.diag([7.0, 8.0, 11.0])
field = numpy.column_stack([field_axes, middle - field_axes @ ((numpy.array(field_size) - 1) / 2)])
vectors = (get_points(field_size, field) - middle) @ gradient.T + shift

for name, world in (("volume.nii.gz", RAS), ("volume.mhd", LPS), ("volume.vti", RAS)):
    if name.endswith(".vti"):
        write_vti(make_image(size, volume, "Values", volume_values), path(name))
    elif world == RAS:
        write_nifti(path(name), volume_values[..., None], volume, 0, shape=size)
    else:
        write_meta(path(name), volume_values[..., None], to(LPS, volume))


def deform(volume_name, field_name, *options):
    call(program, path(volume_name), "--field", path(field_name), "-o", path("out.vti"), "--quiet",
         *options)
    image = read_vti(path("out.vti"))
    size, extent = image.GetDimensions(), image.GetExtent()
    direction = image.GetDirectionMatrix()
    matrix = numpy.array([[direction.GetElement(row, column) for column in range(3)]
                          for row in range(3)]) * numpy.array(image.GetSpacing())
    first = matrix @ numpy.array(extent[::2]) + numpy.array(image.GetOrigin())
    data = image.GetPointData()
    values = vtk_to_numpy(data.GetArray(0)).reshape(size[::-1])
    covered = vtk_to_numpy(data.GetArray("vtkValidPointMask")).reshape(size[::-1]) != 0
    return get_points(size, numpy.column_stack([matrix, first])), values, covered


# Errors: the rounding of positions, at most 1/512 output voxel on each axis, and the single precision of files and
# field, for numbers up to 600.
back = numpy.linalg.inv(numpy.eye(3) + gradient)
bound = numpy.abs(slope @ back @ axes).sum() / 512 + 600 * 2.0 ** -20


def check(volume_name, field_name, *options, scale=1.0):
    points, values, covered = deform(volume_name, field_name, *options)
    if volume_name.endswith(".mhd"):
        points = points @ flip
    inverse = numpy.linalg.inv(numpy.eye(3) + scale * gradient)
    rest = (points - middle - scale * shift) @ inverse.T + middle
    wrong = numpy.abs(values - rest @ slope)[covered]
    # No part of the volume is lost: all output voxels whose rest position lies inside the volume are covered.
    index = numpy.linalg.solve(axes, (rest - origin).reshape(-1, 3).T).T.reshape(rest.shape)
    inside = ((index > 0.01) & (index < numpy.array(size) - 1.01)).all(axis=-1)
    assert inside.sum() > 1000, inside.sum()
    assert covered[inside].all(), f"{(~covered[inside]).sum()} voxels inside the volume are not covered"
    assert not covered[((index < -0.01) | (index > numpy.array(size) - 0.99)).any(axis=-1)].any()
    assert wrong.max() < bound, (wrong.max(), bound)


# Numbers first: each format, each byte order, in the world of each volume.
write_vti(make_image(field_size, field, "U", vectors), path("f.vti"))
check("volume.vti", "f.vti")
check("volume.nii.gz", "f.vti", "--displacement", "U", "--scale", "0.5", scale=0.5)
single, double = vectors.astype(numpy.float32), vectors
in_lps = flip @ field
fields = []


def add(name, write, *arguments, **options):
    write(path(name), *arguments, **options)
    fields.append(name)


add("ras.nii", write_nifti, single, field, 1006)
add("lps.nii.gz", write_nifti, single @ flip.astype(numpy.float32), field, 1007)
add("big.nii", write_nifti, double @ flip, field, 1007, order=">")
steps = numpy.round(vectors / 0.0005 - 200).astype(numpy.int16)
add("scaled.nii", write_nifti, steps, field, 1006, slope=(0.0005, 0.1))
add("a.mha", write_meta, single @ flip.astype(numpy.float32), in_lps)
add("big.mhd", write_meta, double @ flip, in_lps, order=">")
add("zip.mha", write_meta, double @ flip, in_lps, compressed=True)
add("a.nrrd", write_nrrd, single @ flip.astype(numpy.float32), in_lps)
add("zip.nrrd", write_nrrd, double @ flip, in_lps, encoding="gzip")
add("big.nhdr", write_nrrd, double @ flip, in_lps, order=">")
add("last.nrrd", write_nrrd, double @ flip, in_lps, axis=3)
add("second.nrrd", write_nrrd, single @ flip.astype(numpy.float32), in_lps, axis=1, order=">",
    encoding="gzip")
add("ras.nrrd", write_nrrd, double, field, space=RAS)
frame = turn(0, 30) @ turn(1, 20)
add("skip.nrrd", write_nrrd, double @ flip, in_lps, skip=12)
turn_y = numpy.diag([1.0, -1.0, 1.0])
las = turn_y @ in_lps
add("las.nrrd", write_nrrd, double @ flip @ turn_y, las, space="left-anterior-superior")
add("frame.nrrd", write_nrrd, double @ flip @ frame, in_lps, frame=frame)
for volume_name, field_name in itertools.product(("volume.nii.gz", "volume.mhd"), fields):
    check(volume_name, field_name)
# By default fields are in the world of the volume, which is right-anterior-superior. An option states another world.
check("volume.nii.gz", "f.vti", "--field-space", "ras")
write_vti(make_image(field_size, in_lps, "U", vectors @ flip), path("lps.vti"))
check("volume.nii.gz", "lps.vti", "--field-space", "lps")
write_nrrd(path("any.nrrd"), double, field, space="3D-right-handed")
for volume_name in ("volume.nii.gz", "volume.mhd"):
    check(volume_name, "any.nrrd", "--field-space", "ras")
# The axes of the file are left-handed.
mirrored = field.copy()
mirrored[:, 3] += 4 * mirrored[:, 2]
mirrored[:, 2] *= -1
write_nifti(path("mirrored.nii"), single[::-1], mirrored, 1006)
check("volume.mhd", "mirrored.nii")


# An inverse field: the value of an output voxel is that of the volume at the point to which the field leads.
field_points = get_points(field_size, field)
inverse = (field_points - middle - shift) @ back.T + middle - field_points
write_nifti(path("inverse.nii"), (inverse @ flip).astype(numpy.float32), field, 1007)
for volume_name in ("volume.nii.gz", "volume.mhd"):
    points, values, covered = deform(volume_name, "inverse.nii", "--field-is-inverse")
    points = points @ flip if volume_name.endswith(".mhd") else points
    rest = (points - middle - shift) @ back.T + middle
    assert covered.sum() > 1000, covered.sum()
    # Points up to 1/256 voxel outside the volume are covered, with the values of the border.
    index = numpy.linalg.solve(axes, (rest - origin).reshape(-1, 3).T).T.reshape(rest.shape)
    inside = covered & (index >= 0).all(axis=-1) & (index <= numpy.array(size) - 1).all(axis=-1)
    wrong = numpy.abs(values - rest @ slope)[inside].max()
    assert wrong < 600 * 2.0 ** -18, wrong
# Files with positions instead of displacements: those of the identity, and those of a small displacement.
for name, values in (("identity.nii", field_points), ("positions.nii", field_points + vectors)):
    write_nifti(path(name), values.astype(numpy.float32), field, 1006)
# RAS positions in a file that states LPS.
write_nifti(path("mirrored-positions.nii"), (field_points + vectors).astype(numpy.float32), field, 1007)
write_nifti(path("folded.nii"), (-2 * (field_points - middle)).astype(numpy.float32), field, 1006)
write_nrrd(path("kind.nrrd"), single @ flip.astype(numpy.float32), in_lps,
           extra="displacement field type:=resampling\n")
inverse_flag = ("--field-is-inverse",)
for field_name, options, words in (
        ("identity.nii", (), "look like the positions"),
        ("positions.nii", inverse_flag, "look like the positions"),
        ("mirrored-positions.nii", (), "The file also states the wrong world coordinates"),
        ("folded.nii", inverse_flag, "The field folds"), ("folded.nii", (), "The deformation folds the volume"),
        ("inverse.nii", inverse_flag, ""),
        ("kind.nrrd", (), "needs --field-is-inverse"), ("kind.nrrd", inverse_flag, "")):
    _, errors = call(program, path("volume.nii.gz"), "--field", path(field_name), "-o", path("out.vti"),
                     "--quiet", *options)
    assert words in errors and (words or "warning:" not in errors), errors


# A field for --transform is inverse.
write_nrrd(path("kind.nrrd"), single @ flip.astype(numpy.float32), in_lps,
           extra="displacement field type:=modeling\n")
transform = (path("volume.nii.gz"), "-o", path("no.vti"), "--transform")
Messages.warns(program, "Give it with --field, without --field-is-inverse", *transform, path("kind.nrrd"))
os.remove(path("no.vti"))
Messages.fails(program, 1, "Or give it with --field and --field-space", *transform, path("any.nrrd"))


# A file that cannot be read is an error that states the reason.
def fails(expected, field_name, *options, code=1):
    Messages.fails(program, code, expected, path("volume.nii.gz"), "--field", path(field_name), "-o", path("no.vti"),
                   *options)
    assert not os.path.exists(path("no.vti"))


def fails_nifti(expected, *arguments, **options):
    write_nifti(path("wrong.nii"), *arguments, **options)
    fails(expected, "wrong.nii")


fails_nifti("shape is (7, 6, 5, 3)", single, field, 1006, shape=(*field_size, 3))
fails_nifti("data[:, :, :, None, :]", single, field, 0, shape=(*field_size, 3))
fails_nifti("no vectors", single[..., :1], field, 1007, shape=field_size)
fails_nifti("two components", single[..., :2], field, 1007)
fails_nifti("has 4 components", numpy.concatenate([single, single[..., :1]], -1), field, 1007)
write_nifti(path("wrong.nii"), single, field, 1006, unit=3)
fails("its unit of length is the micrometre", "wrong.nii")
fails_nifti("varies in time", numpy.concatenate([single, single], -1), field, 1007,
            shape=(*field_size, 2, 3))
fails_nifti("its intent is 0", single, field, 0)
fails_nifti("its intent is 1005", single, field, 1005)
fails_nifti("FSL", single, field, 2006, shape=(*field_size, 3))
fails_nifti("SPM", single, field, 1007, name="Mapping")
fails_nifti("NiftyReg", single, field, 1007, name="NREG_TRANS")
fails_nifti("perpendicular", single, field @ numpy.array(
    [[1, 0.3, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]]), 1006)
write_meta(path("wrong.mha"), single[..., :2], in_lps)
fails("2 components", "wrong.mha")
for unit, name in (("cm", "cm"), ("um", "um")):
    write_meta(path("wrong.mha"), single, in_lps, extra=f"DistanceUnits = {unit}\n")
    fails(f"its unit of length is {name}", "wrong.mha")
write_nrrd(path("wrong.nrrd"), single, in_lps, extra='space units: "cm" "cm" "cm"\n')
fails("its unit of length is cm", "wrong.nrrd")
# Two time steps.
for name, kind, header in (
        ("time.nrrd", "list", "NRRD0005\ntype: float\ndimension: 5\nspace: left-posterior-superior\nsizes: 3 7 6 5 2\n"
         "space directions: none (7,0,0) (0,8,0) (0,0,11) none\nkinds: vector domain domain domain list\n"
         "endian: little\nencoding: raw\nspace origin: (0,0,0)\n\n"),
        ("time.mha", "", "ObjectType = Image\nNDims = 4\nBinaryData = True\nElementNumberOfChannels = 3\n"
         "DimSize = 7 6 5 2\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n")):
    with open(path(name), "wb") as file:
        file.write(header.encode() + bytes(2 * single.nbytes))
    fails("it varies in time, with 2 time steps. Extract one time step", name)
    Messages.fails(program, 1, "it varies in time, with 2 time steps", path("volume.nii.gz"), "--transform", path(name),
                   "-o", path("no.vti"))
write_nrrd(path("wrong.nrrd"), single, in_lps, space="scanner-xyz")
fails("right-anterior-superior", "wrong.nrrd")
_, errors = call(program, path("volume.vti"), "--field", path("f.vti"), "--field-space", "lps", "-o",
                 path("no.vti"), code=1)
assert "does not state whether its world coordinates are lps or ras" in errors, errors
_, errors = call(program, path("volume.nii.gz"), "--field", path("ras.nii"), "--field-space", "lps",
                 "-o", path("out.vti"), "--quiet")
assert "ras.nii states that it is ras" in errors, errors
_, errors = call(program, path("volume.nii.gz"), "--field", path("lps.nii.gz"), "--field-space", "ras",
                 "-o", path("out.vti"), "--quiet")
assert "are lps, as its intent 1007 says" in errors, errors
fails("no such file", "missing.nii")
with open(path("transform.h5"), "wb") as file:
    file.write(b"x")
fails("convert", "transform.h5")
fails("--displacement names", "ras.nii", "--displacement", "U", code=2)
fails("--push requires", "ras.nii", "--push", "1,2,3,4,5,6,7", code=2)
fails("excludes", "ras.nii", "--file-coordinates", code=2)
fails("exactly one of", "ras.nii", "--lattice", "3,3,3", code=2)
_, errors = call(program, path("volume.nii.gz"), "--mesh", path("ras.nii"), "--displacement", "U",
                 "-o", path("no.vti"), code=1)
assert "--field" in errors, errors
for option in (("--field-is-inverse",), ("--field-space", "lps")):
    _, errors = call(program, path("volume.nii.gz"), "--lattice", "3,3,3", "--push", "1,2,3,4,5,6,7",
                     *option, "-o", path("no.vti"), code=2)
    assert f"{option[0]} requires --field" in errors, errors
