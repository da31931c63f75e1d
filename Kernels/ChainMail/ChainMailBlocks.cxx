// SPDX-License-Identifier: BSD-3-Clause
#include "ChainMailBlocks.h"

#include "ChainMailParameters.h"

#include <algorithm>

namespace deformvolume
{
namespace
{

constexpr int Block = DEFORMVOLUME_BLOCK;

} // namespace

ChainMailBlocks::ChainMailBlocks(const Extent& extent)
  : Whole(extent)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    this->Size[axis] = static_cast<int>(deformvolume::GetSize(extent, axis));
    this->Counts[axis] = (this->Size[axis] + Block - 1) / Block;
  }
}

std::size_t ChainMailBlocks::GetNumberOfBlocks() const
{
  return static_cast<std::size_t>(this->Counts[0]) * static_cast<std::size_t>(this->Counts[1]) *
    static_cast<std::size_t>(this->Counts[2]);
}

std::array<int, 3> ChainMailBlocks::GetIndex(std::uint32_t block) const
{
  const auto row = static_cast<std::uint32_t>(this->Counts[0]);
  const auto column = static_cast<std::uint32_t>(this->Counts[1]);
  return { { static_cast<int>(block % row), static_cast<int>(block / row % column),
    static_cast<int>(block / row / column) } };
}

std::int64_t ChainMailBlocks::GetNeighbor(std::uint32_t block, int face) const
{
  const int axis = face / 2;
  const int at = this->GetIndex(block)[axis];
  if (face % 2 ? at + 1 >= this->Counts[axis] : at == 0)
  {
    return -1;
  }
  const std::int64_t steps[3] = { 1, this->Counts[0],
    std::int64_t{ this->Counts[0] } * this->Counts[1] };
  return std::int64_t{ block } + (face % 2 ? steps[axis] : -steps[axis]);
}

int ChainMailBlocks::GetColor(std::uint32_t block) const
{
  const std::array<int, 3> index = this->GetIndex(block);
  return (index[0] + index[1] + index[2]) % 2;
}

std::uint32_t ChainMailBlocks::GetVoxelIndex(int x, int y, int z) const
{
  const int block = (z / Block * this->Counts[1] + y / Block) * this->Counts[0] + x / Block;
  const int voxel = (z % Block * Block + y % Block) * Block + x % Block;
  return static_cast<std::uint32_t>(block) * DEFORMVOLUME_BLOCK_VOXELS +
    static_cast<std::uint32_t>(voxel);
}

Extent ChainMailBlocks::GetVoxels(std::uint32_t block) const
{
  const std::array<int, 3> index = this->GetIndex(block);
  Extent voxels;
  for (int axis = 0; axis < 3; ++axis)
  {
    voxels[2 * axis] = Block * index[axis];
    voxels[2 * axis + 1] = std::min(Block * (index[axis] + 1), this->Size[axis]) - 1;
  }
  return voxels;
}

void ChainMailBlocks::Append(const Extent& box, std::vector<std::uint32_t>& blocks) const
{
  Extent range;
  std::transform(box.begin(), box.end(), range.begin(), [](int voxel) { return voxel / Block; });
  ForEachPoint(range,
    [&](int x, int y, int z) {
      blocks.push_back(static_cast<std::uint32_t>((z * this->Counts[1] + y) * this->Counts[0] + x));
    });
}

std::vector<Extent> ChainMailBlocks::Join(const std::vector<std::uint32_t>& blocks) const
{
  std::vector<Extent> joined;
  for (std::size_t i = 0; i < blocks.size(); ++i)
  {
    Extent extent = this->GetVoxels(blocks[i]);
    for (int axis = 0; axis < 3; ++axis)
    {
      extent[2 * axis] += this->Whole[2 * axis];
      extent[2 * axis + 1] += this->Whole[2 * axis];
    }
    if (i > 0 && blocks[i] == blocks[i - 1] + 1 && extent[0] == joined.back()[1] + 1)
    {
      joined.back()[1] = extent[1];
    }
    else
    {
      joined.push_back(extent);
    }
  }
  return joined;
}

} // namespace deformvolume
