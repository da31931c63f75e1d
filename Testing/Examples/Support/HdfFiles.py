# SPDX-License-Identifier: BSD-3-Clause
"""Writes meshes as VTKHDF files, byte by byte, because VTK has no writer for this format before VTK 9.4. The bytes
follow the specification of HDF5: superblock 0, object headers 1, contiguous data."""
import struct

import numpy

UNDEFINED = b"\xff" * 8


def pad(data):
    return data + b"\0" * (-len(data) % 8)


def describe_type(kind):
    """Returns the datatype message for int64, uint8, float32, float64, or a string of fixed length."""
    if kind.kind == "S":
        return struct.pack("<B3BI", 0x13, 0, 0, 0, kind.itemsize)
    bits = 8 * kind.itemsize
    if kind.kind == "f":
        exponent, bias = (11, 1023) if bits == 64 else (8, 127)
        return struct.pack("<B3BIHH4BI", 0x11, 0x20, bits - 1, 0, kind.itemsize, 0, bits,
                           bits - 1 - exponent, exponent, 0, bits - 1 - exponent, bias)
    return struct.pack("<B3BIHH", 0x10, 8 if kind.kind == "i" else 0, 0, 0, kind.itemsize, 0, bits)


def describe_space(shape):
    return struct.pack("<4BI", 1, len(shape), 0, 0, 0) + struct.pack(f"<{len(shape)}Q", *shape)


class Hdf:
    """A file of groups and datasets. Members of a group have to be added before the group."""

    def __init__(self):
        self.bytes = bytearray(96)

    def add(self, data):
        address = len(self.bytes)
        self.bytes += pad(bytes(data))
        return address

    def add_object(self, messages):
        body = b"".join(struct.pack("<HHB3x", kind, len(pad(data)), 0) + pad(data)
                        for kind, data in messages)
        return self.add(struct.pack("<BxHII4x", 1, len(messages), 1, len(body)) + body)

    def add_dataset(self, values):
        place = self.add(values.tobytes())
        layout = struct.pack("<BBQQ", 3, 1, place, values.nbytes)
        return self.add_object([(1, describe_space(values.shape)), (3, describe_type(values.dtype)),
                                (8, layout)])

    def add_group(self, members, attributes=()):
        messages = [(2, b"\0\0" + UNDEFINED + UNDEFINED), (10, b"\0\0")]
        for name, address in members.items():
            messages.append((6, struct.pack("<BBB", 1, 0, len(name)) + name.encode() +
                             struct.pack("<Q", address)))
        for name, values in dict(attributes).items():
            kind, space = describe_type(values.dtype), describe_space(values.shape)
            messages.append((12, struct.pack("<BxHHH", 1, len(name) + 1, len(kind), len(space)) +
                             pad(name.encode() + b"\0") + pad(kind) + pad(space) +
                             values.tobytes()))
        return self.add_object(messages)

    def write(self, path, root):
        head = b"\x89HDF\r\n\x1a\n" + struct.pack("<8BHHI", 0, 0, 0, 0, 0, 8, 8, 0, 4, 16, 0)
        head += struct.pack("<Q", 0) + UNDEFINED + struct.pack("<Q", len(self.bytes)) + UNDEFINED
        head += struct.pack("<QQII16x", 0, root, 0, 0)
        self.bytes[:96] = head
        with open(path, "wb") as file:
            file.write(self.bytes)


def write_vtkhdf(path, points, cells, cell_types, arrays, version=(1, 0), kind=b"UnstructuredGrid",
                 without=(), steps=None):
    """cells: lists of point ids; arrays: point arrays by name; without: names of datasets that are left out;
    steps: times of a series, whose data the file does not contain."""
    file = Hdf()
    offsets = numpy.cumsum([0] + [len(cell) for cell in cells]).astype(numpy.int64)
    ids = numpy.concatenate(cells).astype(numpy.int64)

    def count(number):
        return file.add_dataset(numpy.array([number], numpy.int64))

    members = {
        "NumberOfPoints": count(len(points)), "NumberOfCells": count(len(cells)),
        "NumberOfConnectivityIds": count(len(ids)), "Points": file.add_dataset(points),
        "Offsets": file.add_dataset(offsets), "Connectivity": file.add_dataset(ids),
        "Types": file.add_dataset(numpy.array(cell_types, numpy.uint8)),
        "PointData": file.add_group({name: file.add_dataset(values)
                                     for name, values in arrays.items()})}
    for name in without:
        del members[name]
    if steps:
        values = file.add_dataset(numpy.array(steps, float))
        members["Steps"] = file.add_group({"Values": values},
                                          {"NSteps": numpy.array(len(steps), numpy.int64)})
    group = file.add_group(members, {"Version": numpy.array(version, numpy.int64),
                                     "Type": numpy.array(kind)})
    file.write(path, file.add_group({"VTKHDF": group}))
