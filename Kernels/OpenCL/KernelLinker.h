// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelLinker_h
#define DeformVolumeKernelLinker_h

#include <string>

namespace deformvolume
{

/// Throws Error where PoCL could not link kernels. Before version 7.2 it runs the program "ld" for
/// each kernel, with the libraries of a C compiler, and ends the process where that fails. So this
/// links once, with the same libraries and nothing else. version: what a platform says of itself
/// (CL_PLATFORM_VERSION).
void CheckKernelLinker(const std::string& version);

} // namespace deformvolume

#endif
