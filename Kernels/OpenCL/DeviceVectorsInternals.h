// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceVectorsInternals_h
#define DeformVolumeDeviceVectorsInternals_h

#include "DeviceVectors.h"
#include "RangeLog.h"
#include "WorkDevice.h"

#include <vector>

namespace deformvolume
{

/// DeviceVectors as objects see them that work on the device. cl::Error is thrown.
class DeviceVectors::Internals
{
public:
  Internals(OpenCLContext& context, std::size_t numberOfPoints);

  bool IsOn(const OpenCLContext& context) const { return this->Device.Uses(context); }
  WorkDevice& GetWorkDevice() { return this->Device; }
  const std::string& GetDevice() { return this->Device.GetDevice().Name; }
  std::size_t GetNumberOfPoints() const { return this->NumberOfPoints; }
  bool AreInHostMemory() const { return !this->Buffer(); }

  /// The memory of the device, where it has its own. What is done with it ends before somebody else
  /// uses the vectors.
  const cl::Buffer& GetBuffer() const { return this->Buffer; }
  /// The memory of the host, where the device has none of its own.
  float* GetHostMemory() { return this->Host.data(); }
  /// Some, or all, vectors have been written there.
  void MarkWritten(const PointRanges& ranges) { this->Log.Add(ranges); }
  void MarkAllWritten() { this->Log.AddAll(); }

  void Write(const float* vectors);
  void Write(const float* vectors, const PointRanges& written);
  const float* Read();
  const RangeLog& GetLog() const { return this->Log; }

private:
  WorkDevice Device;
  std::size_t NumberOfPoints;
  cl::Buffer Buffer;
  std::vector<float> Host; // empty on a device with memory of its own until it is wanted
  std::uint64_t HostRevision = 0;
  RangeLog Log;
};

/// Throws an Error where they are null, or not so many vectors, or on another device.
void CheckVectors(DeviceVectors* vectors, WorkDevice& device, std::size_t numberOfPoints);

} // namespace deformvolume

#endif
