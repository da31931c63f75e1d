// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceRank_h
#define DeformVolumeDeviceRank_h

#include <string>

namespace deformvolume
{

/// Properties that a driver reports for a device.
struct DeviceDescription
{
  enum class Kind
  {
    Processor,
    Graphics,
    Other // accelerators
  };
  Kind Type = Kind::Processor;
  std::string Name;
  std::string Platform;
  /// Whether the device works in host memory (CL_DEVICE_HOST_UNIFIED_MEMORY).
  bool SharesMemory = false;
  bool HasDouble = true;
  unsigned int ComputeUnits = 1;
};

/// Converts a text to lower case. Device names are compared in lower case.
std::string ToLower(std::string text);

/// Whether a software renderer or an interpreter emulates the device on the CPU. Such a device is
/// slower than an OpenCL driver for CPUs, whatever type and number of units its driver reports.
bool IsEmulated(const DeviceDescription& device);

/// Whether a precedes b in the order of GetDeviceNames() (Device.h).
bool IsBetter(const DeviceDescription& a, const DeviceDescription& b);

} // namespace deformvolume

#endif
