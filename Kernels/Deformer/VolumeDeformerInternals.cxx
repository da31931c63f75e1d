// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeDeformerInternals.h"

namespace deformvolume
{

VolumeDeformer::Internals::Internals()
  : Budget(this->Device, [this] { return this->GetMemory(); })
{
}

double VolumeDeformer::Internals::TakeSendingTime()
{
  const double seconds = this->SendingTime;
  this->SendingTime = 0.0;
  return seconds;
}

void VolumeDeformer::Internals::SelectDevice(const std::string& request)
{
  OpenCLContext& context = OpenCLContext::Get(FindDevice(request));
  if (!this->Device.Uses(context))
  {
    this->Forget();
    this->Device.Use(context);
  }
}

void VolumeDeformer::Internals::SetVolume(
  const VoxelGrid& voxelGrid, std::size_t bytesPerVoxel, bool withLinks)
{
  this->Forget(); // its memory is free for the next one
  this->Volume = std::make_unique<VolumeDeformation>(
    this->Device, this->Budget, voxelGrid, bytesPerVoxel, withLinks);
}

void VolumeDeformer::Internals::Forget()
{
  if (this->Volume)
  {
    this->Volume->BringOutput(); // or it would keep its memory of the device
    this->Volume.reset();
  }
}

VolumeDeformation& VolumeDeformer::Internals::GetVolume() const
{
  if (!this->Volume)
  {
    throw Error("No volume is set: call SetVoxelGrid first.");
  }
  return *this->Volume;
}

} // namespace deformvolume
