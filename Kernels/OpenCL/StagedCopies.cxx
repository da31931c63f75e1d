// SPDX-License-Identifier: BSD-3-Clause
#include "StagedCopies.h"

#include "HostMemory.h"
#include "ParallelFor.h"
#include "Processors.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>

namespace deformvolume
{
namespace
{

/// Returns the largest size of a portion of a box: bytes of a row, rows and planes.
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

// A copy between a buffer and memory of the caller. It calls the C functions of OpenCL, which do
// not throw, since the caller must wait for each event even after an error.
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
    CopiedBox portion = box;
    portion.OnHost = { {}, box.Size[0], box.Size[0] * box.Size[1] };
    return EnqueueCopy(this->Queue, this->Buffer, portion, half, this->Reads, done);
  }
};

/// Divides a box into portions.
class Portions
{
public:
  explicit Portions(CopiedBox box)
    : Box(box)
  {
    this->Box.Join();
    this->Step = FindStep(this->Box);
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      this->Count[axis] = (this->Box.Size[axis] + this->Step[axis] - 1) / this->Step[axis];
    }
  }

  std::size_t GetNumber() const { return this->Count[0] * this->Count[1] * this->Count[2]; }

  CopiedBox Get(std::size_t number) const
  {
    CopiedBox::Bytes begin;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      begin[axis] = number % this->Count[axis] * this->Step[axis];
      number /= this->Count[axis];
    }
    return this->Box.GetPart(begin, this->Step);
  }

private:
  CopiedBox Box;
  CopiedBox::Bytes Step;
  CopiedBox::Bytes Count;
};

/// Copies the portions first, first + step, first + 2 * step and so on through the two halves of
/// one thread. Returns the OpenCL error code, or CL_SUCCESS.
cl_int CopyPortions(const Transfer& transfer, const Portions& portions, std::size_t first,
  std::size_t step, char* memory)
{
  struct
  {
    CopiedBox Box;
    cl_event Done = nullptr; // null: no transfer in progress
  } halves[2];
  cl_int error = CL_SUCCESS;
  const auto end = [&](std::size_t half)
  {
    auto& [box, done] = halves[half];
    if (!done)
    {
      return;
    }
    const cl_int its = WaitFor(done);
    clReleaseEvent(done);
    done = nullptr;
    error = error == CL_SUCCESS ? its : error;
    if (transfer.Reads && error == CL_SUCCESS)
    {
      transfer.CopyOnHost(box, memory + half * StagedCopies::HalfBytes);
    }
  };
  std::size_t half = 0;
  for (std::size_t number = first; number < portions.GetNumber(); number += step, half = 1 - half)
  {
    end(half);
    if (error != CL_SUCCESS)
    {
      break;
    }
    char* const memoryOfHalf = memory + half * StagedCopies::HalfBytes;
    halves[half].Box = portions.Get(number);
    if (!transfer.Reads)
    {
      transfer.CopyOnHost(halves[half].Box, memoryOfHalf);
    }
    error = transfer.Enqueue(halves[half].Box, memoryOfHalf, &halves[half].Done);
    clFlush(transfer.Queue);
  }
  end(half); // of the two, this transfer was started first
  end(1 - half);
  return error;
}

} // namespace

cl_int EnqueueCopy(cl_command_queue queue, cl_mem buffer, const CopiedBox& box, void* memory,
  bool reads, cl_event* done) noexcept
{
  const CopiedBox::Bytes& size = box.Size;
  const CopiedBox::Location& there = box.OnDevice;
  const CopiedBox::Location& here = box.OnHost;
  if (box.IsRange())
  {
    void* const first = static_cast<char*>(memory) + here.GetOffset();
    return reads ? clEnqueueReadBuffer(
                     queue, buffer, CL_FALSE, there.GetOffset(), size[0], first, 0, nullptr, done)
                 : clEnqueueWriteBuffer(
                     queue, buffer, CL_FALSE, there.GetOffset(), size[0], first, 0, nullptr, done);
  }
  // CopiedBox::Join() leaves one plane with a pitch that may be invalid. 0 lets OpenCL compute it.
  const std::size_t plane = size[2] > 1 || there.Origin[2] > 0 ? there.Plane : 0;
  return reads
    ? clEnqueueReadBufferRect(queue, buffer, CL_FALSE, there.Origin.data(), here.Origin.data(),
        size.data(), there.Row, plane, here.Row, here.Plane, memory, 0, nullptr, done)
    : clEnqueueWriteBufferRect(queue, buffer, CL_FALSE, there.Origin.data(), here.Origin.data(),
        size.data(), there.Row, plane, here.Row, here.Plane, memory, 0, nullptr, done);
}

std::unique_ptr<StagedCopies> StagedCopies::Make(
  const cl::Context& context, const cl::Device& device)
{
  try
  {
    constexpr std::size_t bytes = MostThreads * 2 * HalfBytes;
    const cl::CommandQueue queue(context, device);
    const cl::Buffer pinned(context, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes);
    // The buffer stays mapped: the portions are copied to and from its host memory.
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

cl_int StagedCopies::Copy(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const CopiedBox& box, void* memory, bool reads) noexcept
{
  const Transfer transfer{ queue(), buffer(), static_cast<char*>(memory), reads };
  // Wait for the kernels of this queue before the lock, so that other threads can copy meanwhile.
  // An error of the queue is returned by the copy.
  clFinish(queue());
  const std::lock_guard<std::mutex> lock(this->Mutex);
  const Portions portions(box);
  const std::size_t threads = std::max<std::size_t>(1,
    std::min({ std::size_t{ MostThreads }, static_cast<std::size_t>(GetProcessorShare()),
      portions.GetNumber() / LeastPortionsPerThread }));
  std::array<cl_int, MostThreads> errors{};
  const auto copy = [&](std::int64_t begin, std::int64_t end)
  {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
    {
      errors[i] = CopyPortions(transfer, portions, i, threads, this->Memory + i * 2 * HalfBytes);
    }
  };
  // A std::function of a reference allocates no memory, so it cannot throw.
  RunOnOwnThreads(
    0, static_cast<std::int64_t>(threads), 1, std::cref(copy), static_cast<int>(threads));
  for (const cl_int error : errors)
  {
    if (error != CL_SUCCESS)
    {
      return error;
    }
  }
  return CL_SUCCESS;
}

} // namespace deformvolume
