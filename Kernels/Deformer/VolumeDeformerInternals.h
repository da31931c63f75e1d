// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeDeformerInternals_h
#define DeformVolumeVolumeDeformerInternals_h

#include "GuardedCall.h"
#include "MemoryBudget.h"
#include "VolumeDeformation.h"
#include "VolumeDeformer.h"
#include "WorkDevice.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

namespace deformvolume
{

/// The device of a VolumeDeformer, what is on it, and how that is called.
class VolumeDeformer::Internals
{
public:
  Internals();

  /// As CallGuarded does. After an error of OpenCL the volume is forgotten.
  template <typename Function>
  auto Guard(Function&& function)
  {
    return CallGuarded(function, [this] { this->Forget(); });
  }

  /// Like Guard, for functions that send data to the volume: their time belongs to the next
  /// deformation.
  template <typename Function>
  void Send(Function&& function)
  {
    const auto begin = std::chrono::steady_clock::now();
    this->Guard([&] { function(this->GetVolume()); });
    this->SendingTime +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  /// The time since this was asked last, in seconds.
  double TakeSendingTime();

  /// A change of device forgets the volume.
  void SelectDevice(const std::string& request);
  WorkDevice& GetDevice() { return this->Device; }
  MemoryBudget& GetBudget() { return this->Budget; }

  /// Another volume in place of the one before.
  void SetVolume(const VoxelGrid& voxelGrid, std::size_t bytesPerVoxel, bool withLinks);
  /// Throws an Error where none is set.
  VolumeDeformation& GetVolume() const;
  void Forget();

  /// Bytes allocated on the device.
  std::uint64_t GetMemory() const { return this->Volume ? this->Volume->GetMemory() : 0; }

private:
  WorkDevice Device;
  MemoryBudget Budget;
  std::unique_ptr<VolumeDeformation> Volume;
  double SendingTime = 0.0;
};

} // namespace deformvolume

#endif
