# SPDX-License-Identifier: BSD-3-Clause
"""The class Deformer, which keeps a volume on a device, and the function deform()."""

import atexit
import contextlib
import ctypes
import math
import operator
import os
import signal
import sys
import threading
import warnings as python_warnings
import weakref
from dataclasses import dataclass, field
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy

from . import _arrays, _driver, _native, _structs


_POLYHEDRON = 42  # the type of cells in VTK


class DeformationWarning(UserWarning):
    """A warning that a result is incomplete, or that a part of the input had no effect."""


class Grid(NamedTuple):
    """A grid of voxels, such as that of an image."""

    shape: Tuple[int, int, int]
    """number of voxels on x, y and z"""
    affine: numpy.ndarray
    """4 x 4 matrix from the index (i, j, k, 1) of a voxel to its world coordinates"""


@dataclass(eq=False)  # "==" of arrays is not True or False
class Mesh:
    """A deformation mesh: points at rest, cells, and displacements of the points.

    Attributes:
        points: shape (n, 3), world coordinates at rest; float32 or float64, other types become float64.
        cells: tetrahedra, shape (m, 4), indices of points; or a tuple (types, cells): VTK's cell types, such as
            hexahedra (12) and quadratic tetrahedra (24), and a list with the point indices of each cell. Polyhedra (42)
            cannot be given, because they need faces.
        displacements: shape (n, 3), in world units; None: set later by Deformer.set_displacements().
    """

    points: numpy.ndarray
    cells: object
    displacements: Optional[numpy.ndarray] = None


@dataclass(eq=False)
class Field:
    """A displacement field: a vector at each point of its grid, with linear interpolation between the points.

    Attributes:
        vectors: shape (nx, ny, nz, 3), in world units; float32 or float64. They have the axes of the world. Files of
            ITK and ANTs have the world LPS and nibabel has RAS: multiply vectors of such files by (-1, -1, 1).
        affine: 4 x 4 matrix from an index of the field to world coordinates.
        inverse: False: vectors lead from rest positions to deformed positions, as computed by simulations. True:
            vectors lead from positions of the output to rest positions, as computed by registrations ("resampling
            field").
        undefined: shape (nx, ny, nz): True at points without a displacement, for example where digital volume
            correlation found no match. Their vectors are not read, and may be NaN. Voxels whose interpolation would
            use such a point are not covered. None: all vectors are defined.

    A Deformer does not notice changes of these arrays: call set_deformation() again.
    """

    vectors: numpy.ndarray
    affine: numpy.ndarray
    inverse: bool = False
    undefined: Optional[numpy.ndarray] = None


@dataclass(eq=False, repr=False)
class Deformed:
    """The result of deform().

    Attributes:
        arrays: the deformed arrays of the volume, of the same types, or of floats for densities. Axes: x, y, z and, if
            there is one, the axis of components; in Fortran order.
        affine: 4 x 4 matrix from an index of the output to world coordinates.
        coverage: bool, axes x, y, z: whether the deformed volume covers the voxel.
        rest_positions: float32, shape (nx, ny, nz, 3): rest position of the tissue at the voxel, in world coordinates.
            None unless requested.
        jacobian: float32: Jacobian determinant of the deformation (deformed by undeformed volume). None unless
            requested.
        fold_count: uint32: number of tetrahedra of the sampling mesh that cover the voxel; more than 1 in folds. With
            an inverse field it is 1 at each covered voxel and does not show folds: the Jacobian is negative there.
            None unless requested.
        counts: "number_of_covered_voxels"; "number_of_inverted_tetrahedra": more than 0 if the deformation folds;
            "number_of_flat_tetrahedra": cells of the mesh without volume; "number_of_overstretched_cells": cells of
            the volume that are stretched over more than 4,000 voxels and left out in part; "number_of_hidden_samples":
            samples that other parts of a folded volume hide.
        device: the name of the device.
    """

    arrays: List[numpy.ndarray]
    affine: numpy.ndarray
    coverage: numpy.ndarray
    rest_positions: Optional[numpy.ndarray] = None
    jacobian: Optional[numpy.ndarray] = None
    fold_count: Optional[numpy.ndarray] = None
    counts: Dict[str, int] = field(default_factory=dict)
    device: str = ""

    @property
    def array(self) -> numpy.ndarray:
        """The first array."""
        return self.arrays[0]

    def __repr__(self):
        arrays = ", ".join(f"{array.dtype} {array.shape}" for array in self.arrays)
        return f"<Deformed: {arrays}; counts={self.counts}, device={self.device!r}>"


class DeformedPoints(NamedTuple):
    """The result of deform_points()."""

    points: numpy.ndarray
    """float64, shape (n, 3): the new positions, in world coordinates. Points outside the deformation do not move."""
    valid: numpy.ndarray
    """bool, shape (n,): False for points outside the deformation, see Deformer.set_outside()"""


def _flag(value, what: str) -> int:
    """Returns 0 or 1. Texts such as "False" are refused."""
    if not isinstance(value, (bool, int, numpy.bool_, numpy.integer)):
        raise TypeError(f"{what} is {value!r}. Give True or False.")
    return int(bool(value))


def _warn(text: str) -> None:
    """Warns about the line that has called this package, or VTK or pyvista, which call the filter DeformVolume."""
    level = 2
    caller = sys._getframe(1)  # pylint: disable=protected-access
    packages = (__name__.partition(".")[0], "vtkmodules", "pyvista")
    while caller is not None and str(caller.f_globals.get("__name__")).partition(".")[0] in packages:
        caller = caller.f_back
        level += 1
    python_warnings.warn(text, DeformationWarning, stacklevel=level)


def _is_in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()


class _Calls:
    """Counts the calls of deformers in other threads than the main thread. At exit the main thread waits until these
    calls have ended. Threads that still run are then blocked: OpenCL must not be used while its driver is shut down."""

    def __init__(self):
        self._reset()
        atexit.register(self._end)
        os.register_at_fork(after_in_child=self._reset)

    def _reset(self):
        # In a forked process, the calls of other threads do not end.
        self._condition = threading.Condition()
        self._running = 0
        self.has_ended = False
        self._of_thread = threading.local()

    def __enter__(self):
        if _is_in_main_thread():
            return
        depth = getattr(self._of_thread, "depth", 0)
        if depth == 0:
            with self._condition:
                while self.has_ended:
                    self._condition.wait()
                self._running += 1
        self._of_thread.depth = depth + 1

    def __exit__(self, *_):
        if _is_in_main_thread():
            return
        self._of_thread.depth -= 1
        if self._of_thread.depth == 0:
            with self._condition:
                self._running -= 1
                self._condition.notify_all()
                while self.has_ended:
                    self._condition.wait()

    def _end(self):
        with self._condition:
            self.has_ended = True
            # A progress callback may wait for the main thread.
            self._condition.wait_for(lambda: self._running == 0, timeout=10.0)


_calls = _Calls()


class _Interrupts:
    """Delays the handlers of signals, such as that of Ctrl-C, while the library runs: Python loses exceptions of
    handlers that run when the library calls Python. call() runs the handlers of signals that have come meanwhile."""

    def __init__(self):
        self._signals = []
        self._handlers = {}
        self._delays = False

    def _handle(self, number, frame):
        # A handler that raises an exception can end __enter__() and __exit__() early. This object then stays the
        # handler of some signals, and passes them on.
        if self._delays:
            self._signals.append((number, frame))
        else:
            self._handlers[number](number, frame)

    def __enter__(self):
        # Python runs handlers in the main thread only.
        if _is_in_main_thread():
            for number in signal.valid_signals():
                handler = signal.getsignal(number)
                other = getattr(handler, "__self__", None)
                if isinstance(other, _Interrupts) and not other._delays:
                    handler = other._handlers[number]
                if callable(handler):
                    self._handlers[number] = handler
                    signal.signal(number, self._handle)
        self._delays = True
        return self

    def __exit__(self, *_):
        self._delays = False
        for number, handler in self._handlers.items():
            # The progress callback may have installed another handler.
            if signal.getsignal(number) == self._handle:
                signal.signal(number, handler)

    def call(self):
        """Calls the handlers, which may raise exceptions: that of Ctrl-C raises KeyboardInterrupt."""
        while self._signals:
            number, frame = self._signals.pop(0)
            self._handlers[number](number, frame)


def _integer(value, what: str) -> int:
    """Returns an integer of 32 bits."""
    try:
        number = operator.index(value)
    except TypeError as error:
        raise TypeError(f"{what} is {value!r}. Give an integer.") from error
    if not -(2**31) <= number < 2**31:
        raise ValueError(f"{what} is {value}. Give a smaller number.")
    return number


def _number(value, what: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError) as error:
        raise TypeError(f"{what} is {value!r}. Give a number.") from error


def _choose(value: str, choices: Dict[str, int], what: str) -> int:
    if not isinstance(value, str) or value not in choices:
        raise ValueError(f'{what} is "{value}". Choose one of {", ".join(choices)}.')
    return choices[value]


def make_grid(extent, origin, spacing, direction) -> _structs.Grid:
    """Returns a grid of the library. direction: nine numbers, row by row."""
    return _structs.Grid(
        extent=(ctypes.c_int32 * 6)(*map(int, extent)),
        origin=(ctypes.c_double * 3)(*map(float, origin)),
        spacing=(ctypes.c_double * 3)(*map(float, spacing)),
        direction=(ctypes.c_double * 9)(*map(float, numpy.asarray(direction).reshape(9))),
    )


def _grid_of(shape: Sequence[int], matrix, what: str, first: Sequence[int] = (0, 0, 0)) -> _structs.Grid:
    origin, spacing, direction = _arrays.split_affine(_arrays.affine(matrix, what))
    extent = [end for axis in range(3) for end in (first[axis], first[axis] + shape[axis] - 1)]
    return make_grid(extent, origin, spacing, direction)


def _cells(cells):
    """Returns connectivity, types and offsets. Types and offsets are None for tetrahedra."""
    # Two tetrahedra may be a tuple, too; then the elements of the second one are numbers.
    is_pair = isinstance(cells, tuple) and len(cells) == 2
    if is_pair and not (len(cells[1]) == 4 and all(numpy.ndim(point) == 0 for point in cells[1])):
        types, lists = cells
        types = numpy.asarray(types)
        lengths = [len(points) for points in lists]
        if types.ndim != 1 or len(types) != len(lengths):
            raise ValueError(
                f"The array of cell types has the shape {types.shape}. It must have the shape ({len(lengths)},): one "
                "type for each cell."
            )
        if types.size > 0 and (types.dtype.kind not in "iu" or types.min() < 0 or types.max() > 255):
            raise ValueError("Cell types must be integers from 0 to 255, as VTK's cell types are.")
        types = numpy.ascontiguousarray(types, dtype=numpy.uint8)
        if (types == _POLYHEDRON).any():
            raise ValueError(
                f"Cell {numpy.argmax(types == _POLYHEDRON)} is a polyhedron (type {_POLYHEDRON}), whose faces a Mesh "
                "does not have. Split it into tetrahedra, or use deformvolume.vtk, which takes polyhedra of VTK."
            )
        offsets = numpy.concatenate(([0], numpy.cumsum(lengths, dtype=numpy.int64))).astype(numpy.int64)
        flat = [numpy.asarray(points) for points in lists]
        for number, points in enumerate(flat):
            if points.ndim != 1 or (points.size > 0 and points.dtype.kind not in "iu"):
                raise ValueError(f"Cell {number} is {points.tolist()}. Give a list of the indices of its points.")
        flat = [points.astype(numpy.int64) for points in flat]
        return numpy.concatenate(flat) if flat else numpy.zeros(0, numpy.int64), types, offsets
    cells = numpy.asarray(cells)
    if cells.ndim != 2 or cells.shape[1] != 4 or cells.dtype.kind not in "iu":
        raise ValueError(
            f"The array of cells has the shape {cells.shape} and the type {cells.dtype}. Give an integer array of the "
            "shape (m, 4) for tetrahedra, or a pair (types, cells) for other cells."
        )
    return numpy.ascontiguousarray(cells, dtype=numpy.int64), None, None


class Deformer:
    """Keeps a volume on a device for repeated deformations: only data that have changed are sent and computed again.

    Methods raise Error if the library reports an error, and ValueError or TypeError for arrays of a wrong shape or
    type. The deformer can still be used after an error. If two threads call a deformer, the second call waits for the
    first one to return. A deformer cannot be used in a process that was forked after the deformer was created. It
    frees its memory when it is destroyed, or at the end of a block "with Deformer() as deformer:".

    Args:
        device: a name of devices(), a part of a name, "cpu", "gpu", or "": the best device.

    >>> import numpy as np, deformvolume as dv
    >>> deformer = dv.Deformer()
    >>> deformer.set_volume(np.random.rand(20, 20, 20).astype("float32"), np.eye(4))
    >>> deformer.set_deformation(dv.Field(np.full((2, 2, 2, 3), 0.5), np.diag([20.0, 20.0, 20.0, 1.0])))
    >>> deformer.deform().array.shape
    (19, 19, 19)
    """

    def __init__(self, device: str = ""):
        _driver.prepare()
        self._lock = threading.RLock()
        self._process = os.getpid()
        self._borrowed: Dict[str, object] = {}
        self._arrays: List[numpy.ndarray] = []
        self._types: List[numpy.dtype] = []  # of the output
        self._shape: Optional[Tuple[int, int, int]] = None
        self._points = 0
        self._is_running = False
        if not isinstance(device, str):
            raise TypeError(f"The device is {device!r}. Give its name, a part of the name, or an empty string.")
        handle = ctypes.c_void_p()
        with _calls:
            _native.check(_native.library.dv_create(ctypes.byref(handle)))
        self._handle = handle
        self._finalizer = weakref.finalize(self, _destroy, handle.value, os.getpid())
        self._finalizer.atexit = False  # functions that are called at exit may still use this deformer
        self._call("dv_set_device", device.encode())

    @contextlib.contextmanager
    def _locked(self):
        """Locks the deformer. Raises an error if it must not be used now."""
        # Check this before the lock is taken: another thread may have held it when the process was forked.
        if os.getpid() != self._process:
            raise _native.Error(
                "This deformer was created before the process was forked, and OpenCL does not work after a fork. Start "
                'processes with the start method "spawn" or "forkserver" (multiprocessing.set_start_method), and '
                "create a deformer in each process."
            )
        with _calls, self._lock:
            if self._is_running:
                raise _native.Error(
                    "A call of this deformer is running. Its progress callback must not call the same deformer."
                )
            if not self._finalizer.alive:
                raise _native.Error("This deformer is closed. Create another one.")
            yield

    def _call(self, name: str, *arguments) -> None:
        with self._locked():
            _native.check(getattr(_native.library, name)(self._handle, *arguments))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        # Python loses exceptions that handlers of signals raise in finalizers.
        with _Interrupts() as interrupts:
            if self._finalizer.alive and os.getpid() == self._process:
                with self._locked():
                    self._finalizer()
        interrupts.call()

    def __reduce_ex__(self, _):
        raise TypeError("A Deformer cannot be copied or pickled. Create another one.")

    def set_volume(
        self,
        arrays: Union[numpy.ndarray, Sequence[numpy.ndarray]],
        affine,
        *,
        categorical: Union[bool, Sequence[bool]] = False,
        background: Union[float, Sequence[float]] = 0.0,
        density: Union[bool, Sequence[bool]] = False,
        first_index: Sequence[int] = (0, 0, 0),
    ) -> None:
        """Sets the volume at rest.

        Args:
            arrays: one or several arrays on the same grid. Axes: x, y, z and, optionally, an axis of components. Types:
                all integer types, float32, float64 and bool, whose result is also bool: interpolated as 0 and 1, and
                rounded. Arrays in Fortran order are not copied, and must not change until other arrays are set. For
                arrays with the axes z, y, x, such as SimpleITK's, give array.T; for arrays with the components on axis
                0, as in torch, numpy.moveaxis(array, 0, -1).
            affine: 4 x 4 matrix from the index (i, j, k, 1) of a voxel to world coordinates.
            categorical: whether arrays hold labels, which are not interpolated; one value for all arrays, or one for
                each.
            background: value of voxels outside the deformed volume; one value for all arrays, or one for each. In
                arrays of integers it is rounded, and limited to the range of the type.
            density: whether arrays hold amounts per unit of volume, such as a dose or an activity; one value for all
                arrays, or one for each. Their values are divided by the Jacobian determinant, so that their sum times
                the volume of a voxel is preserved. The result is float64 for float64, otherwise float32. Their
                background is 0, whatever `background` is; voxels at which the volume is inside out have it, too.
            first_index: for a block of a larger volume, the index in that volume of the block's first voxel. affine is
                then the matrix of the larger volume. The split of cells into tetrahedra alternates between even and odd
                indices, so that without this argument a block that begins at an odd index is interpolated differently
                from the larger volume.

        If the grid changes, masks are removed.
        """
        listed = list(arrays) if isinstance(arrays, (list, tuple)) else [arrays]
        images = [_arrays.image(array, f"Array {number} of the volume") for number, array in enumerate(listed)]
        if not images:
            raise ValueError("The volume has no arrays.")
        shape = images[0].shape[2::-1]
        for number, image in enumerate(images):
            if image.shape[2::-1] != shape:
                raise ValueError(
                    f"Array {number} of the volume has {image.shape[2::-1]} voxels, but array 0 has {shape}. Give "
                    "arrays on the same grid."
                )
            if image.ndim == 4 and shape[0] <= 4 < image.shape[3]:
                _warn(
                    f"Array {number} of the volume has {shape} voxels with {image.shape[3]} components each. If its "
                    "axis 0 holds the components, give numpy.moveaxis(array, 0, -1)."
                )
        if numpy.shape(first_index) != (3,):
            raise ValueError(f"first_index is {first_index!r}. Give three integers.")
        first = [_integer(index, "An element of first_index") for index in first_index]
        grid = _grid_of(shape, affine, "the affine matrix of the volume", first)
        self._set_volume_grid(grid, images, categorical, background, density)

    def _set_volume_grid(
        self, grid: _structs.Grid, images: List[numpy.ndarray], categorical=False, background=0.0, density=False
    ) -> None:
        """Like set_volume(), for a grid of the library and arrays with the axes z, y, x."""

        def each(value, what):
            is_list = isinstance(value, (list, tuple)) or (isinstance(value, numpy.ndarray) and value.ndim > 0)
            values = list(value) if is_list else [value] * len(images)
            if len(values) != len(images):
                raise ValueError(
                    f"{what} has {len(values)} values, but the volume has {len(images)} arrays. Give one value, or one "
                    "for each array."
                )
            return values

        labels = each(categorical, "categorical")
        backgrounds = each(background, "background")
        densities = [_flag(one, "density") for one in each(density, "density")]
        structs = (_structs.Array * max(1, len(images)))()
        for struct, image, is_label, value, is_density in zip(structs, images, labels, backgrounds, densities):
            struct.struct_size = ctypes.sizeof(_structs.Array)
            struct.data = image.ctypes.data
            struct.type = _structs.type_of(image)
            struct.components = image.shape[3] if image.ndim == 4 else 1
            struct.categorical = _flag(is_label, "categorical")
            struct.density = is_density
            struct.background = 0.0 if is_density else _number(value, "The background")
            if math.isnan(struct.background) and image.dtype.kind in "iub":
                raise ValueError(f"The background is {value}, which an array of the type {image.dtype} cannot hold.")
        with self._locked():
            self._call("dv_set_volume", ctypes.byref(grid))
            self._call("dv_set_arrays", len(images), structs)
            self._borrowed["arrays"] = images, [_arrays.pin(image) for image in images]
            self._arrays = images
            self._types = [
                numpy.dtype(numpy.float32) if is_density and image.dtype != numpy.float64 else image.dtype
                for image, is_density in zip(images, densities)
            ]
            extent = grid.extent
            self._shape = tuple(extent[2 * axis + 1] - extent[2 * axis] + 1 for axis in range(3))

    def set_blanked(self, blanked: Optional[numpy.ndarray]) -> None:
        """Sets a mask of voxels that are left out (True); axes x, y, z. None: no voxel is left out. Other masks do not
        change."""
        mask = None
        if blanked is not None:
            # Compared with 0 before the conversion to 8 bits, in which 256 would be 0.
            blanked = _arrays.image(blanked, "The mask of blanked voxels") != 0
            mask = self._take_mask(blanked, self._shape or (), numpy.uint8, "blanked voxels")
        self._set_mask("dv_set_blanked", mask)

    def _set_masks(self, *, blanked=None, active=None, boundary=None, cut=None, cut_distances=None) -> None:
        """Sets masks with the axes z, y, x. None: no mask.

        Args:
            blanked: voxels that are left out.
            active: bits of the active tetrahedra of each cell of eight voxels.
            boundary: signed distances of voxels from the surface of the carved region.
            cut: bits of the tetrahedra of each cell that a smooth cut crosses.
            cut_distances: signed distances of voxels from the sheet of that cut.
        """
        voxels = self._shape or ()
        cells = tuple(number - 1 for number in voxels)
        blanked = None if blanked is None else numpy.asarray(blanked) != 0
        masks = (
            self._take_mask(blanked, voxels, numpy.uint8, "blanked voxels"),
            self._take_mask(active, cells, numpy.uint8, "active tetrahedra"),
            self._take_mask(boundary, voxels, numpy.float32, "boundary distances"),
            self._take_mask(cut, cells, numpy.uint8, "cut tetrahedra"),
            self._take_mask(cut_distances, voxels, numpy.float32, "cut distances"),
        )
        with self._locked():
            self._set_mask("dv_set_blanked", masks[0])
            self._set_mask("dv_set_active_tetrahedra", masks[1])
            self._set_mask("dv_set_boundary_distances", masks[2])
            self._set_mask("dv_set_smooth_cut", masks[3], masks[4])

    def _take_mask(self, mask, shape, dtype, what):
        """Returns a checked mask with the axes z, y, x. shape: x, y, z."""
        if mask is None:
            return None
        if self._shape is None:
            raise ValueError(f"There is no volume. Set it before the mask of {what}.")
        taken = numpy.ascontiguousarray(mask, dtype=dtype)
        if dtype == numpy.uint8 and not numpy.array_equal(taken, mask):
            raise ValueError(f"The mask of {what} has values that are not integers from 0 to 255.")
        if taken.shape != shape[::-1]:
            raise ValueError(
                f"The mask of {what} has the shape {taken.shape[::-1]}. For this volume it must have the shape {shape}."
            )
        return taken

    def _set_mask(self, function: str, *masks) -> None:
        with self._locked():
            self._call(function, *[None if mask is None else _structs.address(mask) for mask in masks])
            self._borrowed[function] = masks, [_arrays.pin(mask) for mask in masks if mask is not None]

    def set_deformation(self, deformation: Union[Mesh, Field]) -> None:
        """Sets the mesh or the field that deforms the volume. Replaces the previous one."""
        if isinstance(deformation, Mesh):
            self._set_mesh(deformation)
        elif isinstance(deformation, Field):
            self._set_field(deformation)
        else:
            kind = type(deformation)
            raise TypeError(
                f"The deformation is a {kind.__module__}.{kind.__qualname__}. Give a Mesh or a Field of this package, "
                "made from arrays."
            )

    def _set_mesh(self, mesh: Mesh) -> None:
        points = _arrays.vectors(mesh.points, None, "The array of points")
        displacements = mesh.displacements
        if displacements is not None:
            displacements = _arrays.vectors(displacements, len(points), "The array of displacements")
        with self._locked():
            self._set_mesh_arrays(points, *_cells(mesh.cells))
            if displacements is not None:
                self.set_displacements(displacements)

    def _set_mesh_arrays(
        self, points, connectivity, types=None, offsets=None, *, degrees=None, faces=None
    ) -> None:
        """Sets a mesh in the form of the library: the point indices of all cells, and the offsets of the cells. Types
        and offsets are None if all cells are tetrahedra. degrees: of Lagrange cells, an array of int32 with the shape
        (m, 3). faces: of the polyhedra, an array of int64."""
        points = _arrays.vectors(points, None, "The array of points")
        if offsets is not None and (
            len(offsets) != len(types) + 1
            or offsets[0] != 0
            or offsets[-1] != len(connectivity)
            or (numpy.diff(offsets) < 0).any()
        ):
            raise ValueError(
                f"The mesh has {len(types)} cells with {len(connectivity)} point indices in all, so it needs "
                f"{len(types) + 1} offsets that do not decrease, from 0 to {len(connectivity)}."
            )
        struct = _structs.Mesh(
            number_of_points=len(points),
            points=points.ctypes.data,
            point_type=_structs.type_of(points),
            number_of_cells=len(types) if types is not None else len(connectivity),
            connectivity=connectivity.ctypes.data,
            types=types.ctypes.data if types is not None else None,
            offsets=offsets.ctypes.data if offsets is not None else None,
            degrees=degrees.ctypes.data if degrees is not None else None,
            faces=faces.ctypes.data if faces is not None else None,
            number_of_face_values=len(faces) if faces is not None else 0,
        )
        with self._locked():
            self._call("dv_set_mesh", ctypes.byref(struct))
            self._points = len(points)
            self._borrowed.pop("field", None)

    def set_displacements(self, displacements) -> None:
        """Sets the displacements of the points of the mesh: shape (n, 3), in world units, not in voxels."""
        # Without a mesh, the library raises the error.
        vectors = _arrays.vectors(displacements, self._points or None, "The array of displacements")
        self._call("dv_set_displacements", _structs.type_of(vectors), len(vectors), _structs.address(vectors))

    def _set_field(self, deformation: Field) -> None:
        vectors = _arrays.image(deformation.vectors, "The field", (3,))
        if vectors.dtype not in (numpy.float32, numpy.float64):
            vectors = vectors.astype(numpy.float64)
        grid = _grid_of(vectors.shape[2::-1], deformation.affine, "the affine matrix of the field")
        undefined = deformation.undefined
        if undefined is not None:
            undefined = _arrays.image(undefined, "The mask of undefined points") != 0
            if undefined.shape != vectors.shape[:3]:
                raise ValueError(
                    f"The mask of undefined points has the shape {undefined.shape[::-1]}. For this field it must have "
                    f"the shape {vectors.shape[2::-1]}."
                )
        self._set_field_grid(grid, vectors, deformation.inverse, undefined)

    def _set_field_grid(self, grid: _structs.Grid, vectors: numpy.ndarray, inverse: bool, undefined=None) -> None:
        """Sets a field with a grid of the library, vectors with the axes z, y, x and an axis of components, and a mask
        of bool of undefined points, or None."""
        struct = _structs.Field(
            grid=ctypes.pointer(grid),
            vectors=vectors.ctypes.data,
            type=_structs.type_of(vectors),
            inverse=_flag(inverse, "inverse"),
            undefined=None if undefined is None else undefined.ctypes.data,
        )
        with self._locked():
            self._call("dv_set_field", ctypes.byref(struct))
            self._points = 0
            masks = [] if undefined is None else [undefined]
            self._borrowed["field"] = vectors, masks, [_arrays.pin(array) for array in [vectors, *masks]]

    def set_outside(self, mode: str = "discard", fade_distance: float = 0.0) -> None:
        """Sets what happens to voxels outside the mesh or the field.

        Args:
            mode: "discard": they are left out. "extrapolate": they move with the nearest part of the mesh or field.
                "keep": they stay where they are, and the displacement of the boundary fades to zero over
                fade_distance.
            fade_distance: in world units, 0 or more. With 0, nothing outside moves. Only for "keep".
        """
        if mode != "keep" and fade_distance != 0:
            raise ValueError(f'The fade distance is {fade_distance}, but has no effect with outside="{mode}".')
        distance = _number(fade_distance, "The fade distance")
        self._call("dv_set_outside", _choose(mode, _structs.OUTSIDE, "outside"), distance)

    def set_reference(self, reference: Union[Grid, Tuple[Sequence[int], numpy.ndarray], None]) -> None:
        """Sets the grid of the output, such as that of the fixed image of a registration. None: see set_output()."""
        if reference is None:
            self._call("dv_set_reference", None)
            return
        if not isinstance(reference, (tuple, list)) or len(reference) != 2:
            raise TypeError(
                f"The reference is a {type(reference).__name__}. Give a Grid, or a pair of a shape and an affine "
                "matrix, such as (image.shape, image.affine)."
            )
        shape, matrix = reference
        if numpy.shape(shape) != (3,):
            raise ValueError(
                f"The first element of the reference is an array of the shape {numpy.shape(shape)}. It must be a shape "
                "of three integers, as in (image.shape, image.affine)."
            )
        shape = tuple(_integer(number, "A number of the shape of the reference") for number in shape)
        if min(shape) < 1:
            raise ValueError(f"The shape of the reference is {shape}. Give three numbers of at least 1.")
        self._set_reference_grid(_grid_of(shape, matrix, "the affine matrix of the reference"))

    def _set_reference_grid(self, grid: _structs.Grid) -> None:
        """Like set_reference(), for a grid of the library."""
        self._call("dv_set_reference", ctypes.byref(grid))

    def set_output(
        self,
        bounds: Union[str, Sequence[float], numpy.ndarray] = "deformed",
        *,
        padding: int = 0,
        spacing: Optional[Sequence[float]] = None,
    ) -> None:
        """Sets the bounds and the spacing of the output, which has the axes of the volume. Not used with a reference.

        Args:
            bounds: "deformed": those of the deformed volume. "volume": those of the volume at rest. Or six numbers: x
                min, x max, y min, y max, z min, z max, in world coordinates.
            padding: width of a border on each side, in voxels. A negative width crops the output.
            spacing: three numbers in world units; None: that of the volume.
        """
        struct = _structs.Output(padding=_integer(padding, "The padding"))
        if isinstance(bounds, str):
            names = {name: _structs.BOUNDS[name] for name in ("deformed", "volume")}
            struct.bounds_mode = _choose(bounds, names, "bounds")
        else:
            if numpy.shape(bounds) != (6,):
                raise ValueError(
                    f"bounds has the shape {numpy.shape(bounds)}. Give six numbers (x min, x max, y min, y max, z min, "
                    'z max), "deformed" or "volume".'
                )
            struct.bounds_mode = _structs.BOUNDS["custom"]
            struct.custom_bounds[:] = [_number(bound, "A number of bounds") for bound in bounds]
        if spacing is not None:
            if numpy.shape(spacing) != (3,):
                raise ValueError(f"The spacing is {spacing}. Give three numbers.")
            struct.spacing[:] = [_number(value, "A number of the spacing") for value in spacing]
            if not all(value > 0.0 for value in struct.spacing):
                raise ValueError(f"The spacing is {spacing}. Give three numbers greater than 0.")
        self._call("dv_set_output", ctypes.byref(struct))

    def _find_output_grid(self) -> _structs.Grid:
        """Returns the grid of the output."""
        grid = _structs.Grid()
        self._call("dv_output_grid", ctypes.byref(grid))
        return grid

    def deform(
        self,
        *,
        interpolation: str = "linear",
        rest_positions: bool = False,
        jacobian: bool = False,
        fold_count: bool = False,
        extra_background: float = 0.0,
        progress: Optional[Callable[[float], object]] = None,
    ) -> Deformed:
        """Deforms the volume into new arrays.

        Args:
            interpolation: "linear": linear in each of the five tetrahedra between eight neighboring voxels, with an
                inverse field trilinear. "cubic": Catmull-Rom. "nearest": all arrays are treated as categorical.
                Categorical arrays take the value of one voxel: of the vertex with the largest weight in the
                tetrahedron, with an inverse field of the nearest voxel.
            rest_positions, jacobian, fold_count: whether to compute these arrays, see Deformed.
            extra_background: value of rest_positions and jacobian for voxels outside the deformed volume.
            progress: called with the fraction done, which does not decrease and ends with 1. If it returns False
                before 1, the call raises KeyboardInterrupt, as for Ctrl-C. If it raises an exception, the call ends
                with that exception.

        Warns:
            DeformationWarning: cells of the mesh are ignored, or a part of the volume cannot be deformed. Folds cause
                no warning: see Deformed.counts["number_of_inverted_tetrahedra"].
        """
        wanted = {
            "rest_positions": _flag(rest_positions, "rest_positions"),
            "jacobian": _flag(jacobian, "jacobian"),
            "fold_count": _flag(fold_count, "fold_count"),
        }
        with self._locked():
            grid = self._find_output_grid()
            shape = tuple(grid.extent[2 * axis + 1] - grid.extent[2 * axis] + 1 for axis in range(3))
            kinds = [(array.shape[3:], dtype) for array, dtype in zip(self._arrays, self._types)]
            extra_kinds = {
                "rest_positions": ((3,), numpy.float32),
                "jacobian": ((), numpy.float32),
                "fold_count": ((), numpy.uint32),
            }
            try:
                outputs = [numpy.empty(shape[::-1] + components, dtype) for components, dtype in kinds]
                coverage = numpy.empty(shape[::-1], numpy.int8)
                extra = {
                    name: numpy.empty(shape[::-1] + components, dtype) if wanted[name] else None
                    for name, (components, dtype) in extra_kinds.items()
                }
            except (MemoryError, ValueError) as error:  # ValueError: more elements than an array can have
                raise MemoryError(
                    f"The output has {shape} voxels, and the volume {self._shape}: {error}. Check that the volume and "
                    "the deformation have the same unit, or limit the output by bounds, spacing or reference."
                ) from error
            report = self._run(
                outputs,
                coverage,
                interpolation=interpolation,
                extra={name: array for name, array in extra.items() if array is not None},
                extra_background=extra_background,
                progress=progress,
            )
            text = report.warnings.decode("utf-8", "replace") if report.warnings else ""
            device = report.device.decode("utf-8", "replace") if report.device else ""
        if text:
            _warn(text)
        for output in outputs:
            if output.dtype == numpy.bool_:
                # Cubic interpolation and the background give other numbers than 0 and 1.
                numpy.not_equal(output.view(numpy.uint8), 0, out=output)
        origin = numpy.asarray(grid.origin[:])
        direction = numpy.asarray(grid.direction[:]).reshape(3, 3)
        first = numpy.asarray(grid.spacing[:]) * numpy.asarray(grid.extent[0::2])
        return Deformed(
            arrays=[_arrays.from_image(output) for output in outputs],
            affine=_arrays.join_affine(origin + direction @ first, grid.spacing[:], direction),
            coverage=_arrays.from_image(coverage).view(numpy.bool_),
            counts=report.counts(),
            device=device,
            **{name: None if array is None else _arrays.from_image(array) for name, array in extra.items()},
        )

    def _run(
        self,
        outputs,
        coverage,
        *,
        interpolation="linear",
        extra=None,
        extra_background=0.0,
        progress=None,
    ) -> _structs.Report:
        """Like deform(), but writes into given arrays with the axes z, y, x. Returns the report of the library, and
        raises no warnings."""
        extra = extra or {}
        addresses = (ctypes.c_void_p * max(1, len(outputs)))(*[output.ctypes.data for output in outputs])
        request = _structs.Request(
            interpolation=_choose(interpolation, _structs.INTERPOLATION, "interpolation"),
            number_of_outputs=len(outputs),
            outputs=ctypes.cast(addresses, ctypes.POINTER(ctypes.c_void_p)),
            coverage=coverage.ctypes.data_as(ctypes.POINTER(ctypes.c_int8)),
            extra_background=_number(extra_background, "extra_background"),
        )
        kinds = {"rest_positions": ctypes.c_float, "jacobian": ctypes.c_float, "fold_count": ctypes.c_uint32}
        for name, array in extra.items():
            setattr(request, name, array.ctypes.data_as(ctypes.POINTER(kinds[name])))
        report = _structs.Report()
        self._call_with_progress("dv_deform", request, report, progress)
        return report

    def deform_points(
        self, points, *, inverse: bool = False, progress: Optional[Callable[[float], object]] = None
    ) -> DeformedPoints:
        """Moves points as the volume is moved, or back to rest. Needs no volume, and computes in double precision.

        Args:
            points: shape (n, 3), in world coordinates.
            inverse: False: from rest to deformed positions. True: from deformed positions to rest.
            progress: see deform().

        Warns:
            DeformationWarning: points lie outside the deformation, or cells of the mesh are ignored.
        """
        vectors = _arrays.vectors(points, None, "The array of points")
        given = vectors.astype(numpy.float64, copy=False)
        moved, valid = numpy.empty_like(given), numpy.empty(len(given), numpy.bool_)
        request = _structs.PointsRequest(
            number_of_points=len(given),
            points=given.ctypes.data,
            inverse=_flag(inverse, "inverse"),
            were_floats=int(vectors.dtype == numpy.float32),
            moved=moved.ctypes.data,
            valid=valid.ctypes.data,
        )
        report = _structs.PointsReport()
        with self._locked():
            self._call_with_progress("dv_deform_points", request, report, progress)
            text = report.warnings.decode("utf-8", "replace")
        if text:
            _warn(text)
        return DeformedPoints(moved, valid)

    def _call_with_progress(self, name: str, request, report, progress) -> None:
        """Calls a function of the library with a request, a report, and a progress callback of Python."""
        failure = []

        def report_progress(fraction, _):
            if _calls.has_ended and not _is_in_main_thread():
                return 1
            try:
                interrupts.call()
                result = None if progress is None else progress(fraction)
                return 1 if isinstance(result, (bool, numpy.bool_)) and not result else 0
            except BaseException as error:  # pylint: disable=broad-except
                failure.append(error)
                return 1

        request.progress = _structs.PROGRESS(report_progress)
        with self._locked(), _Interrupts() as interrupts:
            self._is_running = True
            try:
                function = getattr(_native.library, name)
                status = function(self._handle, ctypes.byref(request), ctypes.byref(report))
            finally:
                self._is_running = False
        interrupts.call()
        if failure:
            # An exception that stays in a variable of this function would keep all arrays of its frame alive.
            raise failure.pop()
        _native.check(status)

    def release_memory(self) -> None:
        """Frees the memory on the device. The next deform() sends the data again."""
        self._call("dv_release_memory")


def _destroy(handle: int, process: int) -> None:
    # In a forked process, the objects of OpenCL are not valid, and cannot be released.
    if os.getpid() == process:
        with _calls:
            _native.library.dv_destroy(handle)


def deform(
    volume: Union[numpy.ndarray, Sequence[numpy.ndarray]],
    deformation: Union[Mesh, Field],
    affine=None,
    *,
    reference: Union[Grid, Tuple[Sequence[int], numpy.ndarray], None] = None,
    categorical: Union[bool, Sequence[bool]] = False,
    background: Union[float, Sequence[float]] = 0.0,
    density: Union[bool, Sequence[bool]] = False,
    first_index: Sequence[int] = (0, 0, 0),
    outside: str = "discard",
    fade_distance: float = 0.0,
    interpolation: str = "linear",
    bounds: Union[str, Sequence[float], numpy.ndarray] = "deformed",
    padding: int = 0,
    spacing: Optional[Sequence[float]] = None,
    rest_positions: bool = False,
    jacobian: bool = False,
    fold_count: bool = False,
    extra_background: float = 0.0,
    device: str = "",
    progress: Optional[Callable[[float], object]] = None,
) -> Deformed:
    """Deforms a volume by a mesh or a field.

    Args:
        volume: one or several arrays with the axes x, y, z (and components); see Deformer.set_volume().
        deformation: a Mesh or a Field.
        affine: 4 x 4 matrix from the index of a voxel to world coordinates; None: the identity.
        reference: the grid of the output; None: given by bounds, padding and spacing, see Deformer.set_output().
        categorical, background, density, first_index: see Deformer.set_volume().
        outside, fade_distance: see Deformer.set_outside().
        interpolation, rest_positions, jacobian, fold_count, extra_background, progress: see Deformer.deform().
        device: see Deformer.

    Returns:
        Deformed: the deformed arrays and their affine.

    Example, which shifts a scan by 5 mm along x:

    >>> import numpy as np, deformvolume as dv
    >>> scan = np.zeros((40, 40, 40), "int16")
    >>> scan[10:20, 10:20, 10:20] = 1000
    >>> affine = np.diag([2.0, 2.0, 2.0, 1.0])
    >>> field = dv.Field(np.tile([5.0, 0.0, 0.0], (2, 2, 2, 1)), np.diag([78.0, 78.0, 78.0, 1.0]))
    >>> result = dv.deform(scan, field, affine, bounds="volume")
    >>> result.array.shape, int(result.array[13, 15, 15])
    ((40, 40, 40), 1000)
    """
    with Deformer(device) as deformer:
        deformer.set_volume(
            volume,
            numpy.eye(4) if affine is None else affine,
            categorical=categorical,
            background=background,
            density=density,
            first_index=first_index,
        )
        deformer.set_deformation(deformation)
        deformer.set_outside(outside, fade_distance)
        deformer.set_reference(reference)
        if reference is None:
            deformer.set_output(bounds, padding=padding, spacing=spacing)
        elif not (isinstance(bounds, str) and bounds == "deformed") or padding != 0 or spacing is not None:
            raise ValueError(
                "The output has the grid of the reference. Do not give bounds, padding or spacing with a reference."
            )
        return deformer.deform(
            interpolation=interpolation,
            rest_positions=rest_positions,
            jacobian=jacobian,
            fold_count=fold_count,
            extra_background=extra_background,
            progress=progress,
        )


def deform_points(
    points,
    deformation: Union[Mesh, Field],
    *,
    inverse: bool = False,
    outside: str = "discard",
    fade_distance: float = 0.0,
    progress: Optional[Callable[[float], object]] = None,
) -> DeformedPoints:
    """Moves points, such as landmarks or a surface, as deform() moves a volume, or back to rest.

    Args:
        points: shape (n, 3), in world coordinates.
        deformation: a Mesh or a Field.
        inverse: False: from rest to deformed positions. True: from deformed positions to rest. The inverse field of a
            registration leads from the fixed to the moving image: landmarks of the moving image move to the fixed
            image with inverse=False, and those of the fixed image to the moving image with inverse=True.
        outside, fade_distance: see Deformer.set_outside().
        progress: see Deformer.deform().

    Returns:
        DeformedPoints: the new positions, and which points the deformation moves.

    >>> import numpy as np, deformvolume as dv
    >>> field = dv.Field(np.tile([5.0, 0.0, 0.0], (2, 2, 2, 1)), np.diag([78.0, 78.0, 78.0, 1.0]))
    >>> dv.deform_points([[10, 20, 30]], field).points
    array([[15., 20., 30.]])
    """
    with Deformer() as deformer:
        deformer.set_deformation(deformation)
        deformer.set_outside(outside, fade_distance)
        return deformer.deform_points(points, inverse=inverse, progress=progress)
