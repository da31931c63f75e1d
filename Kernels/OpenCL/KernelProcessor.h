// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelProcessor_h
#define DeformVolumeKernelProcessor_h

#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#include <CL/opencl.hpp>

#include <string>

namespace deformvolume
{

/// PoCL 3.0 of the package pocl-binary-distribution has built-in functions that were compiled for
/// one of eight processors, of which it takes the best that this processor can run. But it compiles
/// kernels for the processor that its LLVM 14 recognizes. The two do not fit together: LLVM does
/// not recognize later processors at all, and then no kernel is compiled; it takes Zen 4 for Zen 3,
/// for which built-in functions with AVX-512 cannot be compiled, and then the process ends; on
/// others the functions are not inlined, and kernels take up to three times as long. Nothing but a
/// member of the driver's own structure says what kernels are compiled for. So this sets that
/// member to the processor of the built-in functions, before anything has been compiled. library:
/// the file of the driver, which is loaded. Returns the name of the processor; empty where this is
/// another driver, or the member is not found, and nothing has changed.
std::string SetKernelProcessor(const std::string& library, const cl::Device& device);

} // namespace deformvolume

#endif
