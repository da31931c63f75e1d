// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelText_h
#define DeformVolumeKernelText_h

#include "OpenCLContext.h"

#include <string>

namespace deformvolume
{

/// Whether the device has double precision.
bool HasDouble(const OpenCLContext& context);

/// Floats in a vector of the device that the kernels for processors use.
int GetLanes(const OpenCLContext& context);

/// What all programs are compiled with.
extern const char* const KernelOptions;

/// The type of arithmetic that is as precise as the device has it.
std::string GetReal(const OpenCLContext& context);

} // namespace deformvolume

#endif
