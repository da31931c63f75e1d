// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDriverLibrary_h
#define DeformVolumeDriverLibrary_h

#ifndef CL_TARGET_OPENCL_VERSION // CL/opencl.hpp defines it, too
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <string>
#include <vector>

namespace deformvolume
{

/// Loads the library of an OpenCL driver (cl_khr_icd), which is never unloaded, and returns its
/// platforms. On failure the list is empty, and `problem` says why.
std::vector<cl_platform_id> LoadPlatforms(const std::string& library, std::string& problem);

} // namespace deformvolume

#endif
