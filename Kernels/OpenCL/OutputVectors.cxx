// SPDX-License-Identifier: BSD-3-Clause
#include "OutputVectors.h"

#include "DeviceVectorsInternals.h"
#include "HostMemory.h"

namespace deformvolume
{

void OutputVectors::Bind(const OpenCLContext& context, float* memory, std::size_t numberOfPoints)
{
  this->Vectors.reset();
  this->HostMemory = nullptr;
  deformvolume::Bind(
    context, this->Buffer, memory, sizeof(float), numberOfPoints * 3 * sizeof(float));
  this->HostMemory = memory;
}

void OutputVectors::Bind(
  const OpenCLContext& context, const std::shared_ptr<DeviceVectors>& vectors)
{
  DeviceVectors::Internals& internals = vectors->GetInternals();
  if (internals.AreInHostMemory())
  {
    this->Bind(context, internals.GetHostMemory(), internals.GetNumberOfPoints());
  }
  else
  {
    this->HostMemory = nullptr;
    this->Buffer = internals.GetBuffer();
  }
  this->Vectors = vectors;
}

} // namespace deformvolume
