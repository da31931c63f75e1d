// SPDX-License-Identifier: BSD-3-Clause
#include "StagedCopies.h"

#include "HostMemory.h"
#include "Processors.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <utility>

namespace deformvolume
{
namespace
{

// A copy that is small enough for one slot is divided all the same, so that threads share it, but
// not into portions that are not worth a call of the driver.
constexpr std::size_t LeastPortion = std::size_t{ 1 } << 18;

/// How many bytes of a row, rows and planes a portion of a box has at most.
CopiedBox::Bytes FindStep(const CopiedBox& box)
{
  const std::size_t most =
    std::clamp((box.GetBytes() + StagedCopies::NumberOfSlots - 1) / StagedCopies::NumberOfSlots,
      LeastPortion, StagedCopies::SlotBytes);
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

} // namespace

class StagedCopies::Copy
{
public:
  enum class Direction
  {
    FromDevice,
    ToDevice
  };

  Copy(const cl::CommandQueue& queue, const cl::Buffer& buffer, const CopiedBox& box, void* memory,
    Direction direction)
    : Queue(queue)
    , Buffer(buffer)
    , Box(box)
    , Memory(static_cast<char*>(memory))
    , Way(direction)
  {
    this->Box.Join();
    this->Step = FindStep(this->Box);
    std::size_t number = 1;
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Count[axis] = (this->Box.Size[axis] + this->Step[axis] - 1) / this->Step[axis];
      number *= this->Count[axis];
    }
    this->Untaken = this->Unfinished = number;
  }

  /// The portion that is taken next.
  CopiedBox GetNext() const
  {
    std::size_t number = this->Count[0] * this->Count[1] * this->Count[2] - this->Untaken;
    CopiedBox portion = this->Box;
    for (int axis = 0; axis < 3; ++axis)
    {
      const std::size_t begin = number % this->Count[axis] * this->Step[axis];
      number /= this->Count[axis];
      portion.Size[axis] = std::min(this->Step[axis], this->Box.Size[axis] - begin);
      portion.OnDevice.Origin[axis] += begin;
      portion.OnHost.Origin[axis] += begin;
    }
    return portion;
  }

  cl::CommandQueue Queue;
  cl::Buffer Buffer;
  CopiedBox Box;
  char* Memory;
  Direction Way;
  CopiedBox::Bytes Step;
  CopiedBox::Bytes Count; // of portions on each axis
  // Guarded by the mutex of StagedCopies.
  std::size_t Untaken;
  std::size_t Unfinished;
  cl_int Error = CL_SUCCESS;
};

/// What a thread copies at a time. Functions of OpenCL as such: an exception must not leave a
/// thread.
struct StagedCopies::Portion
{
  StagedCopies::Copy* From = nullptr; // there until the portion is finished
  CopiedBox Box;
  char* Slot = nullptr;
  cl_event Done = nullptr;
  cl_int Error = CL_SUCCESS;

  void CopyOnHost() const
  {
    std::size_t place = 0;
    for (std::size_t z = 0; z < this->Box.Size[2]; ++z)
    {
      for (std::size_t y = 0; y < this->Box.Size[1]; ++y)
      {
        char* const row = this->From->Memory + this->Box.OnHost.GetOffset({ { 0, y, z } });
        char* const packed = this->Slot + place;
        const bool reads = this->From->Way == Copy::Direction::FromDevice;
        std::memcpy(reads ? row : packed, reads ? packed : row, this->Box.Size[0]);
        place += this->Box.Size[0];
      }
    }
  }

  cl_int Enqueue()
  {
    const cl_command_queue queue = this->From->Queue();
    const cl_mem buffer = this->From->Buffer();
    const CopiedBox::Bytes& size = this->Box.Size;
    const CopiedBox::Place& there = this->Box.OnDevice;
    const bool reads = this->From->Way == Copy::Direction::FromDevice;
    if (this->Box.IsRange())
    {
      return reads ? clEnqueueReadBuffer(queue, buffer, CL_FALSE, there.GetOffset(), size[0],
                       this->Slot, 0, nullptr, &this->Done)
                   : clEnqueueWriteBuffer(queue, buffer, CL_FALSE, there.GetOffset(), size[0],
                       this->Slot, 0, nullptr, &this->Done);
    }
    const CopiedBox::Bytes here{ { 0, 0, 0 } };
    // Of rows that have been joined there is one plane, which has no pitch.
    const std::size_t plane = size[2] > 1 || there.Origin[2] > 0 ? there.Plane : 0;
    return reads ? clEnqueueReadBufferRect(queue, buffer, CL_FALSE, there.Origin.data(),
                     here.data(), size.data(), there.Row, plane, size[0], size[0] * size[1],
                     this->Slot, 0, nullptr, &this->Done)
                 : clEnqueueWriteBufferRect(queue, buffer, CL_FALSE, there.Origin.data(),
                     here.data(), size.data(), there.Row, plane, size[0], size[0] * size[1],
                     this->Slot, 0, nullptr, &this->Done);
  }

  void Start()
  {
    if (this->From->Way == Copy::Direction::ToDevice)
    {
      this->CopyOnHost();
    }
    this->Error = this->Enqueue();
    clFlush(this->From->Queue());
  }

  /// Returns the error.
  cl_int End()
  {
    if (this->Error != CL_SUCCESS)
    {
      return this->Error;
    }
    const cl_int error = WaitFor(this->Done);
    clReleaseEvent(this->Done);
    if (error == CL_SUCCESS && this->From->Way == Copy::Direction::FromDevice)
    {
      this->CopyOnHost();
    }
    return error;
  }
};

std::unique_ptr<StagedCopies> StagedCopies::Make(
  const cl::Context& context, const cl::Device& device)
{
  try
  {
    const std::size_t bytes = NumberOfSlots * SlotBytes;
    const cl::CommandQueue queue(context, device);
    const cl::Buffer pinned(context, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes);
    // It stays mapped: what is copied to it and from it is the host's memory.
    void* const slots =
      queue.enqueueMapBuffer(pinned, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes);
    return std::unique_ptr<StagedCopies>(
      new StagedCopies(queue, pinned, static_cast<char*>(slots)));
  }
  catch (const cl::Error&)
  {
    return nullptr;
  }
}

StagedCopies::StagedCopies(const cl::CommandQueue& queue, const cl::Buffer& pinned, char* slots)
  : Queue(queue)
  , Pinned(pinned)
  , MostThreads(std::min<std::size_t>(NumberOfSlots, GetProcessorShare()))
{
  for (; this->NumberOfFreeSlots < NumberOfSlots; ++this->NumberOfFreeSlots)
  {
    this->FreeSlots[this->NumberOfFreeSlots] = slots + this->NumberOfFreeSlots * SlotBytes;
  }
}

std::shared_ptr<StagedCopies::Copy> StagedCopies::BeginToRead(
  const cl::CommandQueue& queue, const cl::Buffer& buffer, const CopiedBox& box, void* memory)
{
  const auto copy = std::make_shared<Copy>(queue, buffer, box, memory, Copy::Direction::FromDevice);
  constexpr bool helps = false;
  if (!this->Begin(copy, helps))
  {
    this->Work(copy.get(), nullptr, nullptr);
  }
  return copy;
}

cl_int StagedCopies::Write(
  const cl::CommandQueue& queue, const cl::Buffer& buffer, const CopiedBox& box, const void* memory)
{
  const auto copy = std::make_shared<Copy>(
    queue, buffer, box, const_cast<void*>(memory), Copy::Direction::ToDevice); // only read
  constexpr bool helps = true;
  this->Begin(copy, helps);
  this->Work(copy.get(), nullptr, nullptr);
  return this->Wait(*copy);
}

cl_int StagedCopies::Wait(const Copy& copy) noexcept
{
  std::array<std::thread, NumberOfSlots> done;
  cl_int error = CL_SUCCESS;
  {
    std::unique_lock<std::mutex> lock(this->Mutex);
    this->Changed.wait(lock, [&] { return copy.Unfinished == 0; });
    error = copy.Error;
    for (std::size_t i = 0; i < NumberOfSlots; ++i)
    {
      if (this->Workers[i].IsDone)
      {
        done[i] = std::move(this->Workers[i].Thread);
        this->Workers[i].IsDone = false;
      }
    }
  }
  for (std::thread& thread : done)
  {
    if (thread.joinable())
    {
      thread.join(); // it has ended, or is about to
    }
  }
  return error;
}

bool StagedCopies::Begin(const std::shared_ptr<Copy>& copy, bool helps)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Copies.push_back(copy);
  this->NumberAtWork += helps ? 1 : 0;
  const auto isRunning = [](const Worker& worker)
  { return worker.Thread.joinable() && !worker.IsDone; };
  bool isWorkedOn = helps || std::any_of(this->Workers.begin(), this->Workers.end(), isRunning);
  const std::size_t leaves = helps ? 1 : 0; // portions for this thread
  for (Worker& worker : this->Workers)
  {
    if (copy->Untaken <= leaves || (isWorkedOn && this->NumberAtWork >= this->MostThreads))
    {
      break;
    }
    if (!isRunning(worker))
    {
      if (!this->StartThread(*copy, worker))
      {
        break;
      }
      isWorkedOn = true;
    }
  }
  this->NumberAtWork += isWorkedOn ? 0 : 1; // this thread has to do it
  return isWorkedOn;
}

bool StagedCopies::StartThread(Copy& copy, Worker& worker)
{
  if (worker.Thread.joinable())
  {
    worker.Thread.join();
    worker.IsDone = false;
  }
  try
  {
    // With a portion, so that it has ended when the copy is there.
    const Portion first{ &copy, copy.GetNext() };
    worker.Thread = std::thread([this, first, &worker] { this->Work(nullptr, &first, &worker); });
  }
  catch (const std::exception&)
  {
    return false; // others do its work, or the thread that has asked for the copy
  }
  this->MarkTaken(copy);
  ++this->NumberAtWork;
  return true;
}

void StagedCopies::MarkTaken(Copy& copy)
{
  if (--copy.Untaken == 0)
  {
    this->Forget(copy);
  }
}

void StagedCopies::Forget(const Copy& copy)
{
  const auto found = std::find_if(this->Copies.begin(), this->Copies.end(),
    [&](const std::shared_ptr<Copy>& one) { return one.get() == &copy; });
  if (found != this->Copies.end())
  {
    this->Copies.erase(found);
  }
}

bool StagedCopies::Take(const Copy* only, Portion& portion)
{
  const auto found = std::find_if(this->Copies.begin(), this->Copies.end(),
    [&](const std::shared_ptr<Copy>& one) { return !only || one.get() == only; });
  if (found == this->Copies.end())
  {
    return false;
  }
  Copy& copy = **found;
  portion = Portion{ &copy, copy.GetNext() };
  this->MarkTaken(copy);
  return true;
}

void StagedCopies::Work(const Copy* only, const Portion* first, Worker* worker) noexcept
{
  // One is on the bus while the other is copied on the host.
  std::array<Portion, 2> held;
  std::size_t number = 0;
  std::unique_lock<std::mutex> lock(this->Mutex);
  for (;;)
  {
    while (number < held.size())
    {
      // Slots are shared. Who has one must not wait for another.
      if (number > 0 &&
        (this->NumberOfFreeSlots == 0 || this->NumberAtWork * held.size() > NumberOfSlots))
      {
        break;
      }
      Portion& next = held[number];
      if (first)
      {
        next = *std::exchange(first, nullptr);
      }
      else if (!this->Take(only, next))
      {
        break;
      }
      this->Changed.wait(lock, [this] { return this->NumberOfFreeSlots > 0; });
      next.Slot = this->FreeSlots[--this->NumberOfFreeSlots];
      ++number;
      lock.unlock();
      next.Start();
      lock.lock();
    }
    if (number == 0)
    {
      break;
    }
    lock.unlock();
    const cl_int error = held[0].End();
    lock.lock();
    this->Finish(held[0], error);
    held[0] = held[1];
    --number;
  }
  --this->NumberAtWork;
  if (worker)
  {
    worker->IsDone = true;
  }
}

void StagedCopies::Finish(const Portion& portion, cl_int error)
{
  Copy& copy = *portion.From;
  this->FreeSlots[this->NumberOfFreeSlots++] = portion.Slot;
  --copy.Unfinished;
  if (error != CL_SUCCESS && copy.Error == CL_SUCCESS)
  {
    copy.Error = error;
    copy.Unfinished -= copy.Untaken; // the others are not begun
    copy.Untaken = 0;
    this->Forget(copy);
  }
  this->Changed.notify_all();
}

} // namespace deformvolume
