# SPDX-License-Identifier: BSD-3-Clause
"""The structures and functions of deformvolume.h that deform volumes."""

import ctypes
from ctypes import POINTER, c_char_p, c_double, c_float, c_int8, c_int32, c_int64, c_size_t, c_uint8, c_uint32, c_void_p

from . import _native

OUTSIDE = {"discard": 0, "extrapolate": 1, "keep": 2}
BOUNDS = {"deformed": 0, "volume": 1, "custom": 2}
INTERPOLATION = {"linear": 0, "cubic": 1, "nearest": 2}
TYPES = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64")
PROGRESS = ctypes.CFUNCTYPE(c_int32, c_double, c_void_p)


class _Structure(ctypes.Structure):
    def __init__(self, **values):
        super().__init__(struct_size=ctypes.sizeof(type(self)), **values)


class Grid(_Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("extent", c_int32 * 6),
        ("origin", c_double * 3),
        ("spacing", c_double * 3),
        ("direction", c_double * 9),
    ]


class Array(_Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("data", c_void_p),
        ("type", c_int32),
        ("components", c_int32),
        ("categorical", c_int32),
        ("density", c_int32),
        ("background", c_double),
    ]


class Mesh(_Structure):
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
        ("degrees", c_void_p),
        ("faces", c_void_p),
        ("number_of_face_values", c_int64),
    ]


class Field(_Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("grid", POINTER(Grid)),
        ("vectors", c_void_p),
        ("type", c_int32),
        ("inverse", c_int32),
        ("undefined", c_void_p),
    ]


class Output(_Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("bounds_mode", c_int32),
        ("padding", c_int32),
        ("custom_bounds", c_double * 6),
        ("spacing", c_double * 3),
    ]


class Request(_Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("extent", c_int32 * 6),
        ("use_extent", c_int32),
        ("interpolation", c_int32),
        ("number_of_outputs", c_int32),
        ("incremental", c_int32),
        ("outputs", POINTER(c_void_p)),
        ("coverage", POINTER(c_int8)),
        ("rest_positions", POINTER(c_float)),
        ("jacobian", POINTER(c_float)),
        ("fold_count", POINTER(c_uint32)),
        ("extra_background", c_double),
        ("progress", PROGRESS),
        ("user", c_void_p),
    ]


class Report(_Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("number_of_covered_voxels", c_int64),
        ("number_of_inverted_tetrahedra", c_int64),
        ("number_of_flat_tetrahedra", c_int64),
        ("number_of_overstretched_cells", c_int64),
        ("number_of_hidden_samples", c_int64),
        ("changed_extent", c_int32 * 6),
        ("device", c_char_p),
        ("warnings", c_char_p),
    ]

    def counts(self):
        """Returns the numbers of the report as a dictionary."""
        return {name: getattr(self, name) for name, _ in self._fields_ if name.startswith("number_of_")}


class PointsRequest(_Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("number_of_points", c_int64),
        ("points", c_void_p),
        ("inverse", c_int32),
        ("were_floats", c_int32),
        ("moved", c_void_p),
        ("valid", c_void_p),
        ("progress", PROGRESS),
        ("user", c_void_p),
    ]


class PointsReport(_Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("number_of_outside_points", c_int64),
        ("warnings", c_char_p),
    ]


_status, _deformer = c_int32, c_void_p
_native.declare(
    {
        "dv_create": (_status, [POINTER(_deformer)]),
        "dv_destroy": (None, [_deformer]),
        "dv_set_device": (_status, [_deformer, c_char_p]),
        "dv_set_volume": (_status, [_deformer, POINTER(Grid)]),
        "dv_set_arrays": (_status, [_deformer, c_int32, POINTER(Array)]),
        "dv_set_blanked": (_status, [_deformer, c_void_p]),
        "dv_set_active_tetrahedra": (_status, [_deformer, c_void_p]),
        "dv_set_boundary_distances": (_status, [_deformer, c_void_p]),
        "dv_set_smooth_cut": (_status, [_deformer, c_void_p, c_void_p]),
        "dv_set_mesh": (_status, [_deformer, POINTER(Mesh)]),
        "dv_set_displacements": (_status, [_deformer, c_int32, c_int64, c_void_p]),
        "dv_set_field": (_status, [_deformer, POINTER(Field)]),
        "dv_set_outside": (_status, [_deformer, c_int32, c_double]),
        "dv_set_reference": (_status, [_deformer, POINTER(Grid)]),
        "dv_set_output": (_status, [_deformer, POINTER(Output)]),
        "dv_output_grid": (_status, [_deformer, POINTER(Grid)]),
        "dv_deform": (_status, [_deformer, POINTER(Request), POINTER(Report)]),
        "dv_deform_points": (_status, [_deformer, POINTER(PointsRequest), POINTER(PointsReport)]),
        "dv_release_memory": (_status, [_deformer]),
    }
)


def type_of(array) -> int:
    """Returns the number of an array's element type (DV_INT8 and so on); that of uint8 for bool."""
    return TYPES.index("uint8" if array.dtype.kind == "b" else array.dtype.name)


def address(array):
    """Returns the address of the elements of a numpy array."""
    return array.ctypes.data_as(c_void_p)
