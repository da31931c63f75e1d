// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStagedCopies_h
#define DeformVolumeStagedCopies_h

#include "CopiedBox.h"
#include "OpenCLContext.h"

#include <cstddef>
#include <memory>
#include <mutex>

namespace deformvolume
{

/// Copies between a device with memory of its own and any memory of the host, in portions that go
/// through double buffers of page-locked memory: drivers move other memory at a fraction of what
/// the bus can do. While one half is on the bus, the other is copied to or from the memory of the
/// caller. One thread copies on the host at a fraction of the speed of the bus, too, so that
/// several work on a large copy, each with a double buffer of its own.
///
/// May be used by many threads; a copy waits until those of others have ended. The buffers are
/// memory of the host, and of the process: it is no part of what an object holds on the device, and
/// what the system has left is measured without it (MemoryBudget).
class StagedCopies
{
public:
  static constexpr std::size_t HalfBytes = std::size_t{ 1 } << 20;
  static constexpr std::size_t MostThreads = 8;
  static constexpr std::size_t PortionsWorthAThread = 2;
  /// Smaller copies gain nothing.
  static constexpr std::size_t LeastBytes = std::size_t{ 1 } << 16;

  /// Null where the driver gives no page-locked memory.
  static std::unique_ptr<StagedCopies> Make(const cl::Context& context, const cl::Device& device);

  ///@{
  /// Copies from a buffer, or to one, after all that is in the queue, and returns when that is
  /// done. Returns OpenCL's error, or CL_SUCCESS.
  cl_int Read(const cl::CommandQueue& queue, const cl::Buffer& buffer, const CopiedBox& box,
    void* memory) noexcept;
  cl_int Write(const cl::CommandQueue& queue, const cl::Buffer& buffer, const CopiedBox& box,
    const void* memory) noexcept;
  ///@}

private:
  StagedCopies(const cl::CommandQueue& queue, const cl::Buffer& pinned, char* memory)
    : Queue(queue)
    , Pinned(pinned)
    , Memory(memory)
  {
  }

  cl_int Copy(const cl::CommandQueue& queue, const cl::Buffer& buffer, const CopiedBox& box,
    void* memory, bool reads) noexcept;

  cl::CommandQueue Queue;
  cl::Buffer Pinned;
  char* Memory; // two halves for each thread
  std::mutex Mutex;
};

} // namespace deformvolume

#endif
