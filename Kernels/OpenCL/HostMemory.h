// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeHostMemory_h
#define DeformVolumeHostMemory_h

#include "Extent.h"
#include "OpenCLContext.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace deformvolume
{

/// Bytes that were allocated for a buffer; 0 for none, and for one over memory of the host.
std::uint64_t GetMemory(const cl::Buffer& buffer);

/// Whether the kernels can work in memory of the host as it is: a processor can where it is aligned
/// for its elements, which is all that the kernels ask for.
bool CanWorkInPlace(const OpenCLContext& context, const void* data, std::size_t elementSize);

/// A buffer over memory of the host, which has to stay for as long as the buffer does.
cl::Buffer MakeBufferOver(
  const OpenCLContext& context, cl_mem_flags access, void* data, std::size_t bytes);

/// Memory of the host with the buffer over it. What commands do is undefined by OpenCL where they
/// work on several buffers over the same memory, even if they only read it: no two may overlap.
struct BufferInPlace
{
  const void* Data = nullptr;
  std::uint64_t Bytes = 0;
  cl::Buffer Buffer;

  bool Overlaps(const void* data, std::uint64_t bytes) const
  {
    const auto begin = reinterpret_cast<std::uintptr_t>(this->Data);
    const auto other = reinterpret_cast<std::uintptr_t>(data);
    return begin < other + bytes && other < begin + this->Bytes;
  }
  bool IsOver(const void* data, std::uint64_t bytes) const
  {
    return this->Data == data && this->Bytes == bytes;
  }
};

/// Tells the device that the host may have written to the memory that a buffer lies over, all of
/// it. Nothing that uses the buffer may be under way.
void TellOfWrites(
  const OpenCLContext& context, const cl::CommandQueue& queue, const BufferInPlace& place);

/// Throws an Error where a device gives no buffer of so many bytes.
void CheckAllocation(std::uint64_t bytes, std::uint64_t limit);

/// Makes a buffer of the device of so many bytes, where it is not one.
void Reserve(const OpenCLContext& context, cl::Buffer& buffer, std::uint64_t bytes);

/// Waits for a command. Returns OpenCL's error, or CL_SUCCESS.
cl_int WaitFor(cl_event event) noexcept;

/// A copy between a buffer and memory of the caller that is under way, or that Finish() makes. The
/// memory is left alone once the object is gone.
class PendingCopy
{
public:
  explicit PendingCopy(const cl::Event& event)
    : Event(event)
  {
  }
  /// finish: makes the copy, and returns OpenCL's error, or CL_SUCCESS.
  explicit PendingCopy(std::function<cl_int()> finish)
    : MakeCopy(std::move(finish))
  {
  }
  ~PendingCopy();
  PendingCopy(const PendingCopy&) = delete;
  PendingCopy& operator=(const PendingCopy&) = delete;
  PendingCopy(PendingCopy&&) noexcept = default;
  PendingCopy& operator=(PendingCopy&&) = delete;

  /// Returns when the copy is there, with OpenCL's error, or CL_SUCCESS.
  cl_int Finish();
  /// The same. Throws cl::Error where it has failed: what it was to copy is not there.
  void Check();

private:
  cl::Event Event;
  std::function<cl_int()> MakeCopy;
};

/// A buffer for an output: over the memory of the host where it goes, if the device can work there,
/// else one of the device. BeginToRead then copies it there. The copy is complete once it has been
/// checked; nothing may write to the buffer until then.
void Place(const OpenCLContext& context, cl::Buffer& buffer, void* memory, std::size_t elementSize,
  std::uint64_t bytes);
PendingCopy BeginToRead(
  const cl::CommandQueue& queue, const cl::Buffer& buffer, std::uint64_t bytes, void* memory);

///@{
/// The same for a part of a buffer that is not over the memory of the host: of some bytes from an
/// offset on, or of a box. bytes: of a voxel; whole: the voxels that are in the buffer; held: those
/// that there is room for in the memory.
PendingCopy BeginToReadRange(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  std::uint64_t offset, std::uint64_t bytes, void* memory);
PendingCopy BeginToReadBox(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const Extent& whole, const Extent& part, std::size_t bytes, void* memory, const Extent& held);
///@}

/// Copies to a buffer from an offset on, after all that is in the queue, and returns when that is
/// done.
void Write(const cl::CommandQueue& queue, const cl::Buffer& buffer, std::uint64_t offset,
  std::uint64_t bytes, const void* data);

/// The same, but it may return before the copy has ended: data has to stay until then.
PendingCopy BeginToWrite(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  std::uint64_t offset, std::uint64_t bytes, const void* data);

/// The same as Write for a box, with parameters as those of BeginToReadBox.
void WriteBox(const cl::CommandQueue& queue, const cl::Buffer& buffer, const Extent& whole,
  const Extent& part, std::size_t bytes, const void* memory, const Extent& held);

/// Several pending copies.
class PendingCopies
{
public:
  void Add(PendingCopy copy) { this->Copies.push_back(std::move(copy)); }
  /// Returns when all of them are there, and forgets them. Throws cl::Error where one has failed:
  /// what it was to copy is not there.
  void Check();
  /// Forgets them where that does not matter any more.
  void Drop() { this->Copies.clear(); }

private:
  std::vector<PendingCopy> Copies;
};

/// Waits for a queue, however a scope is left: before memory of the caller, or buffers that are
/// declared before, are gone. (To release a buffer while launches that use it are queued crashes
/// PoCL 3.1.)
class QueueGuard
{
public:
  explicit QueueGuard(const cl::CommandQueue& queue)
    : Queue(queue)
  {
  }
  ~QueueGuard() { clFinish(this->Queue()); }
  QueueGuard(const QueueGuard&) = delete;
  QueueGuard& operator=(const QueueGuard&) = delete;

private:
  cl::CommandQueue Queue;
};

/// Whether a buffer lies over memory of the host.
bool IsInPlace(const cl::Buffer& buffer);

/// A buffer as the host sees it, for the life of this object: waits for all that was enqueued
/// before. For processors: elsewhere the whole buffer is copied.
template <typename T>
class MappedBuffer
{
public:
  MappedBuffer(const cl::CommandQueue& queue, const cl::Buffer& buffer, cl_map_flags access)
    : Queue(queue)
    , Buffer(buffer)
    , Mapped(queue.enqueueMapBuffer(buffer, CL_TRUE, access, 0, buffer.getInfo<CL_MEM_SIZE>()))
  {
  }
  ~MappedBuffer()
  {
    // clEnqueueUnmapMemObject as such: an exception must not leave a destructor.
    clEnqueueUnmapMemObject(this->Queue(), this->Buffer(), this->Mapped, 0, nullptr, nullptr);
    clFinish(this->Queue());
  }
  MappedBuffer(const MappedBuffer&) = delete;
  MappedBuffer& operator=(const MappedBuffer&) = delete;

  T* Get() const { return static_cast<T*>(this->Mapped); }

private:
  cl::CommandQueue Queue;
  cl::Buffer Buffer;
  void* Mapped;
};

} // namespace deformvolume

#endif
