// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceVectorsInternals_h
#define DeformVolumeDeviceVectorsInternals_h

#include "DeviceVectors.h"
#include "RangeLog.h"
#include "WorkDevice.h"

#include <vector>

namespace deformvolume
{

/// Access to DeviceVectors for classes that work on the device. Functions throw cl::Error.
class DeviceVectors::Internals
{
public:
  Internals(OpenCLContext& context, std::size_t numberOfPoints);

  bool IsOn(const OpenCLContext& context) const { return this->Device.Uses(context); }
  WorkDevice& GetWorkDevice() { return this->Device; }
  const std::string& GetDevice() { return this->Device.GetDevice().Name; }
  std::size_t GetNumberOfPoints() const { return this->NumberOfPoints; }
  bool AreInHostMemory() const { return !this->Buffer(); }

  /// The device buffer; null if the vectors are in host memory. Commands that use the buffer must
  /// end before another object uses the vectors.
  const cl::Buffer& GetBuffer() const { return this->Buffer; }
  /// The vectors in host memory, if AreInHostMemory().
  float* GetHostMemory() { return this->Host.data(); }
  /// Records that the vectors of some points, or of all, have been written in either memory.
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
  std::vector<float> Host; // on a device with memory of its own: empty until the first Read()
  std::uint64_t HostRevision = 0;
  RangeLog Log;
};

/// Throws Error if the vectors are null, have another number of points or are on another device.
void CheckVectors(DeviceVectors* vectors, WorkDevice& device, std::size_t numberOfPoints);

} // namespace deformvolume

#endif
