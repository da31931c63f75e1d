// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorkDevice_h
#define DeformVolumeWorkDevice_h

#include "OpenCLContext.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

/// The device that work is done on, with the queues to it and the limits that the user has set.
class WorkDevice
{
public:
  /// From now on the device is that of a context. What belongs to another one is not forgotten
  /// here.
  void Use(OpenCLContext& context);
  bool Uses(const OpenCLContext& context) const { return this->Context == &context; }

  /// The best device is used where none was chosen.
  OpenCLContext& GetContext();
  const OpenCLDevice& GetDevice() { return this->GetContext().GetDevice(); }
  const cl::CommandQueue& GetQueue();
  /// A queue of its own for copies to the caller.
  const cl::CommandQueue& GetReadQueue();

  /// Bytes of one allocation at most: what the device allows, or less where a limit was set. 0: no
  /// limit.
  void SetAllocationLimit(std::uint64_t bytes) { this->AllocationLimit = bytes; }
  std::uint64_t GetAllocationLimit();

  /// Work-items in a work-group along the rows of the volume; 0: chosen by device.
  void SetWorkGroupSize(std::size_t size) { this->WorkGroupSize = size; }
  /// Whether one work-item does what a work-group has to do: it has the vector registers of a
  /// processor for itself, and no size is set.
  bool HasSerialGroups();
  /// Those that a kernel gets, as far as it can. wanted: where none were set.
  std::size_t GetGroupSize(const cl::Kernel& kernel, std::size_t wanted = 64);
  /// The same for a kernel whose work-groups have much to do: one where groups are serial.
  std::size_t GetBusyGroupSize(const cl::Kernel& kernel, std::size_t wanted = 64);

  /// Sends data, and waits until they are there. Returns the previous buffer where it has the size
  /// of the data, else a new one.
  cl::Buffer Send(const void* data, std::size_t bytes, const cl::Buffer& previous);

private:
  OpenCLContext* Context = nullptr;
  cl::CommandQueue Queue;
  cl::CommandQueue ReadQueue;
  std::uint64_t AllocationLimit = 0;
  std::size_t WorkGroupSize = 0;
};

} // namespace deformvolume

#endif
