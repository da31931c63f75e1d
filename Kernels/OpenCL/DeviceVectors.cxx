// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceVectors.h"

#include "DeviceVectorsInternals.h"
#include "GuardedCall.h"
#include "HostMemory.h"

#include <algorithm>

namespace deformvolume
{
namespace
{

constexpr std::size_t VectorSize = 3 * sizeof(float);

// Sorts ranges, and merges ranges with few points between them: starting a copy takes longer than
// copying a few thousand vectors.
PointRanges Join(PointRanges ranges)
{
  constexpr std::size_t few = 4096;
  std::sort(ranges.begin(), ranges.end());
  PointRanges joined;
  for (const auto& range : ranges)
  {
    if (joined.empty() || range[0] > joined.back()[1] + few)
    {
      joined.push_back(range);
    }
    else
    {
      joined.back()[1] = std::max(joined.back()[1], range[1]);
    }
  }
  return joined;
}

void CheckSource(const float* vectors)
{
  if (!vectors)
  {
    throw Error("DeviceVectors::Write() needs an array of vectors, but the pointer is null.");
  }
}

} // namespace

DeviceVectors::Internals::Internals(OpenCLContext& context, std::size_t numberOfPoints)
  : NumberOfPoints(numberOfPoints)
{
  this->Device.Use(context);
  if (context.GetDevice().IsProcessor)
  {
    this->Host.resize(3 * numberOfPoints);
    return;
  }
  const std::uint64_t bytes = std::uint64_t{ numberOfPoints } * VectorSize;
  CheckAllocation(bytes, this->Device.GetAllocationLimit(),
    ("The vectors of " + std::to_string(numberOfPoints) + " points").c_str(), "Use fewer points");
  Reserve(context, this->Buffer, bytes);
  this->Device.GetQueue().enqueueFillBuffer(this->Buffer, cl_float{ 0.0F }, 0, bytes);
  this->Device.GetQueue().finish();
}

void DeviceVectors::Internals::Write(const float* vectors)
{
  if (this->AreInHostMemory())
  {
    std::copy_n(vectors, this->Host.size(), this->Host.begin());
  }
  else
  {
    deformvolume::Write(
      this->Device.GetQueue(), this->Buffer, 0, this->NumberOfPoints * VectorSize, vectors);
  }
  this->MarkAllWritten();
}

void DeviceVectors::Internals::Write(const float* vectors, const PointRanges& written)
{
  PointRanges ranges;
  for (const auto& range : written)
  {
    const std::size_t end = std::min(range[1], this->NumberOfPoints);
    if (range[0] < end)
    {
      ranges.push_back({ { range[0], end } });
    }
  }
  if (ranges.empty())
  {
    return;
  }
  this->MarkWritten(ranges);
  if (this->AreInHostMemory())
  {
    for (const auto& range : ranges)
    {
      std::copy(vectors + 3 * range[0], vectors + 3 * range[1], this->Host.begin() + 3 * range[0]);
    }
    return;
  }
  PendingCopies writes;
  for (const auto& range : ranges)
  {
    writes.Add(BeginToWrite(this->Device.GetQueue(), this->Buffer, range[0] * VectorSize,
      (range[1] - range[0]) * VectorSize, vectors + 3 * range[0]));
  }
  writes.Check();
}

const float* DeviceVectors::Internals::Read()
{
  const bool isNew = this->Host.empty();
  if (this->AreInHostMemory() || (!isNew && this->HostRevision == this->Log.GetRevision()))
  {
    return this->Host.data();
  }
  const auto changes = isNew ? std::nullopt : this->Log.GetSince(this->HostRevision);
  this->Host.resize(3 * this->NumberOfPoints);
  PendingCopies reads;
  for (const auto& range :
    changes ? Join(*changes) : PointRanges{ { { 0, this->NumberOfPoints } } })
  {
    reads.Add(BeginToReadRange(this->Device.GetQueue(), this->Buffer, range[0] * VectorSize,
      (range[1] - range[0]) * VectorSize, this->Host.data() + 3 * range[0]));
  }
  reads.Check();
  this->HostRevision = this->Log.GetRevision();
  return this->Host.data();
}

void CheckVectors(DeviceVectors* vectors, WorkDevice& device, std::size_t numberOfPoints)
{
  if (!vectors)
  {
    throw Error("The vectors on a device are null. Pass DeviceVectors.");
  }
  if (vectors->GetNumberOfPoints() != numberOfPoints)
  {
    throw Error("There are " + std::to_string(vectors->GetNumberOfPoints()) +
      " vectors on the device for " + std::to_string(numberOfPoints) +
      " points. Pass one vector for each point.");
  }
  if (!vectors->GetInternals().IsOn(device.GetContext()))
  {
    throw Error("The vectors are on the device \"" + vectors->GetDevice() +
      "\", and the volume is on \"" + device.GetDevice().Name +
      "\". Use one device for both, or read the vectors on the host.");
  }
}

DeviceVectors::DeviceVectors(const std::string& device, std::size_t numberOfPoints)
{
  if (numberOfPoints == 0)
  {
    throw Error("DeviceVectors need at least one point.");
  }
  CallGuarded(
    [&]
    {
      this->Impl =
        std::make_unique<Internals>(OpenCLContext::Get(FindDevice(device)), numberOfPoints);
    });
}

DeviceVectors::~DeviceVectors() = default;

const std::string& DeviceVectors::GetDevice() const
{
  return this->Impl->GetDevice();
}

bool DeviceVectors::AreInHostMemory() const
{
  return this->Impl->AreInHostMemory();
}

std::size_t DeviceVectors::GetNumberOfPoints() const
{
  return this->Impl->GetNumberOfPoints();
}

std::uint64_t DeviceVectors::GetDeviceMemory() const
{
  return this->AreInHostMemory() ? std::uint64_t{ this->GetNumberOfPoints() } * VectorSize
                                 : GetMemory(this->Impl->GetBuffer());
}

void DeviceVectors::Write(const float* vectors)
{
  CheckSource(vectors);
  CallGuarded([&] { this->Impl->Write(vectors); });
}

void DeviceVectors::Write(const float* vectors, const PointRanges& written)
{
  CheckSource(vectors);
  CallGuarded([&] { this->Impl->Write(vectors, written); });
}

const float* DeviceVectors::Read()
{
  return CallGuarded([&] { return this->Impl->Read(); });
}

std::uint64_t DeviceVectors::GetRevision() const
{
  return this->Impl->GetLog().GetRevision();
}

std::optional<PointRanges> DeviceVectors::GetChanges(std::uint64_t revision) const
{
  return this->Impl->GetLog().GetSince(revision);
}

} // namespace deformvolume
