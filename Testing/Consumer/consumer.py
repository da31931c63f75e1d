# SPDX-License-Identifier: BSD-3-Clause
"""Imports the package, and checks that package and libraries are those of the installation prefix."""
import os
import sys

import deformvolume_vtk

prefix = os.path.realpath(sys.argv[1])
assert os.path.realpath(deformvolume_vtk.__file__).startswith(prefix), deformvolume_vtk.__file__
devices = deformvolume_vtk.vtkDeformVolumeFilter.GetDeviceNames()
assert devices.GetNumberOfValues() > 0, devices.GetNumberOfValues()
with open("/proc/self/maps", encoding="utf-8") as maps:
    # If the libraries are static, only the Python modules have such names.
    libraries = {line.split()[-1] for line in maps if "vtkDeformVolume" in line}
assert libraries and all(name.startswith(prefix) for name in libraries), libraries
