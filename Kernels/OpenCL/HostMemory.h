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

/// Returns the bytes allocated for a buffer. 0 if it is null or uses host memory
/// (CL_MEM_USE_HOST_PTR).
std::uint64_t GetMemory(const cl::Buffer& buffer);
/// Returns the sum for several buffers.
template <typename... Buffers>
std::uint64_t GetMemory(const cl::Buffer& first, const cl::Buffer& second, const Buffers&... others)
{
  return ((GetMemory(first) + GetMemory(second)) + ... + GetMemory(others));
}

/// Whether kernels can work directly in host memory: on a CPU device, if the memory is aligned for
/// its elements. The kernels need no larger alignment.
bool CanWorkInPlace(const OpenCLContext& context, const void* data, std::size_t elementSize);

/// Makes a buffer that uses host memory (CL_MEM_USE_HOST_PTR). The memory must outlive the buffer.
cl::Buffer MakeBufferOver(
  const OpenCLContext& context, cl_mem_flags access, void* data, std::size_t bytes);

/// Host memory with the buffer that uses it. No two such buffers may overlap: OpenCL leaves
/// commands on buffers that use the same memory undefined, even if they only read it.
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

/// Updates a buffer after the host may have written to its memory. Does nothing on drivers that
/// work in that memory (OpenCLContext::SharesHostMemory()). No command that uses the buffer may be
/// running.
void UpdateFromHost(
  const OpenCLContext& context, const cl::CommandQueue& queue, const BufferInPlace& inPlace);

/// Throws Error if a buffer of `bytes` exceeds the allocation limit of the device. owners: what
/// needs the buffer, in the plural. remedy: what to do, except for using another device.
void CheckAllocation(
  std::uint64_t bytes, std::uint64_t limit, const char* owners, const char* remedy);

/// Replaces a buffer by a device buffer of `bytes`, unless it already has this size.
void Reserve(const OpenCLContext& context, cl::Buffer& buffer, std::uint64_t bytes);

/// Waits for a command. Returns its OpenCL error code, or CL_SUCCESS.
cl_int WaitFor(cl_event event) noexcept;

/// A copy between a buffer and memory of the caller. The copy is in progress, or is made by
/// Finish(). After the destructor the copy no longer accesses the memory.
class PendingCopy
{
public:
  explicit PendingCopy(const cl::Event& event)
    : Event(event)
  {
  }
  /// finish() makes the copy, and returns its OpenCL error code, or CL_SUCCESS.
  explicit PendingCopy(std::function<cl_int()> finish)
    : MakeCopy(std::move(finish))
  {
  }
  ~PendingCopy();
  PendingCopy(const PendingCopy&) = delete;
  PendingCopy& operator=(const PendingCopy&) = delete;
  PendingCopy(PendingCopy&&) noexcept = default;
  PendingCopy& operator=(PendingCopy&&) = delete;

  /// Completes the copy. Returns its OpenCL error code, or CL_SUCCESS.
  cl_int Finish();
  /// Completes the copy. Throws cl::Error if it has failed: its destination is then undefined.
  void Check();

private:
  cl::Event Event;
  std::function<cl_int()> MakeCopy;
};

/// Makes a buffer for an output. If CanWorkInPlace(), the buffer uses the host memory of the
/// output; otherwise it is a device buffer. In both cases, BeginToRead() brings the output to the
/// host. The output is complete after PendingCopy::Check(); until then, no command may write to the
/// buffer.
void Bind(const OpenCLContext& context, cl::Buffer& buffer, void* memory, std::size_t elementSize,
  std::uint64_t bytes);
PendingCopy BeginToRead(
  const cl::CommandQueue& queue, const cl::Buffer& buffer, std::uint64_t bytes, void* memory);

///@{
/// Begins to read a part of a device buffer: a range of bytes, or a box of voxels. For a box,
/// bytes: size of a voxel; whole: extent of the buffer; part: extent to copy; held: extent of the
/// host memory.
PendingCopy BeginToReadRange(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  std::uint64_t offset, std::uint64_t bytes, void* memory);
PendingCopy BeginToReadBox(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const Extent& whole, const Extent& part, std::size_t bytes, void* memory, const Extent& held);
///@}

/// Copies data to a buffer, after all previous commands of the queue, and returns when the copy is
/// complete. offset: of the first byte in the buffer.
void Write(const cl::CommandQueue& queue, const cl::Buffer& buffer, std::uint64_t offset,
  std::uint64_t bytes, const void* data);

/// Begins a copy to a buffer. It may return before the copy is complete: `data` must stay valid and
/// unchanged until PendingCopy::Check().
PendingCopy BeginToWrite(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  std::uint64_t offset, std::uint64_t bytes, const void* data);

/// Copies a box of voxels to a buffer, and returns when the copy is complete. Parameters as in
/// BeginToReadBox().
void WriteBox(const cl::CommandQueue& queue, const cl::Buffer& buffer, const Extent& whole,
  const Extent& part, std::size_t bytes, const void* memory, const Extent& held);

/// Several pending copies.
class PendingCopies
{
public:
  void Add(PendingCopy copy) { this->Copies.push_back(std::move(copy)); }
  /// Completes and removes all copies. Throws cl::Error if one has failed: its destination is then
  /// undefined.
  void Check();
  /// Removes all copies without a check.
  void Drop() { this->Copies.clear(); }

private:
  std::vector<PendingCopy> Copies;
};

/// Waits for a queue at the end of a scope, also after an exception. Commands then no longer use
/// memory of the caller or buffers that were declared before. (PoCL 3.1 crashes when a buffer is
/// released while a queued launch uses it.)
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

/// Whether a buffer uses host memory (CL_MEM_USE_HOST_PTR).
bool IsInPlace(const cl::Buffer& buffer);

/// Maps a buffer for the lifetime of the object, after all previous commands of the queue. Use it
/// on CPU devices only: other devices copy the whole buffer.
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
    // The C function, since the C++ function may throw.
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
