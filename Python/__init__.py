# SPDX-License-Identifier: BSD-3-Clause
"""Deformed volumes as ordinary vtkImageData, at full resolution."""

from .vtkDeformVolume import *
