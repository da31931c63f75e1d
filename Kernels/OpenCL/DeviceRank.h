// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceRank_h
#define DeformVolumeDeviceRank_h

#include <string>

namespace deformvolume
{

/// What a driver says of a device.
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
  /// The device has no memory of its own: it works in that of the processor.
  bool SharesMemory = false;
  bool HasDouble = true;
  unsigned int ComputeUnits = 1;
};

/// In small letters: names of devices are compared so.
std::string ToLower(std::string text);

/// Whether the device is emulated on the processor, by a renderer that is software or by an
/// interpreter: slower than a driver for processors, whatever type and size the driver states.
bool IsEmulated(const DeviceDescription& device);

/// Whether a comes before b, by the rule of GetDeviceNames() (Device.h).
bool IsBetter(const DeviceDescription& a, const DeviceDescription& b);

} // namespace deformvolume

#endif
