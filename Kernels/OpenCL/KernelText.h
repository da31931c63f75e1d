// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelText_h
#define DeformVolumeKernelText_h

#include "OpenCLContext.h"

#include <string>

namespace deformvolume
{

/// Whether the device supports double precision.
bool HasDouble(const OpenCLContext& context);

/// Number of floats in the vectors that the kernels for CPUs use on this device: 4, 8 or 16.
int GetLanes(const OpenCLContext& context);

/// Compiler options of all programs.
extern const char* const KernelOptions;

/// Returns the OpenCL source that defines REAL, the most precise floating-point type of the device,
/// REAL_IS_DOUBLE and EXACT.
std::string GetReal(const OpenCLContext& context);

} // namespace deformvolume

#endif
