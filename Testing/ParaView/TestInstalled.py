# SPDX-License-Identifier: BSD-3-Clause
"""Tests that ParaView finds the installed plugin through PV_PLUGIN_PATH, and that the plugin finds its libraries."""

import os

from paraview import servermanager

from PluginTesting import bent_lattice, check, deformed, wavelet

filters = [name for name in ("DeformVolume", "TetGenMesher") if hasattr(servermanager.filters, name)]
check(len(filters) == 2, f"Expected two filters, not {filters}")
volume = wavelet(5)
filter_ = deformed(volume, bent_lattice(volume))
check(filter_.CoveredVoxels > 500.0, f"CoveredVoxels is {filter_.CoveredVoxels}")

with open("/proc/self/maps", encoding="ascii", errors="replace") as file:
    libraries = {line.split()[-1] for line in file if "DeformVolume" in line}
folder = os.environ["PV_PLUGIN_PATH"].split("/Testing/Install/")[0] + "/Testing/Install/"
names = sorted(os.path.basename(library).split(".")[0] for library in libraries)
check(names == ["DeformVolume", "libDeformVolumeKernels", "libvtkDeformVolume"], f"The loaded libraries are {names}")
check(all(library.startswith(folder) for library in libraries), f"Libraries outside {folder}: {libraries}")
