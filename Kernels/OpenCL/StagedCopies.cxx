// SPDX-License-Identifier: BSD-3-Clause
#include "StagedCopies.h"

#include "HostMemory.h"

#include <array>
#include <cstring>

namespace deformvolume
{
namespace
{

/// How many bytes of a row, rows and planes a portion of a box has at most.
CopiedBox::Bytes FindStep(const CopiedBox& box)
{
  constexpr std::size_t most = StagedCopies::HalfBytes;
  const std::size_t row = box.Size[0];
  const std::size_t plane = row * box.Size[1];
  if (plane <= most)
  {
    return { { row, box.Size[1], most / plane } };
  }
  if (row <= most)
  {
    return { { row, most / row, 1 } };
  }
  return { { most, 1, 1 } };
}

// A copy. Functions of OpenCL as such: an event has to be waited for whatever fails.
struct Transfer
{
  cl_command_queue Queue;
  cl_mem Buffer;
  char* Memory;
  bool Reads;

  /// Copies a portion between a half and the memory of the caller.
  void CopyOnHost(const CopiedBox& box, char* half) const
  {
    for (std::size_t z = 0; z < box.Size[2]; ++z)
    {
      for (std::size_t y = 0; y < box.Size[1]; ++y)
      {
        char* const row = this->Memory + box.OnHost.GetOffset({ { 0, y, z } });
        std::memcpy(this->Reads ? row : half, this->Reads ? half : row, box.Size[0]);
        half += box.Size[0];
      }
    }
  }

  cl_int Enqueue(const CopiedBox& box, char* half, cl_event* done) const
  {
    const CopiedBox::Bytes& size = box.Size;
    const CopiedBox::Place& there = box.OnDevice;
    if (box.IsRange())
    {
      return this->Reads ? clEnqueueReadBuffer(this->Queue, this->Buffer, CL_FALSE,
                             there.GetOffset(), size[0], half, 0, nullptr, done)
                         : clEnqueueWriteBuffer(this->Queue, this->Buffer, CL_FALSE,
                             there.GetOffset(), size[0], half, 0, nullptr, done);
    }
    const CopiedBox::Bytes here{ { 0, 0, 0 } };
    // Of rows that have been joined there is one plane, which has no pitch.
    const std::size_t plane = size[2] > 1 || there.Origin[2] > 0 ? there.Plane : 0;
    return this->Reads ? clEnqueueReadBufferRect(this->Queue, this->Buffer, CL_FALSE,
                           there.Origin.data(), here.data(), size.data(), there.Row, plane, size[0],
                           size[0] * size[1], half, 0, nullptr, done)
                       : clEnqueueWriteBufferRect(this->Queue, this->Buffer, CL_FALSE,
                           there.Origin.data(), here.data(), size.data(), there.Row, plane, size[0],
                           size[0] * size[1], half, 0, nullptr, done);
  }
};

// What is on the bus to or from a half.
struct Portion
{
  CopiedBox Box;
  cl_event Done = nullptr; // null: nothing
};

} // namespace

std::unique_ptr<StagedCopies> StagedCopies::Make(
  const cl::Context& context, const cl::Device& device)
{
  try
  {
    constexpr std::size_t bytes = 2 * HalfBytes;
    const cl::CommandQueue queue(context, device);
    const cl::Buffer pinned(context, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes);
    // It stays mapped: what is copied to it and from it is the host's memory.
    void* const memory =
      queue.enqueueMapBuffer(pinned, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes);
    return std::unique_ptr<StagedCopies>(
      new StagedCopies(queue, pinned, static_cast<char*>(memory)));
  }
  catch (const cl::Error&)
  {
    return nullptr;
  }
}

cl_int StagedCopies::Copy(const cl::CommandQueue& queue, const cl::Buffer& buffer, CopiedBox box,
  void* memory, bool reads) noexcept
{
  const Transfer transfer{ queue(), buffer(), static_cast<char*>(memory), reads };
  // Others may copy until the kernels of this queue are done. A failure comes with the copy.
  clFinish(queue());
  const std::lock_guard<std::mutex> lock(this->Mutex);
  std::array<Portion, 2> portions;
  cl_int error = CL_SUCCESS;
  const auto end = [&](std::size_t half)
  {
    Portion& portion = portions[half];
    if (!portion.Done)
    {
      return;
    }
    const cl_int its = WaitFor(portion.Done);
    clReleaseEvent(portion.Done);
    portion.Done = nullptr;
    error = error == CL_SUCCESS ? its : error;
    if (reads && error == CL_SUCCESS)
    {
      transfer.CopyOnHost(portion.Box, this->Memory + half * HalfBytes);
    }
  };
  const auto start = [&](std::size_t half, const CopiedBox& part)
  {
    char* const memoryOfHalf = this->Memory + half * HalfBytes;
    portions[half].Box = part;
    if (!reads)
    {
      transfer.CopyOnHost(part, memoryOfHalf);
    }
    error = transfer.Enqueue(part, memoryOfHalf, &portions[half].Done);
    clFlush(transfer.Queue);
  };
  box.Join();
  const CopiedBox::Bytes step = FindStep(box);
  std::size_t half = 0;
  CopiedBox::Bytes begin{};
  for (begin[2] = 0; begin[2] < box.Size[2]; begin[2] += step[2])
  {
    for (begin[1] = 0; begin[1] < box.Size[1]; begin[1] += step[1])
    {
      for (begin[0] = 0; begin[0] < box.Size[0]; begin[0] += step[0])
      {
        end(half);
        if (error == CL_SUCCESS)
        {
          start(half, box.GetPart(begin, step));
        }
        half = 1 - half;
      }
    }
  }
  end(half); // what was started first
  end(1 - half);
  return error;
}

cl_int StagedCopies::Read(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const CopiedBox& box, void* memory) noexcept
{
  return this->Copy(queue, buffer, box, memory, true);
}

cl_int StagedCopies::Write(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const CopiedBox& box, const void* memory) noexcept
{
  return this->Copy(queue, buffer, box, const_cast<void*>(memory), false); // only read
}

} // namespace deformvolume
