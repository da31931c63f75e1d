// SPDX-License-Identifier: BSD-3-Clause
#include "HostMemory.h"

#include "Error.h"

namespace deformvolume
{

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

void TellOfWrites(
  const OpenCLContext& context, const cl::CommandQueue& queue, const BufferInPlace& place)
{
  if (place.Buffer() && !context.SharesHostMemory())
  {
    // From the memory that the buffer was made over: OpenCL's way to say that it has changed.
    queue.enqueueWriteBuffer(place.Buffer, CL_TRUE, 0, place.Bytes, place.Data);
  }
}

void CheckAllocation(std::uint64_t bytes, std::uint64_t limit)
{
  if (bytes > limit)
  {
    throw Error("An array of the volume needs " + std::to_string(bytes) +
      " bytes in one piece, and the device gives no more than " + std::to_string(limit) + ".");
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

void Place(const OpenCLContext& context, cl::Buffer& buffer, void* memory, std::size_t elementSize,
  std::uint64_t bytes)
{
  if (CanWorkInPlace(context, memory, elementSize))
  {
    buffer = cl::Buffer(); // it may lie over the same memory
    buffer = MakeBufferOver(context, CL_MEM_READ_WRITE, memory, bytes);
  }
  else
  {
    Reserve(context, buffer, bytes);
  }
}

cl::Event BeginToRead(
  const cl::CommandQueue& queue, const cl::Buffer& buffer, std::uint64_t bytes, void* memory)
{
  cl::Event done;
  if (IsInPlace(buffer))
  {
    // What was written is sure to be in the host's memory only while it is mapped there.
    void* mapped = queue.enqueueMapBuffer(buffer, CL_FALSE, CL_MAP_READ, 0, bytes);
    queue.enqueueUnmapMemObject(buffer, mapped, nullptr, &done);
  }
  else
  {
    queue.enqueueReadBuffer(buffer, CL_FALSE, 0, bytes, memory, nullptr, &done);
  }
  return done;
}

cl::Event BeginToReadBox(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const Extent& whole, const Extent& part, std::size_t bytes, void* memory, const Extent& held)
{
  using Bytes = cl::array<cl::size_type, 3>;
  const auto findOrigin = [&](const Extent& extent)
  {
    Bytes origin;
    for (int axis = 0; axis < 3; ++axis)
    {
      origin[axis] =
        (axis == 0 ? bytes : 1) * static_cast<std::size_t>(part[2 * axis] - extent[2 * axis]);
    }
    return origin;
  };
  const auto count = [](const Extent& extent, int axis)
  { return static_cast<std::size_t>(GetSize(extent, axis)); };
  const Bytes region{ { bytes * count(part, 0), count(part, 1), count(part, 2) } };
  const std::size_t row = bytes * count(whole, 0);
  const std::size_t heldRow = bytes * count(held, 0);
  cl::Event done;
  queue.enqueueReadBufferRect(buffer, CL_FALSE, findOrigin(whole), findOrigin(held), region, row,
    row * count(whole, 1), heldRow, heldRow * count(held, 1), memory, nullptr, &done);
  return done;
}

void PendingReads::Check()
{
  cl_int error = CL_SUCCESS;
  for (const cl::Event& event : this->Events)
  {
    const cl_event waited = event();
    clWaitForEvents(1, &waited);
    cl_int status = CL_COMPLETE;
    clGetEventInfo(waited, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof(status), &status, nullptr);
    error = status < 0 && error == CL_SUCCESS ? status : error;
  }
  this->Events.clear();
  if (error != CL_SUCCESS)
  {
    throw cl::Error(error, "copying the output from the device");
  }
}

void PendingReads::Wait()
{
  for (const cl::Event& event : this->Events)
  {
    const cl_event waited = event();
    clWaitForEvents(1, &waited);
  }
  this->Events.clear();
}

bool IsInPlace(const cl::Buffer& buffer)
{
  return buffer() && GetMemory(buffer) == 0;
}

} // namespace deformvolume
