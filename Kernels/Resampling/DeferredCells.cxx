// SPDX-License-Identifier: BSD-3-Clause
#include "DeferredCells.h"

#include "HostMemory.h"
#include "KernelParameters.h"
#include "ResamplingProgram.h"
#include "WorkDevice.h"

#include <algorithm>

namespace deformvolume
{

namespace
{

// The number of bricks in a launch is chosen so that the list takes 1 / PartOfMemory of the memory,
// within the limits LeastBricks and MostBricks. Launches of ExactPasses never have more bricks.
constexpr std::uint64_t LeastBricks = 64;
constexpr std::uint64_t MostBricks = 704;
constexpr std::uint64_t PartOfMemory = 64;
// The number of work-groups for each compute unit in a launch that processes the list, whose length
// the host does not know.
constexpr std::size_t GroupsPerUnit = 16;
// The largest work-group whose work-items all have slots in local memory (SlotOfItem in
// ColumnCells.cl).
constexpr std::size_t LargestDeferredGroup =
  std::size_t{ DEFORMVOLUME_SPAN / 2 } * ((DEFORMVOLUME_BRICK_Y / 2 + 1) / 2);

/// Returns the memory for launches of this number of bricks.
std::uint64_t CountBytes(std::uint64_t bricks)
{
  constexpr std::uint64_t cellsOfBrick =
    std::uint64_t{ DEFORMVOLUME_BRICK_X } * DEFORMVOLUME_BRICK_Y * DEFORMVOLUME_BRICK_Z;
  return (2 + bricks * cellsOfBrick) * sizeof(cl_uint);
}

std::uint64_t CountMostBricks(WorkDevice& device)
{
  const std::uint64_t memory =
    device.GetDevice().Device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>() / PartOfMemory;
  return std::clamp(memory / CountBytes(1), LeastBricks, MostBricks);
}

} // namespace

std::uint64_t DeferredCells::GetMemory(WorkDevice& device, std::uint64_t bricks)
{
  return device.GetDevice().HasVectors || !HasLocalColumns(device.GetContext())
    ? 0
    : CountBytes(std::min(bricks, CountMostBricks(device)));
}

std::uint64_t DeferredCells::GetMostBricks()
{
  return CountMostBricks(this->Device);
}

void DeferredCells::Reserve(std::uint64_t bricks)
{
  const std::uint64_t bytes = CountBytes(std::min(bricks, this->GetMostBricks()));
  if (deformvolume::GetMemory(this->Buffer) < bytes) // keeps a larger buffer
  {
    deformvolume::Reserve(this->Device.GetContext(), this->Buffer, bytes);
  }
  this->Clear();
}

void DeferredCells::Clear()
{
  this->Device.GetQueue().enqueueFillBuffer(this->Buffer, cl_uint{ 0 }, 0, 2 * sizeof(cl_uint));
}

std::size_t DeferredCells::GetGroup(const cl::Kernel& kernel)
{
  return std::min(this->Device.GetHeavyGroupSize(kernel), LargestDeferredGroup);
}

std::size_t DeferredCells::GetItems(std::size_t group)
{
  return GroupsPerUnit * this->Device.GetContext().GetNumberOfUnits() * group;
}

} // namespace deformvolume
