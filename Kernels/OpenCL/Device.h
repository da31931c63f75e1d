// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDevice_h
#define DeformVolumeDevice_h

#include "DeformVolumeExport.h"

#include <string>
#include <vector>

namespace deformvolume
{

/// Names of the OpenCL devices of this machine, the best first, as "device (platform)". The order:
/// 1. graphics processors with memory of their own,
/// 2. accelerators with memory of their own,
/// 3. processors,
/// 4. graphics processors and accelerators that share the memory of the processor
///    (CL_DEVICE_HOST_UNIFIED_MEMORY): they are bound by the same memory, and the kernels for
///    processors make more of it,
/// 5. devices that are emulated by a renderer in software (llvmpipe) or an interpreter (Oclgrind).
/// Of one kind, devices with double precision come first, then those with more compute units.
/// Empty where there is no OpenCL platform; never throws for that.
DEFORMVOLUME_EXPORT std::vector<std::string> GetDeviceNames();

/// Adds an OpenCL driver that the system does not list. path: the absolute path of its library,
/// which is loaded at once and stays loaded; the same path again does nothing. Devices of drivers
/// that were added come before equal ones of the system. Throws Error where the path is not
/// absolute, where the library cannot be loaded, and where it is no OpenCL driver. What PoCL 3.0 of
/// the Python package pocl-binary-distribution compiles kernels for is set right, unless the
/// environment variable DEFORMVOLUME_KERNEL_PROCESSOR is "driver" (KernelProcessor.h).
DEFORMVOLUME_EXPORT void AddDriver(const std::string& path);

/// The folder of a program "ld", with which PoCL links kernels where it is a driver of AddDriver(),
/// and the "ld" on the PATH does not work: without one it would end the process. To be called
/// before a device is used. The environment variable DEFORMVOLUME_LINKER changes that: "system"
/// never takes the program, "own" always does for such drivers. While kernels are compiled, the
/// folder is in the environment variable COMPILER_PATH of this process. Throws Error where the path
/// is not absolute.
DEFORMVOLUME_EXPORT void SetKernelLinker(const std::string& folder);

/// What a driver says of a device.
struct DeviceSummary
{
  /// The name, as GetDeviceNames() has it.
  std::string Name;
  /// Whether it is a processor, which works in the memory of the host.
  bool IsProcessor = false;
  /// By a renderer in software, or by an interpreter: such devices are slow.
  bool IsEmulated = false;
  /// Whether it has double precision.
  bool DoublePrecision = false;
};

/// The devices of GetDeviceNames(), in the same order.
DEFORMVOLUME_EXPORT std::vector<DeviceSummary> GetDevices();

/// The name of the device that a request resolves to, with the rules of vtkDeformVolumeFilter::
/// SetDevice: "" is the value of the environment variable DEFORMVOLUME_DEVICE where that is set
/// and otherwise the best device; "cpu" and "gpu" are the best device of that kind; everything
/// else is a part of a device's name, compared without regard to case. Throws Error where no
/// device answers to the request.
DEFORMVOLUME_EXPORT std::string ResolveDevice(const std::string& request);

/// What a device can do.
struct DeviceAbilities
{
  /// Without it arrays of doubles and linear arrays of integers of 32 and 64 bits are refused, and
  /// all others are interpolated in single precision.
  bool DoublePrecision = false;
  /// Whether a work-item has the vector registers of a processor for itself, as the resampling by
  /// lanes needs.
  bool Vectors = false;
  /// Whether it has memory apart from that of the host: all devices but processors count as such.
  bool OwnMemory = false;
};

/// Of the device that a request resolves to. Throws Error as ResolveDevice does.
DEFORMVOLUME_EXPORT DeviceAbilities GetDeviceAbilities(const std::string& request);

/// So many processes share the processors of this machine: threads of the host, and devices that
/// are processors unless the environment variable POCL_MAX_PTHREAD_COUNT is set, take their share
/// of these. To be called before any other function, as devices start once.
DEFORMVOLUME_EXPORT void ShareProcessors(int processes);

} // namespace deformvolume

#endif
