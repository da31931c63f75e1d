// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStagedCopies_h
#define DeformVolumeStagedCopies_h

#include "CopiedBox.h"
#include "OpenCLContext.h"

#include <array>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>

namespace deformvolume
{

/// Copies between a device with memory of its own and any memory of the host, in portions that go
/// through a few slots of page-locked memory. Drivers move other memory at a fraction of what the
/// bus can do. While some portions are on the bus, threads copy others between the slots and the
/// memory of the caller.
///
/// Threads are there as long as copies are under way. May be used by many threads at once. The
/// slots are memory of the host, and of the process: they are no part of what an object holds on
/// the device, and what the system has left is measured without them (MemoryBudget).
class StagedCopies
{
public:
  static constexpr std::size_t NumberOfSlots = 4;
  static constexpr std::size_t SlotBytes = std::size_t{ 1 } << 21;
  /// Smaller copies gain nothing.
  static constexpr std::size_t LeastBytes = std::size_t{ 1 } << 16;

  /// Null where the driver gives no page-locked memory.
  static std::unique_ptr<StagedCopies> Make(const cl::Context& context, const cl::Device& device);

  StagedCopies(const StagedCopies&) = delete;
  StagedCopies& operator=(const StagedCopies&) = delete;

  class Copy;

  /// Begins to copy from a buffer, after all that is in the queue. Wait has to be called: the
  /// memory is not left alone before, and nothing may write to this part of the buffer.
  std::shared_ptr<Copy> BeginToRead(
    const cl::CommandQueue& queue, const cl::Buffer& buffer, const CopiedBox& box, void* memory);
  /// Returns OpenCL's error, or CL_SUCCESS.
  cl_int Wait(const Copy& copy) noexcept;

  /// Copies to a buffer, after all that is in the queue, and returns when that is done. Returns
  /// OpenCL's error, or CL_SUCCESS.
  cl_int Write(const cl::CommandQueue& queue, const cl::Buffer& buffer, const CopiedBox& box,
    const void* memory);

private:
  struct Portion;
  struct Worker
  {
    std::thread Thread;
    bool IsDone = false; // and has only to be joined
  };

  StagedCopies(const cl::CommandQueue& queue, const cl::Buffer& pinned, char* slots);

  /// Starts as many threads as a copy is worth; helps: the calling thread works on it, too.
  /// False: there is no other thread to do so, and it has to.
  bool Begin(const std::shared_ptr<Copy>& copy, bool helps);
  bool StartThread(Copy& copy, Worker& worker);
  /// The next portion of a copy has been taken.
  void MarkTaken(Copy& copy);
  void Forget(const Copy& copy);
  /// Takes the next portion of a copy; null: of the first one that has some. False: there is none.
  bool Take(const Copy* only, Portion& portion);
  /// Copies portions, of one copy or of all, until there are none left. first: one that has been
  /// taken, or null. worker: null for other threads.
  void Work(const Copy* only, const Portion* first, Worker* worker) noexcept;
  void Finish(const Portion& portion, cl_int error);

  cl::CommandQueue Queue;
  cl::Buffer Pinned;
  std::size_t MostThreads;

  std::mutex Mutex; // guards all that follows
  std::condition_variable Changed;
  std::deque<std::shared_ptr<Copy>> Copies; // with portions that nobody has taken
  std::array<char*, NumberOfSlots> FreeSlots;
  std::size_t NumberOfFreeSlots = 0;
  std::array<Worker, NumberOfSlots> Workers;
  std::size_t NumberAtWork = 0; // of these, and of threads that write
};

} // namespace deformvolume

#endif
