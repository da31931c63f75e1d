// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelCache_h
#define DeformVolumeKernelCache_h

namespace deformvolume
{

/// PoCL writes the kernels it compiles into a cache directory and loads them from there. Where that
/// directory cannot be made, written to or executed from, PoCL has no devices or ends the process.
/// This looks first, before anything of OpenCL is called, and falls back to a private temporary
/// directory. Later calls do nothing.
void PrepareKernelCache();

/// Throws Error where there is no usable cache directory.
void CheckKernelCache();

} // namespace deformvolume

#endif
