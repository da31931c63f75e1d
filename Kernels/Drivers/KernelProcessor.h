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

/// The processor for which an added driver compiles kernels.
struct KernelProcessor
{
  /// The name of the processor in LLVM. Empty if the driver has chosen the processor.
  std::string Name;
  /// Whether the driver would terminate the process when it compiles a kernel.
  bool EndsProcess = false;
};

/// Makes PoCL 3.0 of the package pocl-binary-distribution compile kernels for the processor for
/// which its built-in functions were compiled. library: the file of the driver, which must be
/// loaded. maySet: MaySetKernelProcessor(). Call this before any kernel is compiled.
///
/// This driver has built-in functions for eight processors, and uses the best ones that this
/// processor can execute. But it compiles kernels for the processor that its LLVM 14 recognizes.
/// The two processors often do not match:
/// - LLVM 14 does not recognize later processors. Then no kernel is compiled.
/// - LLVM 14 takes Zen 4 for Zen 3, for which built-in functions with AVX-512 cannot be compiled.
///   Then the process terminates.
/// - On other processors the built-in functions are not inlined, and kernels take up to three times
///   as long.
/// Only a member of the driver's private structure holds the processor of the kernels. This
/// function changes that member.
///
/// Nothing is changed unless the version and the build ID of the library are those of the one known
/// library, and exactly one member of the structure points to the name of the recognized processor.
KernelProcessor SetKernelProcessor(
  const std::string& library, const cl::Device& device, bool maySet);

/// Whether SetKernelProcessor() may change the driver: false if the environment variable
/// DEFORMVOLUME_KERNEL_PROCESSOR is "driver". Throws Error if it is neither that nor "auto".
bool MaySetKernelProcessor();

} // namespace deformvolume

#endif
