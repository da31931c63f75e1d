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

/// What an added driver compiles kernels for.
struct KernelProcessor
{
  /// The name of the processor, as LLVM has it; empty: the driver has chosen one.
  std::string Name;
  /// Whether the driver would end the process when it compiles a kernel.
  bool EndsProcess = false;
};

/// PoCL 3.0 of the package pocl-binary-distribution has built-in functions that were compiled for
/// one of eight processors, of which it takes the best that this processor can run. But it compiles
/// kernels for the processor that its LLVM 14 recognizes. The two do not fit together: LLVM does
/// not recognize later processors at all, and then no kernel is compiled; it takes Zen 4 for Zen 3,
/// for which built-in functions with AVX-512 cannot be compiled, and then the process ends; on
/// others the functions are not inlined, and kernels take up to three times as long. Nothing but a
/// member of the driver's own structure says what kernels are compiled for. So this sets that
/// member to the processor of the built-in functions, before anything has been compiled.
///
/// It does so for one library only, which its version and its build ID have to name, and only where
/// exactly one member has the text that the driver is known to have put there. Else nothing
/// changes. library: the file of the driver, which is loaded. maySet: MaySetKernelProcessor().
KernelProcessor SetKernelProcessor(
  const std::string& library, const cl::Device& device, bool maySet);

/// Whether that may be done: not where the environment variable DEFORMVOLUME_KERNEL_PROCESSOR is
/// "driver". Throws Error where it is neither that nor "auto".
bool MaySetKernelProcessor();

} // namespace deformvolume

#endif
