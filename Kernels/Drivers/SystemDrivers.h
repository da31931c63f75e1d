// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSystemDrivers_h
#define DeformVolumeSystemDrivers_h

#include <string>
#include <vector>

namespace deformvolume
{

/// The libraries of the OpenCL drivers that the system lists, as the loaders of Khronos and ocl-icd
/// find them:
/// 1. those of the environment variable OCL_ICD_FILENAMES, separated by colons,
/// 2. those of the environment variable OCL_ICD_VENDORS: a folder, a file *.icd or a library; where
///    it is not set or empty, of the folder OPENCL_VENDOR_PATH, or else of /etc/OpenCL/vendors.
/// A folder stands for its files *.icd in the order of their names, and such a file has the name of
/// a library in its first line.
std::vector<std::string> FindSystemDrivers();

} // namespace deformvolume

#endif
