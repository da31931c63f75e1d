# SPDX-License-Identifier: BSD-3-Clause
"""Deforms volumes, such as CT and MRI scans, by meshes and displacement fields, at full resolution."""

from ._driver import Device, devices
from ._native import Error, version as _version

__version__ = _version()
__all__ = ["Device", "Error", "devices"]
