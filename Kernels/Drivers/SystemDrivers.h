// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSystemDrivers_h
#define DeformVolumeSystemDrivers_h

#include <string>
#include <vector>

namespace deformvolume
{

/// Finds the libraries of the OpenCL drivers that are installed on the system, as the loaders of
/// Khronos and ocl-icd do:
/// 1. the libraries in the environment variable OCL_ICD_FILENAMES, separated by colons,
/// 2. the libraries of the environment variable OCL_ICD_VENDORS: a folder, an .icd file or a
///    library. If this variable is not set or empty: the libraries of the folder in the environment
///    variable OPENCL_VENDOR_PATH. Default: /etc/OpenCL/vendors.
/// A folder stands for all of its .icd files in alphabetical order. The first line of an .icd file
/// is the name of a library.
std::vector<std::string> FindSystemDrivers();

} // namespace deformvolume

#endif
