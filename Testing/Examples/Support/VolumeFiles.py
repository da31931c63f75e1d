# SPDX-License-Identifier: BSD-3-Clause
"""Writes volumes with SimpleITK, pynrrd and nibabel. cases.json lists them, with the names of arrays
[z, y, x(, component)] that these programs read from them.
Usage, with the Python that "Testing/packages.sh readers" installs: VolumeFiles.py FOLDER"""
import json
import os
import sys

import nibabel
import nrrd
import numpy
import SimpleITK
from Rotation import turn

folder = sys.argv[1]
data_path = os.path.join(os.path.dirname(nibabel.__file__), "tests", "data")
random = numpy.random.default_rng(5)
types = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64")
flip = numpy.diag([-1.0, -1.0, 1.0, 1.0])
size = (5, 6, 7)
cases = []


def path(name):
    return os.path.join(folder, name)


def make_values(kind, *shape):
    """Returns random values in which all bits are used."""
    kind = numpy.dtype(kind)
    if kind.kind == "f":
        return random.normal(scale=1000, size=shape).astype(kind)
    limits = numpy.iinfo(kind)
    values = random.integers(limits.min, limits.max, size=shape, dtype=kind, endpoint=True)
    values.flat[:2] = limits.min, limits.max
    return values


def make_colors(*shape):
    return numpy.frombuffer(make_values("uint8", *shape, 3).tobytes(),
                            [("R", "u1"), ("G", "u1"), ("B", "u1")]).reshape(shape)


def make_place(direction, spacing=(0.7, 1.5, 2.2), origin=(-31.5, 42.25, 13.0)):
    place = numpy.eye(4)
    place[:3, :3] = direction * numpy.array(spacing)
    place[:3, 3] = origin
    return place


oblique = make_place(turn(2, 30) @ turn(0, -20))
mirrored = make_place(turn(1, 25) @ numpy.diag([1.0, 1.0, -1.0]))
other = make_place(turn(0, 12), origin=(5, 6, 7))


def add(name, values, place, *arguments, warnings=(), shear=0, farthest=0, is_ras=False):
    """Adds a file to the cases. values: array [z, y, x(, component)]; place: the matrix from the index to the world of
    the file; shear: the cosine of the angle between sheared axes; farthest: the largest distance by which voxels are
    moved to make the axes perpendicular, in mm."""
    values_name = f"{len(cases)}.npy"
    numpy.save(path(values_name), values.astype(values.dtype.newbyteorder("=")))
    cases.append({"file": name, "values": values_name, "place": numpy.array(place).tolist(),
                  "arguments": arguments, "warnings": warnings, "shear": shear, "farthest": farthest,
                  "ras": is_ras})


def write_bytes(name, header, data=b""):
    with open(path(name), "wb") as file:
        file.write(header.encode() + data)


# MetaImage and NRRD files as SimpleITK writes them: all types, with the header in the same file and in another one,
# with and without compression.
def to_itk(values, place, is_vector=False):
    image = SimpleITK.GetImageFromArray(values, isVector=is_vector)
    spacing = numpy.linalg.norm(place[:3, :3], axis=0)
    image.SetSpacing(spacing)
    image.SetDirection((place[:3, :3] / spacing).ravel())
    image.SetOrigin(place[:3, 3])
    return image


def add_itk(name, *arguments, frame=None, **options):
    image = SimpleITK.ReadImage(path(name))
    image = image if frame is None else image[:, :, :, frame]
    place = make_place(numpy.array(image.GetDirection()).reshape(3, 3), image.GetSpacing(),
                       image.GetOrigin())
    add(name, SimpleITK.GetArrayFromImage(image), place, *arguments, **options)


for number, kind in enumerate(types):
    image = to_itk(make_values(kind, *size), (oblique, mirrored)[number % 3 // 2])
    for name in (f"{kind}{('.mha', '.mhd', '-zip.mha', '-zip.mhd')[number % 4]}",
                 f"{kind}{('-zip.nrrd', '.nhdr', '.nrrd', '-zip.nhdr')[number % 4]}"):
        SimpleITK.WriteImage(image, path(name), useCompression="zip" in name)
        add_itk(name)
for name, kind, components in (("color.mha", "uint8", 3), ("color.nrrd", "uint8", 4),
                               ("vector.mhd", "float64", 3), ("vector.nrrd", "int16", 2)):
    SimpleITK.WriteImage(to_itk(make_values(kind, *size, components), oblique, True), path(name))
    add_itk(name)
frames = [to_itk(make_values("int16", *size), oblique) for _ in range(3)]
SimpleITK.WriteImage(SimpleITK.JoinSeries(frames), path("time.mha"))
add_itk("time.mha", "--frame", "1", frame=1)

# MetaImage files as other programs write them, read by SimpleITK.
values = make_values("int16", *size)
start = ("ObjectType = Image\nNDims = 3\nBinaryData = True\nOffset = 1 2 3\nElementSpacing = 1 2 3\n"
         "DimSize = 7 6 5\n")
short, local = start + "ElementType = MET_SHORT\n", "ElementDataFile = LOCAL\n"
write_bytes("long.mha", start + "ElementType = MET_LONG\n" + local, make_values("int32", *size).tobytes())
write_bytes("big.mha", short + "BinaryDataByteOrderMSB = True\n" + local, values.astype(">i2").tobytes())
write_bytes("ascii.mha", short.replace("BinaryData = True", "BinaryData = False") + local +
            " ".join(map(str, values.ravel())) + "\n")
write_bytes("skip.mhd", short + "HeaderSize = -1\nElementDataFile = skip.raw\n")
write_bytes("skip.raw", "a header", values.tobytes())
write_bytes("list.mhd", short + "ElementDataFile = LIST\n" + "".join(f"{i}.raw\n" for i in range(5)))
write_bytes("pattern.mhd", short + "ElementDataFile = %d.raw 0 4 1\n")
for i in range(5):
    write_bytes(f"{i}.raw", "", values[i].tobytes())
write_bytes("size.mha", short.replace("Spacing", "Size") + local, values.tobytes())
write_bytes("factor.mha", short + "TransformMatrix = 0 2 0 -0.5 0 0 0 0 1\n" + local, values.tobytes())
for name in ("long.mha", "big.mha", "ascii.mha", "skip.mhd", "list.mhd", "pattern.mhd", "size.mha",
             "factor.mha"):
    add_itk(name)


# NRRD files as pynrrd writes them, with the components or frames on any axis. The arrays of pynrrd are [x, y, z].
def write_nrrd(name, values, place=oblique, space="left-posterior-superior", axis=0, kind="vector",
               **header):
    directions, kinds = [place[:3, i] for i in range(3)], ["domain"] * 3
    if values.ndim == 4:
        directions.insert(axis, numpy.full(3, numpy.nan))
        kinds.insert(axis, kind)
    nrrd.write(path(name), values, {"space": space, "kinds": kinds, "encoding": "raw",
               "space directions": numpy.array(directions), "space origin": place[:3, 3], **header},
               detached_header=name.endswith(".nhdr"), relative_data_path=True)


def add_nrrd(name, *arguments, axis=None, frame=None, turned=(1, 1, 1), **options):
    values, header = nrrd.read(path(name))
    directions = header["space directions"]
    place = numpy.eye(4)
    place[:3, :3] = directions[~numpy.isnan(directions).any(axis=1)].T
    place[:3, 3] = header["space origin"]
    if frame is not None:
        values = values.take(frame, axis)
    elif axis is not None:
        values = numpy.moveaxis(values, axis, 3)
    add(name, values.transpose(2, 1, 0, *range(3, values.ndim)), numpy.diag([*turned, 1.0]) @ place,
        *arguments, **options)


xyz = values.transpose(2, 1, 0)
for encoding in ("gzip", "ascii"):
    for name in (f"{encoding}.nrrd", f"{encoding}.nhdr"):
        write_nrrd(name, xyz, encoding=encoding)
        add_nrrd(name)
write_nrrd("big.nrrd", xyz.astype(">i2"), endian="big")
add_nrrd("big.nrrd")
write_nrrd("ras.nrrd", xyz, space="right-anterior-superior", encoding="gzip")
add_nrrd("ras.nrrd", is_ras=True)
write_nrrd("RAS.nhdr", xyz, mirrored, space="RAS")
add_nrrd("RAS.nhdr", is_ras=True)
write_nrrd("las.nrrd", xyz, space="left-anterior-superior")
add_nrrd("las.nrrd", turned=(1, -1, 1))
write_nrrd("scanner.nrrd", xyz, space="scanner-xyz")
add_nrrd("scanner.nrrd")
for axis in range(4):
    vectors = numpy.moveaxis(make_values("float32", 4, 5, 6, 3), 3, axis)
    write_nrrd(f"vector{axis}.nrrd", vectors, axis=axis)
    add_nrrd(f"vector{axis}.nrrd", axis=axis)
    kind = ("domain", "time", "list", "time")[axis]
    write_nrrd(f"{kind}{axis}.nrrd", make_values("int16", 4, 4, 4, 4), axis=axis, kind=kind)
    add_nrrd(f"{kind}{axis}.nrrd", "--frame", "2", axis=axis, frame=2)
nrrd.write(path("spacings.nrrd"), xyz, {"spacings": [1.0, 2.0, 3.0], "kinds": ["domain"] * 3})
add("spacings.nrrd", values, numpy.diag([1.0, 2.0, 3.0, 1.0]))


# NIfTI files as nibabel writes them.
def write_nifti(name, values, sform=None, qform=None, codes=(1, 1), kind=nibabel.Nifti1Image, **header):
    image = kind(values, None, dtype=values.dtype)
    for key, value in header.items():
        image.header[key] = value
    image.set_sform(sform, code=0 if sform is None else codes[0])
    image.set_qform(qform, code=0 if qform is None else codes[1])
    if sform is not None and qform is None:
        image.header["pixdim"][1:4] = numpy.linalg.norm(sform[:3, :3], axis=0)
    nibabel.save(image, path(name))


def add_nifti(name, *arguments, frame=None, millimetres=1, kind=None, **options):
    image = nibabel.load(path(name))
    values = numpy.asanyarray(image.dataobj)
    if values.dtype.fields:
        values = numpy.stack([values[name] for name in values.dtype.names], axis=-1)
    if frame is not None:
        values = values[:, :, :, frame]
    elif values.ndim == 5:
        values = values[:, :, :, 0]
    place = image.affine.copy()
    if not image.header["sform_code"] and not image.header["qform_code"]:
        # Without a form, nibabel places the center of the volume at 0, and the standard places the first voxel there.
        place = numpy.diag([*image.header.get_zooms()[:3], 1.0])
    place[:3] *= millimetres
    values = values.transpose(2, 1, 0, *range(3, values.ndim))
    add(name, values if kind is None else values.astype(kind), place, *arguments, is_ras=True, **options)


for number, kind in enumerate(types):
    name = f"{kind}.nii" + ("", ".gz")[number % 2]
    write_nifti(name, make_values(kind, *size), (oblique, mirrored)[number // 5])
    add_nifti(name)
values = make_values("int16", *size)
write_nifti("q.nii.gz", values, qform=oblique)
write_nifti("q-mirrored.nii.gz", values, qform=mirrored, codes=(0, 3))
write_nifti("both.nii", values, oblique, other, codes=(4, 1))
write_nifti("s-mirrored.nii", values, mirrored, other)
write_nifti("one-mirrored.nii", values, oblique, mirrored)
write_nifti("both-mirrored.nii.gz", values, mirrored, mirrored)
write_nifti("scaled-mirrored.nii", values, make_place(turn(0, 30), (2, 3, 4)), mirrored, codes=(2, 1))
write_nifti("scaled-form.nii", values, make_place(turn(0, 30), (2, 3, 4)), other, codes=(2, 1))
write_nifti("neither.nii", values, pixdim=(1, 2, 3, 4, 1, 1, 1, 1))
write_nifti("two.nii", values, oblique, kind=nibabel.Nifti2Image)
write_nifti("two.nii.gz", values, oblique, other, kind=nibabel.Nifti2Image)
write_nifti("color.nii", make_colors(*size), oblique)
write_nifti("vectors.nii", make_values("float32", *size, 1, 3), oblique)
big = nibabel.Nifti1Header(endianness=">")
big.set_data_dtype(">f4")
nibabel.save(nibabel.Nifti1Image(values.astype(">f4"), oblique, big), path("big.nii"))
extended = nibabel.Nifti1Image(values, oblique)
extended.header.extensions.append(nibabel.nifti1.Nifti1Extension("comment", b"x" * 1000))
nibabel.save(extended, path("extended.nii"))
for name in ("q.nii.gz", "q-mirrored.nii.gz", "both.nii", "s-mirrored.nii", "one-mirrored.nii",
             "both-mirrored.nii.gz", "scaled-mirrored.nii", "scaled-form.nii", "neither.nii", "two.nii", "two.nii.gz", "color.nii",
             "vectors.nii", "big.nii", "extended.nii"):
    add_nifti(name)
for unit, millimetres in ((1, 1000), (3, 0.001), (0, 1)):
    write_nifti(f"unit{unit}.nii", values, oblique, other, xyzt_units=unit)
    add_nifti(f"unit{unit}.nii", millimetres=millimetres)
# With an s-form the sign of pixdim is ignored.
write_nifti("negative.nii", values, oblique)
with open(path("negative.nii"), "rb+") as file:
    file.seek(80)
    file.write(numpy.float32(-0.7).tobytes())
add_nifti("negative.nii")
# Integers stay integers if slope and intercept are integers.
for number, (kind, slope, result) in enumerate((
        ("int16", (1, -1024), "int32"), ("uint8", (2, -3), "int16"), ("uint16", (1, -1024), "int32"),
        ("int32", (1, 5), "float64"), ("uint8", (0.5, 0), "float32"), ("int16", (0.1, 3.3), "float32"),
        ("int32", (0.1, 0), "float64"), ("float32", (2, 1), "float32"), ("int8", (0, 9), "int8"),
        ("uint8", (numpy.nan, 9), "uint8"))):
    write_nifti(f"slope{number}.nii", make_values(kind, *size), oblique)
    with open(path(f"slope{number}.nii"), "rb+") as file:
        file.seek(112)
        file.write(numpy.array(slope, "<f4").tobytes())
    add_nifti(f"slope{number}.nii", kind=result)
write_nifti("time.nii.gz", make_values("int16", *size, 3), oblique)
add_nifti("time.nii.gz", "--frame", "2", frame=2)
write_nifti("time-color.nii", make_colors(*size, 3), mirrored)
add_nifti("time-color.nii", "--frame", "1", frame=1)
write_nifti("time-vectors.nii", make_values("float32", *size, 3, 2), oblique)
add_nifti("time-vectors.nii", "--frame", "1", frame=1)
# Files in the package nibabel.
for name, frame, kind in (
        ("standard.nii.gz", None, None), ("example4d.nii.gz", 1, None), ("example_nifti2.nii.gz", 1, None),
        ("anatomical.nii", None, None), ("functional.nii", 19, "float32"),
        ("reoriented_anat_moved.nii", None, None), ("resampled_anat_moved.nii", None, None)):
    arguments = () if frame is None else ("--frame", str(frame))
    add_nifti(os.path.join(data_path, name), *arguments, frame=frame, kind=kind)


# Sheared axes: a shear of up to 1e-3 is removed, about the middle of the volume. From 1e-5 on there is a warning.
def say_shear(place, shape):
    lengths = numpy.linalg.norm(place[:3, :3], axis=0)
    columns = place[:3, :3] / lengths
    cosines = numpy.abs(columns.T @ columns)
    # The nearest perpendicular axes are those of the polar decomposition.
    u, _, v = numpy.linalg.svd(columns)
    half = (numpy.array(shape) - 1) / 2
    corners = numpy.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) * half
    farthest = numpy.linalg.norm((u @ v - columns) * lengths @ corners.T, axis=0).max()
    shear = cosines[numpy.triu_indices(3, 1)].max()
    return {"shear": shear, "farthest": farthest,
            "warnings": ["sheared"] if shear > 1e-5 else []}


for name, shear in (("rounded", 8e-6), ("little", 2e-4), ("much", 9.9e-4)):
    for start, suffix in ((oblique, "mha"), (mirrored, "mhd"), (mirrored, "nrrd"), (oblique, "nii")):
        sheared = start.copy()
        sheared[:3, 1] += shear * start[:3, 0] / 0.7 * 1.5
        file = f"{name}-shear.{suffix}"
        if suffix == "nii":
            write_nifti(file, values, sheared)
            add_nifti(file, **say_shear(nibabel.load(path(file)).affine, values.shape))
        elif suffix == "nrrd":
            write_nrrd(file, xyz, sheared)
            add_nrrd(file, **say_shear(sheared, xyz.shape))
        else:
            SimpleITK.WriteImage(to_itk(xyz.T, sheared), path(file))
            add_itk(file, **say_shear(sheared, xyz.shape))

with open(path("cases.json"), "w", encoding="utf-8") as file:
    json.dump(cases, file)
