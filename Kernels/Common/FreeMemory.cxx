// SPDX-License-Identifier: BSD-3-Clause
#include "FreeMemory.h"

#include "SystemMemory.h"

#include <utility>

namespace deformvolume
{

FreeMemory::FreeMemory(std::function<std::uint64_t()> measure)
  : MeasureNow(std::move(measure))
{
}

FreeMemory& FreeMemory::Get()
{
  static FreeMemory memory([] { return GetSystemMemory(); });
  return memory;
}

std::optional<std::uint64_t> FreeMemory::Grant(std::uint64_t bytes)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  const std::uint64_t most = this->Measured / 2;
  if (this->Granted > most || bytes > most - this->Granted || this->Measured == 0 ||
    Clock::now() - this->Time > Validity)
  {
    return {};
  }
  const std::uint64_t left = this->Measured - this->Granted;
  this->Granted += bytes;
  return left;
}

std::uint64_t FreeMemory::Measure(std::uint64_t bytes)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Measured = this->MeasureNow();
  this->Granted = bytes;
  this->Time = Clock::now();
  ++this->NumberOfMeasurements;
  return this->Measured;
}

std::uint64_t FreeMemory::GetNumberOfMeasurements() const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return this->NumberOfMeasurements;
}

} // namespace deformvolume
