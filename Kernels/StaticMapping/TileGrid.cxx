// SPDX-License-Identifier: BSD-3-Clause
#include "TileGrid.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace deformvolume
{

namespace
{

// In voxels. Nodes farther away would overflow WideInteger, and their weights in single precision
// would be meaningless.
constexpr double LargestIndex = 2147483648.0;

} // namespace

TileGrid::TileGrid(const Extent& voxels)
  : Voxels(voxels)
{
  this->ChooseSize();
}

// The default size of tiles fits into the caches of a CPU. Large volumes have larger tiles, since
// each tile needs memory.
void TileGrid::ChooseSize()
{
  constexpr std::int64_t most = 16384;
  const std::int64_t points[2] = { deformvolume::GetSize(this->Voxels, 1),
    deformvolume::GetSize(this->Voxels, 2) };
  while (true)
  {
    for (int axis = 0; axis < 2; ++axis)
    {
      this->Count[axis] = (points[axis] + this->Size[axis] - 1) / this->Size[axis];
    }
    if (this->GetNumberOfTiles() <= most)
    {
      return;
    }
    this->Size[this->Count[0] > this->Count[1] ? 0 : 1] *= 2;
  }
}

bool TileGrid::IsWithinLimit(const Positions& nodes)
{
  return std::all_of(nodes.begin(), nodes.end(),
    [](const glm::dvec3& point)
    {
      return std::abs(point.x) <= LargestIndex && std::abs(point.y) <= LargestIndex &&
        std::abs(point.z) <= LargestIndex;
    });
}

VoxelBox TileGrid::FindBox(const Positions& nodes, double margin) const
{
  const glm::dvec3 min =
    glm::min(glm::min(nodes[0], nodes[1]), glm::min(nodes[2], nodes[3])) - margin;
  const glm::dvec3 max =
    glm::max(glm::max(nodes[0], nodes[1]), glm::max(nodes[2], nodes[3])) + margin;
  VoxelBox box;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double first = static_cast<double>(this->Voxels[2 * axis]);
    const double last = static_cast<double>(this->Voxels[2 * axis + 1]);
    // Relative to the first voxel, so not negative: the conversion to an integer rounds down.
    const double low = std::max(min[axis], first) - first;
    const double high = std::min(max[axis], last) - first;
    if (!(low <= high))
    {
      return VoxelBox();
    }
    const auto begin = static_cast<std::int64_t>(low);
    box.Min[axis] = this->Voxels[2 * axis] + begin + (static_cast<double>(begin) < low ? 1 : 0);
    box.Max[axis] = this->Voxels[2 * axis] + static_cast<std::int64_t>(high);
  }
  return box;
}

TileGrid::Range TileGrid::FindRange(const Positions& nodes, double margin) const
{
  Range range;
  const VoxelBox box = this->FindBox(nodes, margin);
  if (!box.IsEmpty())
  {
    const Rectangle tiles = this->GetTiles(box);
    for (int axis = 0; axis < 2; ++axis)
    {
      range.Min[axis] = static_cast<std::int16_t>(tiles.Begin[axis]);
      range.Max[axis] = static_cast<std::int16_t>(tiles.End[axis] - 1);
    }
  }
  return range;
}

VoxelBox TileGrid::GetVoxels(std::int64_t tile) const
{
  VoxelBox box;
  box.Min[0] = this->Voxels[0];
  box.Max[0] = this->Voxels[1];
  const std::int64_t index[2] = { tile % this->Count[0], tile / this->Count[0] };
  for (int axis = 0; axis < 2; ++axis)
  {
    box.Min[axis + 1] = this->Voxels[2 * axis + 2] + index[axis] * this->Size[axis];
    box.Max[axis + 1] =
      std::min<std::int64_t>(box.Min[axis + 1] + this->Size[axis] - 1, this->Voxels[2 * axis + 3]);
  }
  return box;
}

} // namespace deformvolume
