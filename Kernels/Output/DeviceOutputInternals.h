// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceOutputInternals_h
#define DeformVolumeDeviceOutputInternals_h

#include "DeviceOutput.h"
#include "ElementType.h"
#include "Extent.h"
#include "OpenCLContext.h"
#include "OutputFilling.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace deformvolume
{

/// What a DeviceOutput is about, as the deformer sees it.
class DeviceOutput::Internals
{
public:
  /// What there is to copy: of the voxels of an output, with so many bytes each, a part. The others
  /// are there. The buffer has all of them.
  struct Voxels
  {
    Extent Whole;
    Extent Part;
    ElementType Type;
    std::size_t Bytes;
  };

  /// The buffer is written, and nobody writes to it before Bring() was called. background: what all
  /// of the memory gets where the values cannot be copied.
  Internals(const cl::CommandQueue& queue, const cl::Buffer& buffer, const Voxels& voxels,
    void* memory, const ElementBytes& background);

  bool IsOnDevice() const { return this->State == Place::Device; }
  bool IsRead() const { return this->State == Place::Host; }

  /// Brings the values to the memory, unless that is done, and lets go of the buffer. Throws
  /// nothing.
  void Bring() noexcept;
  /// What went wrong then; "" where nothing did.
  std::string GetMessage();
  /// Nobody wants the values, and the memory may go. Waits for a copy that is under way.
  void Drop() noexcept;

  /// See DeviceOutput.
  std::optional<Range> FindRange(int component);

  /// Bytes of the device.
  std::uint64_t GetMemory();

private:
  enum class Place
  {
    Device,
    Host,
    Nowhere // dropped, or lost
  };
  void Copy();
  void FillWithBackground() const;
  void LeaveDevice(Place place) noexcept;
  std::uint64_t GetBytes() const;

  std::mutex Mutex;
  std::atomic<Place> State{ Place::Device };
  cl::CommandQueue Queue;
  cl::Buffer Buffer;
  Voxels Values;
  char* Memory;
  ElementBytes Background;
  std::string Message;
};

/// The arrays of the last output that may still be on the device. What can still be read of them
/// has to be brought to the host before their buffers are written again.
class UnreadOutputs
{
public:
  /// ownBuffers: whether nobody else counts the memory of these.
  void Set(const std::vector<std::shared_ptr<DeviceOutput>>& outputs, bool ownBuffers);
  /// Failures are told to those who read. Throws nothing.
  void Bring() noexcept;
  /// Bytes of the device that nobody else counts.
  std::uint64_t GetMemory() const;

private:
  std::vector<std::weak_ptr<DeviceOutput::Internals>> Outputs;
  bool OwnBuffers = false;
};

} // namespace deformvolume

#endif
