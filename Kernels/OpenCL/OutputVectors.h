// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputVectors_h
#define DeformVolumeOutputVectors_h

#include "DeviceVectors.h"
#include "OpenCLContext.h"

#include <cstddef>
#include <memory>

namespace deformvolume
{

/// Where a model writes vectors, three floats each: memory of the host, which a processor works in,
/// or vectors on the device.
class OutputVectors
{
public:
  ///@{
  /// vectors: on the device of the context.
  void Place(const OpenCLContext& context, float* memory, std::size_t numberOfPoints);
  void Place(const OpenCLContext& context, const std::shared_ptr<DeviceVectors>& vectors);
  ///@}
  bool IsPlaced() const { return this->Buffer() != nullptr; }

  /// What kernels write to.
  const cl::Buffer& GetBuffer() const { return this->Buffer; }
  /// Where it is to be brought then; null where it stays on the device.
  float* GetHostMemory() const { return this->HostMemory; }
  /// Those that have to be told what has been written; null where there are none.
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
