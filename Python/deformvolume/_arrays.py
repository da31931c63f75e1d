# SPDX-License-Identifier: BSD-3-Clause
"""Checks numpy arrays, and converts them to the form that the library reads."""

import weakref
from typing import Sequence, Tuple

import numpy

from . import _structs


def native(array, what: str) -> numpy.ndarray:
    """Returns an array of a type that the library supports, or of bool. Other byte orders are converted."""
    if isinstance(array, numpy.ma.MaskedArray):
        raise TypeError(
            f"{what} is a masked array. Give array.filled(value). Voxels of a volume can be left out with "
            "Deformer.set_blanked(), and points of a field with Field(undefined=getmaskarray(array).any(axis=3))."
        )
    if hasattr(array, "dataobj"):  # an image of nibabel
        raise TypeError(f"{what} is a {type(array).__name__}. Give its values, numpy.asarray(image.dataobj).")
    if hasattr(array, "GetSpacing"):  # an image of ITK, SimpleITK or VTK
        raise TypeError(
            f"{what} is a {type(array).__name__}. Give an array with the axes x, y, z: itk.array_from_image() returns "
            "the axes z, y, x. For images of SimpleITK and VTK, there are deformvolume.sitk and deformvolume.vtk."
        )
    given = type(array).__name__
    array = numpy.asarray(array)
    if not array.dtype.isnative:
        array = array.astype(array.dtype.newbyteorder("="))
    if array.dtype != numpy.bool_ and array.dtype.name not in _structs.TYPES:
        if array.ndim == 0:
            raise TypeError(f"{what} is a {given}. Give an array.")
        raise TypeError(f"{what} has the type {array.dtype}. Give integers of 8 to 64 bits, float32, float64 or bool.")
    return array


def image(array, what: str, components: Tuple[int, ...] = ()) -> numpy.ndarray:
    """Returns the same values in the order that the library reads: x varies fastest, and the components of a voxel
    are contiguous. The axes of the result are z, y, x and, if there is one, the axis of components.

    An array in Fortran order, such as nibabel's, and the transposed view of an array with the axes z, y, x are not
    copied; other arrays are.

    components: the allowed numbers of components; empty: any number, or no axis of components.
    """
    array = native(array, what)
    if array.ndim not in ((4,) if components else (3, 4)):
        axes = "x, y, z and components" if components else "x, y, z and, optionally, components"
        hint = ""
        if components and array.ndim == 5 and array.shape[3] == 1:  # NIfTI with the intent of vectors
            hint = " Remove axis 3 with array[:, :, :, 0], and note the directions of the vectors, see Field."
        raise ValueError(f"{what} has the shape {array.shape}. Its axes must be {axes}.{hint}")
    if components and array.shape[3] not in components:
        wanted = " or ".join(map(str, components))
        raise ValueError(f"{what} has {array.shape[3]} components. It must have {wanted}.")
    if 0 in array.shape:
        raise ValueError(f"{what} is empty: its shape is {array.shape}.")
    return numpy.ascontiguousarray(array.transpose((2, 1, 0, 3)[: array.ndim]))


def pin(array: numpy.ndarray) -> weakref.ref:
    """Returns a weak reference to the array that owns the memory. While the reference exists, numpy does not reallocate
    that memory: even resize(refcheck=False), which ignores views, fails."""
    while isinstance(array.base, numpy.ndarray):
        array = array.base
    return weakref.ref(array)


def from_image(array: numpy.ndarray) -> numpy.ndarray:
    """The inverse of image(): returns a view with the axes x, y, z and the axis of components, if there is one."""
    return array.transpose((2, 1, 0, 3)[: array.ndim])


def vectors(array, number, what: str) -> numpy.ndarray:
    """Returns contiguous rows of three float32 or float64. number: the required number of rows; None: any."""
    array = native(array, what)
    if array.ndim != 2 or array.shape[1] != 3 or (number is not None and array.shape[0] != number):
        wanted = f"({'n' if number is None else number}, 3)"
        raise ValueError(f"{what} has the shape {array.shape}. It must have the shape {wanted}.")
    if array.dtype not in (numpy.float32, numpy.float64):
        array = array.astype(numpy.float64)
    return numpy.ascontiguousarray(array)


def affine(matrix, what: str) -> numpy.ndarray:
    """Returns a checked 4 x 4 matrix from indices of voxels to world coordinates."""
    try:
        matrix = numpy.asarray(matrix, dtype=numpy.float64)
    except (TypeError, ValueError) as error:
        raise TypeError(f"The type of {what} is {type(matrix).__name__}. It must be a 4 x 4 matrix.") from error
    if matrix.shape != (4, 4):
        raise ValueError(f"The shape of {what} is {matrix.shape}. It must be a 4 x 4 matrix.")
    if not numpy.array_equal(matrix[3], (0, 0, 0, 1)):
        raise ValueError(f"The last row of {what} is {matrix[3].tolist()}. It must be [0, 0, 0, 1].")
    return matrix


def split_affine(matrix: numpy.ndarray) -> Tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:
    """Returns the origin, spacing and direction (its columns are the axes) of an affine matrix."""
    axes = matrix[:3, :3]
    spacing = numpy.sqrt((axes * axes).sum(axis=0))
    # The library raises an error for columns of length 0.
    direction = axes / numpy.where(spacing > 0, spacing, 1.0)
    return matrix[:3, 3].copy(), spacing, direction


def join_affine(origin: Sequence[float], spacing: Sequence[float], direction) -> numpy.ndarray:
    """Returns the affine matrix of an origin, a spacing and a direction."""
    matrix = numpy.eye(4)
    matrix[:3, :3] = numpy.asarray(direction, dtype=numpy.float64).reshape(3, 3) * numpy.asarray(spacing)
    matrix[:3, 3] = origin
    return matrix
