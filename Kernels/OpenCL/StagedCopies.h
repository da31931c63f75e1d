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

/// Enqueues a copy of a box from a buffer to memory (`reads`) or from memory to a buffer. done: set
/// to the event of the copy. Returns the OpenCL error code, or CL_SUCCESS.
cl_int EnqueueCopy(cl_command_queue queue, cl_mem buffer, const CopiedBox& box, void* memory,
  bool reads, cl_event* done) noexcept;

/// Copies between any host memory and a device with memory of its own, in portions through double
/// buffers of page-locked (pinned) memory. Drivers copy pageable memory at a fraction of the speed
/// of the bus. While the bus transfers one half of a double buffer, the host copies the other half
/// to or from the memory of the caller. One thread copies at a fraction of the speed of the bus, so
/// several threads work on a large copy, each with a double buffer of its own.
///
/// Thread-safe: a copy waits until the copies of other threads have ended. The buffers belong to
/// the process. MemoryBudget does not count them as memory on the device.
class StagedCopies
{
public:
  static constexpr std::size_t HalfBytes = std::size_t{ 1 } << 20;
  static constexpr std::size_t MostThreads = 8;
  static constexpr std::size_t LeastPortionsPerThread = 2;
  /// Staging does not make smaller copies faster.
  static constexpr std::size_t LeastBytes = std::size_t{ 1 } << 16;

  /// Returns null if the driver provides no page-locked memory.
  static std::unique_ptr<StagedCopies> Make(const cl::Context& context, const cl::Device& device);

  /// Copies a box from a buffer to memory (`reads`) or from memory to a buffer, after all previous
  /// commands of the queue, and returns when the copy is complete. Returns the OpenCL error code,
  /// or CL_SUCCESS.
  cl_int Copy(const cl::CommandQueue& queue, const cl::Buffer& buffer, const CopiedBox& box,
    void* memory, bool reads) noexcept;

private:
  StagedCopies(const cl::CommandQueue& queue, const cl::Buffer& pinned, char* memory)
    : Queue(queue)
    , Pinned(pinned)
    , Memory(memory)
  {
  }

  cl::CommandQueue Queue;
  cl::Buffer Pinned;
  char* Memory; // two halves for each thread
  std::mutex Mutex;
};

} // namespace deformvolume

#endif
