// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelCache_h
#define DeformVolumeKernelCache_h

namespace deformvolume
{

/// Checks the directory in which PoCL caches compiled kernels. If PoCL cannot create the directory,
/// write to it or execute from it, PoCL has no devices or terminates the process. In that case this
/// function sets POCL_CACHE_DIR to a private temporary directory. Call it before any function of
/// OpenCL. Later calls do nothing.
void PrepareKernelCache();

/// Throws Error if there is no usable cache directory.
void CheckKernelCache();

} // namespace deformvolume

#endif
