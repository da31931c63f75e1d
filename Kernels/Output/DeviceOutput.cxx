// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceOutput.h"

#include "DeviceOutputInternals.h"
#include "GuardedCall.h"
#include "HostMemory.h"

#include <cstring>
#include <exception>
#include <utility>

namespace deformvolume
{

DeviceOutput::Internals::Internals(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const Voxels& voxels, void* memory, const ElementBytes& background)
  : Queue(queue)
  , Buffer(buffer)
  , Values(voxels)
  , Memory(static_cast<char*>(memory))
  , Background(background)
{
}

std::uint64_t DeviceOutput::Internals::GetBytes() const
{
  return static_cast<std::uint64_t>(GetNumberOfPoints(this->Values.Whole)) * this->Values.Bytes;
}

void DeviceOutput::Internals::LeaveDevice(Location location) noexcept
{
  this->Buffer = cl::Buffer();
  this->Queue = cl::CommandQueue();
  this->State = location;
}

void DeviceOutput::Internals::Download() noexcept
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  if (!this->IsOnDevice())
  {
    return;
  }
  try
  {
    this->Copy();
    this->LeaveDevice(Location::Host);
  }
  catch (const std::exception& error)
  {
    this->FillWithBackground();
    this->Message = error.what();
    this->LeaveDevice(Location::Nowhere);
  }
}

void DeviceOutput::Internals::Copy()
{
  const auto copy = [this]
  {
    const Voxels& values = this->Values;
    if (values.Part == values.Whole)
    {
      BeginToReadRange(this->Queue, this->Buffer, 0, this->GetBytes(), this->Memory).Check();
    }
    else if (GetNumberOfPoints(values.Part) > 0)
    {
      BeginToReadBox(this->Queue, this->Buffer, values.Whole, values.Part, values.Bytes,
        this->Memory, values.Whole)
        .Check();
    }
  };
  CallGuarded(
    copy, [] {}, " The output is left with the background. Update it once more.");
}

void DeviceOutput::Internals::FillWithBackground() const
{
  for (std::uint64_t i = 0; i < this->GetBytes(); i += this->Background.Size)
  {
    std::memcpy(this->Memory + i, this->Background.Bytes.data(), this->Background.Size);
  }
}

std::string DeviceOutput::Internals::GetMessage()
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return this->Message;
}

void DeviceOutput::Internals::Drop() noexcept
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  if (this->IsOnDevice())
  {
    this->LeaveDevice(Location::Nowhere);
  }
}

std::uint64_t DeviceOutput::Internals::GetMemory()
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return this->IsOnDevice() ? this->GetBytes() : 0;
}

void UnreadOutputs::Set(const std::vector<std::shared_ptr<DeviceOutput>>& outputs, bool ownBuffers)
{
  this->Outputs.clear();
  for (const std::shared_ptr<DeviceOutput>& output : outputs)
  {
    this->Outputs.push_back(output->GetInternals());
  }
  this->OwnBuffers = ownBuffers;
}

void UnreadOutputs::Download() noexcept
{
  for (const std::weak_ptr<DeviceOutput::Internals>& output : this->Outputs)
  {
    if (const std::shared_ptr<DeviceOutput::Internals> unread = output.lock())
    {
      unread->Download();
    }
  }
  this->Outputs.clear();
}

std::uint64_t UnreadOutputs::GetMemory() const
{
  std::uint64_t bytes = 0;
  for (const std::weak_ptr<DeviceOutput::Internals>& output : this->Outputs)
  {
    const std::shared_ptr<DeviceOutput::Internals> unread = output.lock();
    bytes += unread && this->OwnBuffers ? unread->GetMemory() : 0;
  }
  return bytes;
}

DeviceOutput::DeviceOutput(std::shared_ptr<Internals> internals)
  : Impl(std::move(internals))
{
}

DeviceOutput::~DeviceOutput()
{
  this->Impl->Drop();
}

bool DeviceOutput::IsOnDevice() const
{
  return this->Impl->IsOnDevice();
}

bool DeviceOutput::IsRead() const
{
  return this->Impl->IsRead();
}

void DeviceOutput::Drop()
{
  this->Impl->Drop();
}

void DeviceOutput::Read()
{
  this->Impl->Download();
  const std::string message = this->Impl->GetMessage();
  if (!message.empty())
  {
    throw Error(message);
  }
}

} // namespace deformvolume
