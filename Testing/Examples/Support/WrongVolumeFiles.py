# SPDX-License-Identifier: BSD-3-Clause
"""Writes volumes that cannot be read, and lists them in wrong.json: [file, words of the error, further arguments].
Usage, with the Python that "Testing/packages.sh readers" installs: WrongVolumeFiles.py FOLDER"""
import gzip
import json
import os
import sys
import zlib

import nibabel
import numpy

folder = sys.argv[1]
values = numpy.random.default_rng(2).integers(-9999, 9999, (5, 6, 7), dtype=numpy.int16)
place = numpy.diag([1.0, 2.0, 3.0, 1.0])
nan, inf = numpy.nan, numpy.inf
wrong = []


def add(name, words, data, *arguments):
    with open(os.path.join(folder, name), "wb") as file:
        file.write(data)
    wrong.append([name, words, *arguments])


def shear(amount):
    sheared = place.copy()
    sheared[0, 1] = 2 * amount
    return sheared


# NIfTI files with changed bytes in the header.
def make_nifti(array=values, sform=place, qform=None, kind=nibabel.Nifti1Image, patches=()):
    image = kind(array, None, dtype=array.dtype)
    image.set_sform(sform, 0 if sform is None else 1)
    image.set_qform(qform, 0 if qform is None else 1)
    data = bytearray(image.to_bytes())
    for offset, code, *numbers in patches:
        changed = numpy.array(numbers, code).tobytes()
        data[offset:offset + len(changed)] = changed
    return bytes(data)


nifti = make_nifti()
zipped = gzip.compress(nifti)
for name, words, data, *arguments in (
        ("complex.nii", "complex", make_nifti(values.astype("complex64"))),
        ("complex128.nii", "complex", make_nifti(values.astype("complex128"))),
        ("quad.nii", "type 1536", make_nifti(patches=[(70, "<i2", 1536, 128)])),
        ("bits.nii", "type 1,", make_nifti(patches=[(70, "<i2", 1, 1)])),
        ("empty.nii", "its axis 2 has the length 0", make_nifti(patches=[(40, "<i2", 3, 5, 0, 7)])),
        ("negative.nii", "its axis 2 has the length -6", make_nifti(patches=[(40, "<i2", 3, 5, -6, 7)])),
        ("many-axes.nii", "it has 8 axes", make_nifti(patches=[(40, "<i2", 2048)])),
        ("no-axes.nii", "1 x 1 x 1 voxels", make_nifti(patches=[(40, "<i2", 0)])),
        ("six.nii", "it has 6 axes", make_nifti(numpy.zeros((3, 3, 3, 1, 1, 2), "i2"))),
        ("seven.nii", "it has 7 axes", make_nifti(numpy.zeros((3, 3, 3, 1, 1, 1, 2), "i2"))),
        ("slice.nii", "4 x 4 x 1 voxels", make_nifti(numpy.zeros((4, 4, 1), "i2"))),
        ("time.nii", "--frame 0 to 2", make_nifti(numpy.zeros((4, 4, 4, 3), "i2"))),
        ("time.nii", "--frame 0 to 2", make_nifti(numpy.zeros((4, 4, 4, 3), "i2")), "--frame", "3"),
        ("one.nii", "one frame, number 0", nifti, "--frame", "1"),
        ("size.nii", "the voxel spacing nan on axis 0",
         make_nifti(patches=[(280, "<f4", nan)])),
        ("zero.nii", "the voxel spacing 0 on axis 0",
         make_nifti(patches=[(280, "<f4", 0), (296, "<f4", 0), (312, "<f4", 0)])),
        ("position.nii", "the position inf of the first voxel on axis 0",
         make_nifti(patches=[(292, "<f4", inf)])),
        ("pixdim.nii", "the voxel spacing nan on axis 0", make_nifti(patches=[(80, "<f4", nan)])),
        ("q-nan.nii", "nan", make_nifti(sform=None, qform=place, patches=[(256, "<f4", nan)])),
        ("q-long.nii", "quaternion",
         make_nifti(sform=None, qform=place, patches=[(256, "<f4", 0.8, 0.8, 0.8)])),
        ("q-negative.nii", "the voxel spacing -2.000000 on axis 1",
         make_nifti(sform=None, qform=place, patches=[(84, "<f4", -2)])),
        ("unit.nii", "unit of length, 5", make_nifti(patches=[(123, "u1", 5)])),
        ("slope.nii", "slope", make_nifti(patches=[(112, "<f4", inf, 0)])),
        ("intercept.nii", "intercept", make_nifti(patches=[(112, "<f4", 1, nan)])),
        ("magic.nii", "n+1", make_nifti(patches=[(344, "S4", b"xyz")])),
        ("pair.nii", "n+1", make_nifti(patches=[(344, "S4", b"ni1")])),
        ("offset.nii", "byte 0, within the header", make_nifti(patches=[(108, "<f4", 0)])),
        ("offset2.nii", "within the header",
         make_nifti(kind=nibabel.Nifti2Image, patches=[(168, "<i8", 352)])),
        ("far.nii", "truncated", make_nifti(patches=[(108, "<f4", 100000)])),
        ("half.nii", "truncated", nifti[:500]), ("last.nii", "truncated", nifti[:-1]),
        ("half.nii.gz", "truncated", zipped[:len(zipped) // 2]),
        ("text.nii", "it is not a NIfTI file", b"hello"), ("text.nii.gz", "it is not a NIfTI file", b"hello"),
        ("none.nii.gz", "it is not a NIfTI file", b""),
        ("shear.nii", "sheared by 0.0687", make_nifti(sform=shear(0.0012))),
        ("tilt.nii", "sheared by 16.7", make_nifti(sform=shear(0.3))),
        ("tilt-q.nii", "set sform_code to 0", make_nifti(sform=shear(0.3), qform=place))):
    add(name, words, data, *arguments)


# MetaImage files with changed fields in the header. The value None removes a field.
def make_meta(data=values.tobytes(), **fields):
    header = {"ObjectType": "Image", "NDims": 3, "BinaryData": True, "ElementSpacing": "1 2 3",
              "DimSize": "7 6 5", "ElementType": "MET_SHORT", **fields}
    name = header.pop("ElementDataFile", "LOCAL")
    lines = [f"{key} = {value}\n" for key, value in header.items() if value is not None]
    return "".join(lines).encode() + f"ElementDataFile = {name}\n".encode() + data


missing, no_header = "its data are missing, damaged, or not complete", "it is not a MetaImage file"
deflated = zlib.compress(values.tobytes())
damaged = bytearray(deflated)
damaged[len(damaged) // 2] ^= 255
packed = {"CompressedData": True, "CompressedDataSize": len(deflated)}
text = " ".join(map(str, values.ravel())).encode() + b"\n"
big = values.astype(">i2").tobytes()
for i in (0, 1, 3, 4):
    with open(os.path.join(folder, f"part{i}.raw"), "wb") as file:
        file.write(values[i].tobytes())
for name, words, data, *arguments in (
        ("none.mha", "no voxels", make_meta(DimSize="7 0 5")),
        ("negative.mha", "impossible size", make_meta(DimSize="7 -6 5")),
        ("huge.mha", "more memory than is available", make_meta(DimSize="100000 100000 100000")),
        ("type.mha", "of the type", make_meta(ElementType="MET_FOO")),
        ("no-type.mha", no_header, make_meta(ElementType=None)),
        ("no-size.mha", no_header, make_meta(DimSize=None)),
        ("nan.mha", no_header, make_meta(ElementSpacing="1 nan 3")),
        ("zero.mha", "the voxel spacing 0 on axis 1", make_meta(ElementSpacing="1 0 3")),
        ("direction.mha", "the voxel spacing 0 on axis 0", make_meta(TransformMatrix="0 0 0 0 1 0 0 0 1")),
        ("same.mha", "sheared by 90", make_meta(TransformMatrix="1 0 0 1 0 0 0 0 1")),
        ("shear.mha", "sheared by 0.0687", make_meta(TransformMatrix="1 0 0 0.0012 1 0 0 0 1")),
        ("five.mha", "it has 5 axes",
         make_meta(bytes(64), NDims=5, DimSize="2 2 2 2 2", ElementSpacing="1 1 1 1 1")),
        ("slice.mha", "7 x 30 x 1 voxels", make_meta(DimSize="7 30 1")),
        ("plane.mha", "7 x 30 x 1 voxels", make_meta(NDims=2, DimSize="7 30", ElementSpacing="1 1")),
        ("one.mha", "one frame, number 0", make_meta(), "--frame", "1"),
        ("half.mha", missing, make_meta(values.tobytes()[:100])),
        ("last.mha", missing, make_meta(values.tobytes()[:-1])),
        ("no-data.mha", missing, make_meta(b"")),
        ("big.mha", missing, make_meta(big[:-1], BinaryDataByteOrderMSB=True)),
        ("zip-half.mha", missing, make_meta(deflated[:len(deflated) // 2], **packed)),
        ("zip-last.mha", missing, make_meta(deflated[:-5], **packed)),
        ("zip-wrong.mha", missing, make_meta(bytes(damaged), **packed)),
        ("text-short.mha", missing, make_meta(text[:-20], BinaryData=False)),
        ("text-wrong.mha", missing, make_meta(b"x " * 210, BinaryData=False)),
        ("missing.mhd", missing, make_meta(b"", ElementDataFile="nowhere.raw")),
        ("list.mhd", missing, make_meta(b"", ElementDataFile="LIST\n" + "".join(
            f"part{i}.raw\n" for i in range(5)))),
        ("pattern.mhd", missing, make_meta(b"", ElementDataFile="part%d.raw 0 4 1")),
        ("text.mha", no_header, b"hello"), ("empty.mha", no_header, b"")):
    add(name, words, data, *arguments)


# NRRD files with changed fields in the header.
def make_nrrd(data=values.tobytes(), **fields):
    header = {"type": "short", "dimension": 3, "space": "left-posterior-superior", "sizes": "7 6 5",
              "space directions": "(1,0,0) (0,2,0) (0,0,3)", "kinds": "domain domain domain",
              "endian": "little", "encoding": "raw", "space origin": "(4,5,6)"}
    header.update((key.replace("_", " "), value) for key, value in fields.items())
    lines = [f"{key}: {value}\n" for key, value in header.items() if value is not None]
    return b"NRRD0004\n" + "".join(lines).encode() + b"\n" + data


gzipped = gzip.compress(values.tobytes())
damaged = bytearray(gzipped)
damaged[-6] ^= 255
four = {"dimension": 4, "sizes": "3 3 3 3", "space_directions": "none (1,0,0) (0,1,0) (0,0,1)"}
for name, words, data, *arguments in (
        ("none.nrrd", "its header is wrong", make_nrrd(sizes="7 0 5")),
        ("type.nrrd", '"foo"', make_nrrd(type="foo")),
        ("block.nrrd", "type", make_nrrd(bytes(840), type="block", block_size=4)),
        ("no-sizes.nrrd", "sizes", make_nrrd(sizes=None)),
        ("encoding.nrrd", '"foo"', make_nrrd(encoding="foo")),
        ("bzip2.nrrd", "bzip2", make_nrrd(encoding="bzip2")),
        ("nan.nrrd", "its header is wrong", make_nrrd(space_directions="(1,0,0) (0,nan,0) (0,0,3)")),
        ("zero.nrrd", "the voxel spacing 0 on axis 1", make_nrrd(space_directions="(1,0,0) (0,0,0) (0,0,3)")),
        ("shear.nrrd", "sheared by 0.0687", make_nrrd(space_directions="(1,0,0) (0.0024,2,0) (0,0,3)")),
        ("five.nrrd", "it has 5 axes", make_nrrd(bytes(64), dimension=5, sizes="2 2 2 2 2", space=None,
                                                 space_directions=None, space_origin=None, kinds=None)),
        ("kind.nrrd", "neither a direction nor a kind", make_nrrd(bytes(162), kinds=None, **four)),
        ("complex.nrrd", "complex", make_nrrd(bytes(216), type="float",
                                              kinds="complex domain domain domain",
                                              **{**four, "sizes": "2 3 3 3"})),
        ("time.nrrd", "--frame 0 to 2", make_nrrd(bytes(162), kinds="list domain domain domain", **four)),
        ("one.nrrd", "one frame, number 0", make_nrrd(), "--frame", "1"),
        ("slice.nrrd", "7 x 30 x 1 voxels", make_nrrd(sizes="7 30 1")),
        ("half.nrrd", missing, make_nrrd(values.tobytes()[:100])),
        ("last.nrrd", missing, make_nrrd(values.tobytes()[:-1])),
        ("zip-half.nrrd", missing, make_nrrd(gzipped[:len(gzipped) // 2], encoding="gzip")),
        ("zip-last.nrrd", missing, make_nrrd(gzipped[:-9], encoding="gzip")),
        ("zip-wrong.nrrd", missing, make_nrrd(bytes(damaged), encoding="gzip")),
        ("ascii-short.nrrd", missing, make_nrrd(text[:-20], encoding="ascii")),
        ("ascii-wrong.nrrd", missing, make_nrrd(b"x y", encoding="ascii")),
        ("missing.nhdr", "nowhere.raw", make_nrrd(b"", data_file="nowhere.raw")),
        ("text.nrrd", "its header is wrong", b"hello"), ("empty.nrrd", "its header is wrong", b"")):
    add(name, words, data, *arguments)

add("volume.mgz", "mri_convert", b"")
add("text.vti", "it is not an image file of VTK", b"hello")
wrong.append(["nowhere.mha", "there is no such file or folder"])
with open(os.path.join(folder, "wrong.json"), "w", encoding="utf-8") as file:
    json.dump(wrong, file)
