// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDevice_h
#define DeformVolumeDevice_h

#include "DeformVolumeExport.h"

#include <string>
#include <vector>

namespace deformvolume
{

/// Returns the names of the OpenCL devices of this machine as "device (platform)", the best first:
/// 1. GPUs with memory of their own,
/// 2. accelerators with memory of their own,
/// 3. CPUs,
/// 4. GPUs and accelerators that share the memory of the CPU (CL_DEVICE_HOST_UNIFIED_MEMORY).
///    This memory is as slow for them as for the CPU, and the kernels for CPUs use it better.
/// 5. devices that are emulated by a software renderer (llvmpipe) or an interpreter (Oclgrind).
/// Within each kind, devices with double precision come first, then those with more compute units.
/// Empty if there is no OpenCL platform; this is not an error.
DEFORMVOLUME_EXPORT std::vector<std::string> GetDeviceNames();

/// Adds an OpenCL driver that is not installed on the system. path: absolute path of its library.
/// The library is loaded immediately and stays loaded. A second call with the same path does
/// nothing. Devices of added drivers precede equal devices of the system. Throws Error if the path
/// is not absolute, or if the library cannot be loaded or is not an OpenCL driver.
///
/// PoCL 3.0 of the Python package pocl-binary-distribution is made to compile kernels for the right
/// processor, unless the environment variable DEFORMVOLUME_KERNEL_PROCESSOR is "driver"
/// (KernelProcessor.h).
DEFORMVOLUME_EXPORT void AddDriver(const std::string& path);

/// Set the folder of a linker "ld" for PoCL drivers that were added with AddDriver(). PoCL uses it
/// if the "ld" on the PATH does not work: without a linker, PoCL terminates the process. Call this
/// before a device is used. The environment variable DEFORMVOLUME_LINKER changes the choice: with
/// "system" this linker is never used, with "own" always. While kernels are compiled, the
/// environment variable COMPILER_PATH of this process contains the folder. Throws Error if the path
/// is not absolute.
DEFORMVOLUME_EXPORT void SetKernelLinker(const std::string& folder);

/// Properties of a device.
struct DeviceSummary
{
  /// The name, as in GetDeviceNames().
  std::string Name;
  /// Whether the device is a CPU, which works in host memory.
  bool IsProcessor = false;
  /// Whether a software renderer or an interpreter emulates the device. Such devices are slow.
  bool IsEmulated = false;
  /// Whether the device supports double precision (cl_khr_fp64).
  bool DoublePrecision = false;
};

/// Returns the devices of GetDeviceNames(), in the same order.
DEFORMVOLUME_EXPORT std::vector<DeviceSummary> GetDevices();

/// Returns the name of the device that a request selects, by the rules of
/// vtkDeformVolumeFilter::SetDevice():
/// - "": the request in the environment variable DEFORMVOLUME_DEVICE, or the best device if the
///   variable is not set,
/// - "cpu" or "gpu": the best device of that kind,
/// - any other text: the first device whose name contains the text, ignoring case.
/// Throws Error if no device matches.
DEFORMVOLUME_EXPORT std::string ResolveDevice(const std::string& request);

/// Abilities of a device.
struct DeviceAbilities
{
  /// Whether the device supports double precision. Other devices refuse arrays of doubles, and
  /// linear interpolation of 32-bit and 64-bit integers; they interpolate all other arrays in
  /// single precision.
  bool DoublePrecision = false;
  /// Whether a work-item can use the vector registers of a CPU, as the resampling by lanes does.
  bool Vectors = false;
  /// Whether the device does not work in host memory: true for all devices except CPUs.
  bool OwnMemory = false;
};

/// Returns the abilities of the device that a request selects. Throws Error if no device matches
/// (ResolveDevice()).
DEFORMVOLUME_EXPORT DeviceAbilities GetDeviceAbilities(const std::string& request);

/// Set the number of processes that share the processors of this machine. Default: 1. It limits the
/// threads on the host and on CPU devices to the share of one process. The environment variable
/// POCL_MAX_PTHREAD_COUNT overrides the limit for CPU devices. Call this before any other function:
/// devices read the limit when they start.
DEFORMVOLUME_EXPORT void ShareProcessors(int processes);

} // namespace deformvolume

#endif
