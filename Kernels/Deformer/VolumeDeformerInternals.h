// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeDeformerInternals_h
#define DeformVolumeVolumeDeformerInternals_h

#include "Error.h"
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

  /// Runs a function, with floating-point traps off and OpenCL's errors put into words.
  template <typename Function>
  auto Guard(Function&& function)
  {
    const FloatingPointTrapGuard guard;
    try
    {
      return function();
    }
    catch (const cl::Error& error)
    {
      this->Forget(); // what is on the device may be half done
      throw Error(GetMessage(error));
    }
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
  void Forget() { this->Volume.reset(); }

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
