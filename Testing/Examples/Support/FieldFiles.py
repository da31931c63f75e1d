# SPDX-License-Identifier: BSD-3-Clause
"""Writes displacement fields in the formats of registration programs, byte by byte. Vectors are arrays [z, y, x,
component]. Matrices have the shape 3 x 4 and map the index of a voxel to the world of the file."""
import gzip
import os
import struct
import zlib

import numpy

RAS, LPS = "right-anterior-superior", "left-posterior-superior"
flip = numpy.diag([-1.0, -1.0, 1.0])
types = {"float32": (16, "float", "MET_FLOAT"), "float64": (64, "double", "MET_DOUBLE"),
         "int16": (4, "short", "MET_SHORT")}


def write_nifti(path, vectors, matrix, intent=1007, name="", shape=None, order="<", slope=(0.0, 0.0),
                unit=2):
    """matrix: index to RAS, written as the s-form; shape: None for (x, y, z, 1, 3); unit: the code of the unit of
    length, 2 for mm."""
    kind = vectors.dtype.name
    size = vectors.shape[2::-1]
    shape = shape or (*size, 1, vectors.shape[3])
    spacing = numpy.linalg.norm(matrix[:, :3], axis=0)
    header = bytearray(348)

    def put(offset, code, *values):
        struct.pack_into(order + code, header, offset, *values)

    put(0, "i", 348)
    put(40, "8h", len(shape), *shape, *(1,) * (7 - len(shape)))
    put(68, "h", intent)
    put(70, "hh", types[kind][0], vectors.dtype.itemsize * 8)
    put(76, "8f", 1.0, *spacing, 0.0, 0.0, 0.0, 0.0)
    put(108, "fff", 352.0, *slope)
    put(123, "b", unit)
    put(252, "hh", 0, 1)
    put(280, "12f", *matrix.ravel())
    put(328, "16s", name.encode())
    put(344, "4s", b"n+1\0")
    # The file has all x components, then all y components, then all z components.
    planes = numpy.moveaxis(vectors, 3, 0).astype(vectors.dtype.newbyteorder(order))
    data = bytes(header) + b"\0" * 4 + planes.tobytes()
    with open(path, "wb") as file:
        file.write(gzip.compress(data) if path.endswith(".gz") else data)


def write_meta(path, vectors, matrix, order="<", compressed=False, extra=""):
    """matrix: index to LPS; extra: further lines of the header. A .mha file contains the data, a .mhd file
    refers to a second file with the data."""
    spacing = numpy.linalg.norm(matrix[:, :3], axis=0)
    directions = (matrix[:, :3] / spacing).T.ravel()
    data = vectors.astype(vectors.dtype.newbyteorder(order)).tobytes()
    data = zlib.compress(data) if compressed else data
    name = "LOCAL" if path.endswith(".mha") else os.path.basename(path) + ".data"

    def words(numbers):
        return " ".join(repr(float(number)) for number in numbers)

    header = (f"ObjectType = Image\nNDims = 3\nBinaryData = True\n"
              f"BinaryDataByteOrderMSB = {order == '>'}\nCompressedData = {compressed}\n"
              + (f"CompressedDataSize = {len(data)}\n" if compressed else "")
              + f"TransformMatrix = {words(directions)}\nOffset = {words(matrix[:, 3])}\n"
              f"ElementSpacing = {words(spacing)}\n"
              f"DimSize = {' '.join(str(n) for n in vectors.shape[2::-1])}\n"
              f"ElementNumberOfChannels = {vectors.shape[3]}\n"
              f"{extra}ElementType = {types[vectors.dtype.name][2]}\nElementDataFile = {name}\n").encode()
    with open(path, "wb") as file:
        file.write(header + (data if name == "LOCAL" else b""))
    if name != "LOCAL":
        with open(path + ".data", "wb") as file:
            file.write(data)


def write_nrrd(path, vectors, matrix, order="<", encoding="raw", axis=0, space=LPS, frame=None,
               extra="", skip=0):
    """axis: the axis of the components. frame: the measurement frame, a matrix that maps components to the space. A
    .nhdr file refers to a second file with the data. extra: additional lines of the header. skip: number of bytes
    before the data."""
    directions = ["(" + ",".join(repr(float(n)) for n in matrix[:, i]) + ")" for i in range(3)]
    sizes, kinds = [str(n) for n in vectors.shape[2::-1]], ["domain"] * 3
    for words, word in ((directions, "none"), (sizes, str(vectors.shape[3])), (kinds, "vector")):
        words.insert(axis, word)
    # The first axis of the file is the last one of numpy.
    data = numpy.moveaxis(vectors, 3, 3 - axis).astype(vectors.dtype.newbyteorder(order)).tobytes()
    data = gzip.compress(data) if encoding == "gzip" else data
    data = bytes(skip) + data
    extra += f"byte skip: {skip}\n" if skip else ""
    name = os.path.basename(path) + ".data"
    header = (f"NRRD0005\n# a comment\ntype: {types[vectors.dtype.name][1]}\ndimension: 4\n"
              f"space: {space}\nsizes: {' '.join(sizes)}\nspace directions: {' '.join(directions)}\n"
              f"kinds: {' '.join(kinds)}\nendian: {'big' if order == '>' else 'little'}\n"
              f"encoding: {encoding}\n"
              f"space origin: ({','.join(repr(float(n)) for n in matrix[:, 3])})\n" + extra)
    if frame is not None:
        columns = ("(" + ",".join(repr(float(n)) for n in frame[:, i]) + ")" for i in range(3))
        header += f"measurement frame: {' '.join(columns)}\n"
    if path.endswith(".nhdr"):
        header += f"data file: {name}\n"
        with open(os.path.join(os.path.dirname(path), name), "wb") as file:
            file.write(data)
        data = b""
    with open(path, "wb") as file:
        file.write(header.encode() + b"\n" + data)
