// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceOutputInternals_h
#define DeformVolumeDeviceOutputInternals_h

#include "DeviceOutput.h"
#include "Extent.h"
#include "OpenCLContext.h"
#include "OutputFilling.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace deformvolume
{

/// The device buffer of a DeviceOutput, and the host memory to which it is copied.
class DeviceOutput::Internals
{
public:
  /// The values to copy: those of Part, with Bytes for each voxel. Voxels outside Part are already
  /// on the host. The buffer has all voxels of Whole.
  struct Voxels
  {
    Extent Whole;
    Extent Part;
    std::size_t Bytes;
  };

  /// The buffer must be complete, and must not be written before Download() has been called.
  /// background: the value for all of the memory if copying fails.
  Internals(const cl::CommandQueue& queue, const cl::Buffer& buffer, const Voxels& voxels,
    void* memory, const ElementBytes& background);

  bool IsOnDevice() const { return this->State == Location::Device; }
  bool IsRead() const { return this->State == Location::Host; }

  /// Copies the values to the host, unless they have been copied or dropped, and releases the
  /// buffer. Does not throw.
  void Download() noexcept;
  /// The message of a failure in Download(); empty if there was none.
  std::string GetMessage();
  /// See DeviceOutput::Drop().
  void Drop() noexcept;

  /// The memory on the device, in bytes.
  std::uint64_t GetMemory();

private:
  enum class Location
  {
    Device,
    Host,
    Nowhere // dropped, or lost
  };
  void Copy();
  void FillWithBackground() const;
  void LeaveDevice(Location location) noexcept;
  std::uint64_t GetBytes() const;

  std::mutex Mutex;
  std::atomic<Location> State{ Location::Device };
  cl::CommandQueue Queue;
  cl::Buffer Buffer;
  Voxels Values;
  char* Memory;
  ElementBytes Background;
  std::string Message;
};

/// The arrays of the last output that may still be on the device. Call Download() before their
/// buffers are written again.
class UnreadOutputs
{
public:
  /// ownBuffers: whether GetMemory() counts the buffers, because no other object counts them.
  void Set(const std::vector<std::shared_ptr<DeviceOutput>>& outputs, bool ownBuffers);
  /// Copies the arrays to the host. DeviceOutput::Read() reports a failure. Does not throw.
  void Download() noexcept;
  /// The device memory that no other object counts, in bytes.
  std::uint64_t GetMemory() const;

private:
  std::vector<std::weak_ptr<DeviceOutput::Internals>> Outputs;
  bool OwnBuffers = false;
};

} // namespace deformvolume

#endif
