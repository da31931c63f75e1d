// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputVectors_h
#define DeformVolumeOutputVectors_h

#include "DeviceVectors.h"
#include "OpenCLContext.h"

#include <cstddef>
#include <memory>

namespace deformvolume
{

/// The destination of the vectors that a model computes, three floats each: host memory, or
/// DeviceVectors.
class OutputVectors
{
public:
  ///@{
  /// Set the destination. vectors must be on the device of the context.
  void Bind(const OpenCLContext& context, float* memory, std::size_t numberOfPoints);
  void Bind(const OpenCLContext& context, const std::shared_ptr<DeviceVectors>& vectors);
  ///@}
  bool IsSet() const { return this->Buffer() != nullptr; }

  /// The buffer to which kernels write.
  const cl::Buffer& GetBuffer() const { return this->Buffer; }
  /// The host memory to which the buffer must be read; null if the vectors stay on the device.
  float* GetHostMemory() const { return this->HostMemory; }
  /// The DeviceVectors in which writes must be recorded (MarkWritten); null if there are none.
  DeviceVectors::Internals* GetVectors() const
  {
    return this->Vectors ? &this->Vectors->GetInternals() : nullptr;
  }

private:
  cl::Buffer Buffer;
  float* HostMemory = nullptr;
  std::shared_ptr<DeviceVectors> Vectors;
};

} // namespace deformvolume

#endif
