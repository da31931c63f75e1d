// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceOutputInternals_h
#define DeformVolumeDeviceOutputInternals_h

#include "DeviceOutput.h"
#include "OpenCLContext.h"
#include "OutputFilling.h"

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace deformvolume
{

/// What a DeviceOutput is about, as the deformer sees it.
class DeviceOutput::Internals
{
public:
  /// The buffer, of which so many bytes are the values, is written, and nobody writes to it before
  /// Bring() was called. background: what the memory gets where the values cannot be copied.
  Internals(const cl::CommandQueue& queue, const cl::Buffer& buffer, std::uint64_t bytes,
    void* memory, const ElementBytes& background);

  bool IsRead() const { return this->IsThere.load(std::memory_order_acquire); }

  /// Brings the values to the memory, unless that is done, and lets go of the buffer. Throws
  /// nothing.
  void Bring() noexcept;
  /// What went wrong then; "" where nothing did.
  std::string GetMessage();
  /// Nobody wants the values, and the memory may go. Waits for a copy that is under way.
  void Leave() noexcept;

  /// Bytes of the device.
  std::uint64_t GetMemory();

private:
  void Copy();
  void FillWithBackground() const;

  std::mutex Mutex;
  std::atomic<bool> IsThere{ false };
  cl::CommandQueue Queue;
  cl::Buffer Buffer; // none once it is read or left
  std::uint64_t Bytes;
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
