# SPDX-License-Identifier: BSD-3-Clause
"""Deforms volumes, such as CT and MRI scans, by meshes and displacement fields, at full resolution.

    >>> import numpy as np, deformvolume as dv
    >>> scan = np.random.rand(30, 30, 30).astype("float32")     # axes x, y, z
    >>> affine = np.diag([2.0, 2.0, 2.0, 1.0])                  # index to world coordinates, such as nibabel's
    >>> field = dv.Field(np.random.rand(4, 4, 4, 3), np.diag([20.0, 20.0, 20.0, 1.0]))
    >>> deformed = dv.deform(scan, field, affine)
    >>> deformed.array.dtype, deformed.affine.shape
    (dtype('float32'), (4, 4))

deformvolume.vtk has a filter for VTK's pipelines, and deformvolume.pyvista and deformvolume.sitk deform images of
pyvista and SimpleITK. devices() lists the OpenCL devices.
"""

from ._deformer import (
    Deformed,
    DeformedPoints,
    Deformer,
    DeformationWarning,
    Field,
    Grid,
    Mesh,
    deform,
    deform_points,
)
from ._driver import Device, devices
from ._native import Error, version as _version

__version__ = _version()
__all__ = [
    "Deformed",
    "DeformedPoints",
    "Deformer",
    "DeformationWarning",
    "Device",
    "Error",
    "Field",
    "Grid",
    "Mesh",
    "deform",
    "deform_points",
    "devices",
]
