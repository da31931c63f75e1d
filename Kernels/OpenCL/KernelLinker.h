// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelLinker_h
#define DeformVolumeKernelLinker_h

#include <string>

namespace deformvolume
{

/// Throws Error where PoCL could not link kernels. Versions before 7.2 run the program "ld" for
/// each kernel, with the libraries of a C compiler, and end the process where that fails; later
/// ones mostly link by themselves, and are not asked. So this links once, with the same libraries
/// and nothing else. version: what a platform says of itself (CL_PLATFORM_VERSION).
void CheckKernelLinker(const std::string& version);

} // namespace deformvolume

#endif
