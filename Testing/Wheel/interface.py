# SPDX-License-Identifier: BSD-3-Clause
"""Deforms a small volume through the C interface of the wheel."""

import ctypes
from ctypes import POINTER, c_double, c_int32, c_int64, c_size_t, c_void_p

import numpy

from deformvolume import _driver, _native

INT16, FLOAT64 = 2, 9


class Grid(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("extent", c_int32 * 6),
        ("origin", c_double * 3),
        ("spacing", c_double * 3),
        ("direction", c_double * 9),
    ]


class Array(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("data", c_void_p),
        ("type", c_int32),
        ("components", c_int32),
        ("categorical", c_int32),
        ("reserved", c_int32),
        ("background", c_double),
    ]


class Mesh(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("number_of_points", c_int64),
        ("points", c_void_p),
        ("point_type", c_int32),
        ("reserved", c_int32),
        ("number_of_cells", c_int64),
        ("connectivity", c_void_p),
        ("types", c_void_p),
        ("offsets", c_void_p),
    ]


class Output(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("bounds_mode", c_int32),
        ("padding", c_int32),
        ("custom_bounds", c_double * 6),
        ("spacing", c_double * 3),
    ]


class Request(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("extent", c_int32 * 6),
        ("use_extent", c_int32),
        ("interpolation", c_int32),
        ("number_of_outputs", c_int32),
        ("incremental", c_int32),
        ("outputs", POINTER(c_void_p)),
        ("coverage", c_void_p),
        ("rest_positions", c_void_p),
        ("jacobian", c_void_p),
        ("fold_count", c_void_p),
        ("extra_background", c_double),
        ("progress", c_void_p),
        ("user", c_void_p),
    ]


class Report(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("counts", c_int64 * 5),
        ("changed_extent", c_int32 * 6),
        ("device", ctypes.c_char_p),
        ("warnings", ctypes.c_char_p),
    ]


def _make(kind, **members):
    made = kind(struct_size=ctypes.sizeof(kind))
    for name, value in members.items():
        if isinstance(value, (list, tuple)):
            for index, number in enumerate(value):
                getattr(made, name)[index] = number
        else:
            setattr(made, name, value)
    return made


def deform(size=16, shift=(0.0, 0.0, 0.0), repeat=1, clock=None):
    """A volume of size^3 random int16 of which a cube of tetrahedra, all of the volume, moves by shift, in
    voxels: the volume, the deformed volume on the same grid (background -1), and its coverage."""
    # Without the types of arguments that the package has declared for it.
    library = ctypes.CDLL(_native.library._name)
    _driver.prepare()
    volume = numpy.random.RandomState(1).randint(0, 1000, (size, size, size)).astype(numpy.int16)
    output = numpy.zeros_like(volume)
    coverage = numpy.zeros(volume.shape, numpy.int8)
    last = size - 1.0
    points = numpy.array(
        [[last * (i & 1), last * (i >> 1 & 1), last * (i >> 2)] for i in range(8)], numpy.float64
    )
    cells = numpy.array(
        [[0, 1, 2, 4], [3, 2, 1, 7], [5, 4, 7, 1], [6, 7, 4, 2], [1, 2, 4, 7]], numpy.int64
    )
    displacements = numpy.tile(numpy.array(shift, numpy.float64), (8, 1))
    grid = _make(
        Grid,
        extent=[0, size - 1] * 3,
        spacing=[1.0] * 3,
        direction=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    )
    array = _make(Array, data=volume.ctypes.data, type=INT16, components=1, background=-1.0)
    mesh = _make(
        Mesh,
        number_of_points=8,
        points=points.ctypes.data,
        point_type=FLOAT64,
        number_of_cells=5,
        connectivity=cells.ctypes.data,
    )
    outputs = (c_void_p * 1)(output.ctypes.data)
    request = _make(Request, number_of_outputs=1, outputs=outputs, coverage=coverage.ctypes.data)
    report = _make(Report)
    deformer = c_void_p()
    check = _native.check
    check(library.dv_create(ctypes.byref(deformer)))
    try:
        check(library.dv_set_volume(deformer, ctypes.byref(grid)))
        check(library.dv_set_arrays(deformer, c_int32(1), ctypes.byref(array)))
        check(library.dv_set_mesh(deformer, ctypes.byref(mesh)))
        check(
            library.dv_set_displacements(
                deformer, c_int32(FLOAT64), c_int64(8), c_void_p(displacements.ctypes.data)
            )
        )
        volume_bounds = _make(Output, bounds_mode=1)
        check(library.dv_set_output(deformer, ctypes.byref(volume_bounds)))
        for _ in range(repeat):
            check(library.dv_deform(deformer, ctypes.byref(request), ctypes.byref(report)))
            if clock:
                clock()
    finally:
        library.dv_destroy(deformer)
    return volume, output, coverage
