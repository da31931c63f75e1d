// SPDX-License-Identifier: BSD-3-Clause
#include "ChainMailHandles.h"

#include "ChainMailModel.h"
#include "ChainMailParameters.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace deformvolume
{
namespace
{

void Check(const ChainMailBlocks& blocks, const ChainMailHandle& handle, std::size_t number)
{
  const std::string name = "Handle " + std::to_string(number);
  for (int axis = 0; axis < 3; ++axis)
  {
    const double rest = handle.RestPosition[axis];
    const double displacement = handle.Displacement[axis];
    if (!std::isfinite(rest) || !std::isfinite(displacement))
    {
      throw Error(name + " has a coordinate that is not a finite number.");
    }
    if (rest < blocks.GetExtent()[2 * axis] - 0.5 || rest > blocks.GetExtent()[2 * axis + 1] + 0.5)
    {
      throw Error(name +
        " lies outside the volume at rest. Move its rest position into the volume, or remove it.");
    }
    if (std::abs(displacement) > ChainMailModel::LargestDisplacement)
    {
      throw Error(name + " is moved by more than 4095 voxels on an axis. Move it less.");
    }
  }
  if (!std::isfinite(handle.Radius) || handle.Radius < 0.0)
  {
    throw Error(name + " has the radius " + FormatNumber(handle.Radius) +
      ". It must be a finite number, 0 or more.");
  }
}

} // namespace

void CheckHandles(const ChainMailBlocks& blocks, const std::vector<ChainMailHandle>& handles)
{
  for (std::size_t i = 0; i < handles.size(); ++i)
  {
    Check(blocks, handles[i], i);
  }
}

ChainMailHandles::ChainMailHandles(const ChainMailBlocks& blocks,
  const std::array<double, 3>& spacing, const std::vector<ChainMailHandle>& handles)
{
  for (std::size_t i = 0; i < handles.size(); ++i)
  {
    const auto number = static_cast<std::uint32_t>(i);
    this->Select(blocks, spacing, handles[i], number);
    std::array<std::int32_t, 3> target;
    for (int axis = 0; axis < 3; ++axis)
    {
      target[axis] = static_cast<std::int32_t>(
        std::lround(handles[i].Displacement[axis] * DEFORMVOLUME_CHAINMAIL_UNITS));
    }
    this->Targets.push_back(target);
  }
  const auto order = [](const HeldVoxel& a, const HeldVoxel& b)
  { return a.Index != b.Index ? a.Index < b.Index : a.Handle < b.Handle; };
  std::sort(this->Voxels.begin(), this->Voxels.end(), order);
  const auto isSame = [](const HeldVoxel& a, const HeldVoxel& b) { return a.Index == b.Index; };
  this->Voxels.erase(
    std::unique(this->Voxels.begin(), this->Voxels.end(), isSame), this->Voxels.end());
  this->HasSome.resize(handles.size());
  for (const HeldVoxel& voxel : this->Voxels)
  {
    this->HasSome[voxel.Handle] = true;
  }
}

void ChainMailHandles::Select(const ChainMailBlocks& blocks, const std::array<double, 3>& spacing,
  const ChainMailHandle& handle, std::uint32_t number)
{
  constexpr double rounding = 1e-6; // of voxels at the distance of the radius, in voxels
  std::array<double, 3> at;
  std::array<int, 3> nearest;
  Extent box;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int last = blocks.GetSize()[axis] - 1;
    at[axis] = handle.RestPosition[axis] - blocks.GetExtent()[2 * axis];
    nearest[axis] = std::clamp(static_cast<int>(std::lround(at[axis])), 0, last);
    const double radius = handle.Radius / spacing[axis] + rounding;
    box[2 * axis] = static_cast<int>(std::clamp(std::ceil(at[axis] - radius), 0.0, last + 1.0));
    box[2 * axis + 1] =
      static_cast<int>(std::clamp(std::floor(at[axis] + radius), -1.0, 0.0 + last));
  }
  this->Voxels.push_back({ blocks.GetVoxelIndex(nearest[0], nearest[1], nearest[2]), number });
  const double reach = handle.Radius + rounding * *std::min_element(spacing.begin(), spacing.end());
  const auto square = [&](int axis, int index)
  { return (index - at[axis]) * spacing[axis] * (index - at[axis]) * spacing[axis]; };
  ForEachPoint(box,
    [&](int x, int y, int z)
    {
      if (square(0, x) + square(1, y) + square(2, z) <= reach * reach)
      {
        this->Voxels.push_back({ blocks.GetVoxelIndex(x, y, z), number });
      }
    });
}

std::vector<std::uint32_t> ChainMailHandles::GetBlocks() const
{
  std::vector<std::uint32_t> blocks;
  for (const HeldVoxel& voxel : this->Voxels)
  {
    const std::uint32_t block = voxel.Index / DEFORMVOLUME_BLOCK_VOXELS;
    if (blocks.empty() || blocks.back() != block)
    {
      blocks.push_back(block);
    }
  }
  return blocks;
}

} // namespace deformvolume
