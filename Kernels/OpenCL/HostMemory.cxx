// SPDX-License-Identifier: BSD-3-Clause
#include "HostMemory.h"

#include "Error.h"
#include "StagedCopies.h"

#include <utility>

namespace deformvolume
{
namespace
{

/// Returns null for small copies, and on devices without staged copies: then the driver copies.
StagedCopies* FindStagedCopies(const cl::CommandQueue& queue, std::uint64_t bytes)
{
  OpenCLContext* const context =
    bytes >= StagedCopies::LeastBytes ? OpenCLContext::Find(queue) : nullptr;
  return context ? context->GetStagedCopies() : nullptr;
}

CopiedBox MakeBox(const Extent& whole, const Extent& part, std::size_t bytes, const Extent& held)
{
  const auto locate = [&](const Extent& extent)
  {
    const std::size_t row = bytes * static_cast<std::size_t>(GetSize(extent, 0));
    CopiedBox::Location result{ {}, row, row * static_cast<std::size_t>(GetSize(extent, 1)) };
    for (int axis = 0; axis < 3; ++axis)
    {
      result.Origin[axis] =
        (axis == 0 ? bytes : 1) * static_cast<std::size_t>(part[2 * axis] - extent[2 * axis]);
    }
    return result;
  };
  const auto size = [&](int axis) { return static_cast<std::size_t>(GetSize(part, axis)); };
  return { { { bytes * size(0), size(1), size(2) } }, locate(whole), locate(held) };
}

void Check(cl_int error)
{
  if (error != CL_SUCCESS)
  {
    throw cl::Error(error, "copying to or from the device");
  }
}

// Begins to copy a box from a buffer to memory (reads), or from memory to a buffer.
PendingCopy BeginToCopy(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const CopiedBox& box, void* memory, bool reads)
{
  StagedCopies* const staged = FindStagedCopies(queue, box.GetBytes());
  if (staged && reads)
  {
    return PendingCopy([=] { return staged->Copy(queue, buffer, box, memory, true); });
  }
  // The next commands of the queue may use the buffer, so a staged copy to it is made at once.
  cl_event done = nullptr;
  Check(staged ? staged->Copy(queue, buffer, box, memory, false)
               : EnqueueCopy(queue(), buffer(), box, memory, reads, &done));
  return PendingCopy(cl::Event(done));
}

} // namespace

std::uint64_t GetMemory(const cl::Buffer& buffer)
{
  return buffer() && !(buffer.getInfo<CL_MEM_FLAGS>() & CL_MEM_USE_HOST_PTR)
    ? buffer.getInfo<CL_MEM_SIZE>()
    : 0;
}

bool CanWorkInPlace(const OpenCLContext& context, const void* data, std::size_t elementSize)
{
  return context.GetDevice().IsProcessor &&
    reinterpret_cast<std::uintptr_t>(data) % elementSize == 0;
}

cl::Buffer MakeBufferOver(
  const OpenCLContext& context, cl_mem_flags access, void* data, std::size_t bytes)
{
  return cl::Buffer(context.GetContext(), access | CL_MEM_USE_HOST_PTR, bytes, data);
}

void UpdateFromHost(
  const OpenCLContext& context, const cl::CommandQueue& queue, const BufferInPlace& inPlace)
{
  if (inPlace.Buffer() && !context.SharesHostMemory())
  {
    // OpenCL allows a write whose source is the memory of the buffer.
    queue.enqueueWriteBuffer(inPlace.Buffer, CL_TRUE, 0, inPlace.Bytes, inPlace.Data);
  }
}

void CheckAllocation(
  std::uint64_t bytes, std::uint64_t limit, const char* owners, const char* remedy)
{
  if (bytes > limit)
  {
    throw Error(std::string(owners) + " need " + std::to_string(bytes) +
      " bytes in one allocation, but the device allows at most " + std::to_string(limit) + ". " +
      remedy + " or another device.");
  }
}

void Reserve(const OpenCLContext& context, cl::Buffer& buffer, std::uint64_t bytes)
{
  if (GetMemory(buffer) != bytes)
  {
    buffer = cl::Buffer(); // free the old one before the new one is made
    buffer = cl::Buffer(context.GetContext(), CL_MEM_READ_WRITE, bytes);
  }
}

void Bind(const OpenCLContext& context, cl::Buffer& buffer, void* memory, std::size_t elementSize,
  std::uint64_t bytes)
{
  if (CanWorkInPlace(context, memory, elementSize))
  {
    buffer = cl::Buffer(); // the old buffer may use the same memory
    buffer = MakeBufferOver(context, CL_MEM_READ_WRITE, memory, bytes);
  }
  else
  {
    Reserve(context, buffer, bytes);
  }
}

PendingCopy BeginToRead(
  const cl::CommandQueue& queue, const cl::Buffer& buffer, std::uint64_t bytes, void* memory)
{
  if (!IsInPlace(buffer))
  {
    return BeginToReadRange(queue, buffer, 0, bytes, memory);
  }
  // OpenCL guarantees that host memory is up to date only after the buffer has been mapped.
  cl::Event done;
  void* mapped = queue.enqueueMapBuffer(buffer, CL_FALSE, CL_MAP_READ, 0, bytes);
  queue.enqueueUnmapMemObject(buffer, mapped, nullptr, &done);
  return PendingCopy(done);
}

PendingCopy BeginToReadRange(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  std::uint64_t offset, std::uint64_t bytes, void* memory)
{
  return BeginToCopy(queue, buffer, CopiedBox::MakeRange(offset, bytes), memory, true);
}

PendingCopy BeginToReadBox(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const Extent& whole, const Extent& part, std::size_t bytes, void* memory, const Extent& held)
{
  return BeginToCopy(queue, buffer, MakeBox(whole, part, bytes, held), memory, true);
}

void Write(const cl::CommandQueue& queue, const cl::Buffer& buffer, std::uint64_t offset,
  std::uint64_t bytes, const void* data)
{
  BeginToWrite(queue, buffer, offset, bytes, data).Check();
}

PendingCopy BeginToWrite(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  std::uint64_t offset, std::uint64_t bytes, const void* data)
{
  return BeginToCopy(
    queue, buffer, CopiedBox::MakeRange(offset, bytes), const_cast<void*>(data), false); // is read
}

void WriteBox(const cl::CommandQueue& queue, const cl::Buffer& buffer, const Extent& whole,
  const Extent& part, std::size_t bytes, const void* memory, const Extent& held)
{
  BeginToCopy(queue, buffer, MakeBox(whole, part, bytes, held), const_cast<void*>(memory), false)
    .Check();
}

cl_int WaitFor(cl_event event) noexcept
{
  const cl_int error = clWaitForEvents(1, &event);
  cl_int status = CL_COMPLETE;
  clGetEventInfo(event, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof(status), &status, nullptr);
  return status < 0 ? status : error;
}

PendingCopy::~PendingCopy()
{
  if (this->Event())
  {
    WaitFor(this->Event());
  }
}

cl_int PendingCopy::Finish()
{
  if (this->MakeCopy)
  {
    return std::exchange(this->MakeCopy, nullptr)();
  }
  return this->Event() ? WaitFor(std::exchange(this->Event, cl::Event())()) : CL_SUCCESS;
}

void PendingCopy::Check()
{
  deformvolume::Check(this->Finish());
}

void PendingCopies::Check()
{
  // All copies are removed, also after an exception.
  std::vector<PendingCopy> copies = std::move(this->Copies);
  this->Copies.clear();
  for (PendingCopy& copy : copies)
  {
    copy.Check();
  }
}

bool IsInPlace(const cl::Buffer& buffer)
{
  return buffer() && GetMemory(buffer) == 0;
}

} // namespace deformvolume
