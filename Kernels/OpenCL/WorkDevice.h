// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorkDevice_h
#define DeformVolumeWorkDevice_h

#include "OpenCLContext.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace deformvolume
{

/// The device of an object, with its command queues and with the limits that the user has set.
class WorkDevice
{
public:
  /// Set the device to that of a context. The caller must release what it holds on the previous
  /// device.
  void Use(OpenCLContext& context);
  /// Sets the device of a request (FindDevice()), and returns its name. release: called if the
  /// device changes, to release what the caller holds on the previous device.
  const std::string& Choose(const std::string& request, const std::function<void()>& release);
  bool Uses(const OpenCLContext& context) const { return this->Context == &context; }

  /// Returns the context of the device. If none has been set, sets that of the default device.
  OpenCLContext& GetContext();
  const OpenCLDevice& GetDevice() { return this->GetContext().GetDevice(); }
  const cl::CommandQueue& GetQueue();
  /// A separate queue for copies to the host.
  const cl::CommandQueue& GetReadQueue();

  /// Set the largest number of bytes of one allocation. 0: the limit of the device, which always
  /// applies.
  void SetAllocationLimit(std::uint64_t bytes) { this->AllocationLimit = bytes; }
  std::uint64_t GetAllocationLimit();

  /// Set the number of work-items in a work-group, along the rows of the volume. 0: each kernel has
  /// a default, see GetGroupSize().
  void SetWorkGroupSize(std::size_t size) { this->WorkGroupSize = size; }
  /// Whether kernels with heavy work-groups have one work-item per group: on CPUs whose work-items
  /// can use all vector registers, unless a size is set.
  bool HasSerialGroups();
  /// Returns the size of the work-groups of a kernel: the size that is set, or `wanted` if none is
  /// set, but at most the largest size that the kernel allows.
  std::size_t GetGroupSize(const cl::Kernel& kernel, std::size_t wanted = 64);
  /// Returns the size of the work-groups of a kernel with heavy work-groups: 1 if
  /// HasSerialGroups(), otherwise GetGroupSize().
  std::size_t GetHeavyGroupSize(const cl::Kernel& kernel, std::size_t wanted = 64);

  /// Enqueues a kernel for at least `items` work-items, in work-groups of GetGroupSize(). The
  /// kernel must ignore the work-items beyond `items`.
  cl::Event Launch(const cl::Kernel& kernel, std::size_t items);

  ///@{
  /// Copies data to a buffer on the device, and returns when the copy is complete. A buffer of
  /// another size is replaced.
  void Send(cl::Buffer& buffer, const void* data, std::size_t bytes);
  template <typename T>
  void Send(cl::Buffer& buffer, const std::vector<T>& values)
  {
    this->Send(buffer, values.data(), values.size() * sizeof(T));
  }
  ///@}

private:
  OpenCLContext* Context = nullptr;
  cl::CommandQueue Queue;
  cl::CommandQueue ReadQueue;
  std::uint64_t AllocationLimit = 0;
  std::size_t WorkGroupSize = 0;
};

} // namespace deformvolume

#endif
