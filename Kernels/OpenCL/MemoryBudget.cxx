// SPDX-License-Identifier: BSD-3-Clause
#include "MemoryBudget.h"

#include "MemoryError.h"
#include "SystemMemory.h"
#include "WorkDevice.h"

#include <algorithm>
#include <string>
#include <utility>

namespace deformvolume
{

MemoryBudget::MemoryBudget(WorkDevice& device, std::function<std::uint64_t()> held)
  : Device(device)
  , CountHeld(std::move(held))
{
}

std::uint64_t MemoryBudget::GetUsable()
{
  if (this->Limit)
  {
    return this->Limit;
  }
  const OpenCLDevice& device = this->Device.GetDevice();
  const std::uint64_t all = device.Device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  const std::uint64_t system = device.IsProcessor ? this->GetSystemMemory() : 0;
  return system ? std::min(all, system) : all;
}

std::uint64_t MemoryBudget::GetSystemMemory()
{
  if (!this->SystemMemory)
  {
    this->MeasureSystemMemory();
  }
  return *this->SystemMemory;
}

void MemoryBudget::MeasureSystemMemory()
{
  const std::uint64_t left = deformvolume::GetSystemMemory();
  const bool shared = this->Device.GetDevice().IsProcessor;
  this->SystemMemory = left + (left && shared ? this->CountHeld() : 0);
}

bool MemoryBudget::HasRoomFor(std::uint64_t bytes)
{
  this->MeasureSystemMemory(); // the output may have been allocated since the last measurement
  // Compare even if bytes is 0: the limit may have been lowered.
  return this->CountHeld() + bytes <= this->GetUsable();
}

void MemoryBudget::CheckRoomFor(std::uint64_t bytes, const char* where, const char* remedy)
{
  this->MeasureSystemMemory();
  CheckBytes(this->CountHeld() + bytes, this->GetUsable(), where, remedy);
}

void MemoryBudget::CheckBytes(
  std::uint64_t needed, std::uint64_t available, const char* where, const char* remedy)
{
  if (needed > available)
  {
    throw MemoryError(std::string("Not enough memory ") + where + ": " + std::to_string(needed) +
      " bytes are needed and " + std::to_string(available) + " are available. " + remedy +
      ", raise the memory limit if one is set, or choose another device.");
  }
}

} // namespace deformvolume
