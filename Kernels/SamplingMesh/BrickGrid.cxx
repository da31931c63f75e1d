// SPDX-License-Identifier: BSD-3-Clause
#include "BrickGrid.h"

#include <algorithm>

namespace deformvolume
{
namespace
{

constexpr int BrickStep[3] = DEFORMVOLUME_BRICK_STEPS;

constexpr int SubBrickSize[3] = { 16, 8, 8 };
static_assert(DEFORMVOLUME_SPAN % SubBrickSize[0] == 0 &&
    DEFORMVOLUME_BRICK_Y / 2 % SubBrickSize[1] == 0 &&
    DEFORMVOLUME_BRICK_Z / 2 % SubBrickSize[2] == 0,
  "bricks are made of sub-bricks");

} // namespace

BrickGrid::BrickGrid(const VoxelGrid& voxelGrid)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    this->Size[axis] = static_cast<int>(deformvolume::GetSize(voxelGrid.VertexExtent, axis));
    const int remainder = voxelGrid.VertexExtent[2 * axis] % BrickStep[axis];
    this->Origin[axis] = -(remainder < 0 ? remainder + BrickStep[axis] : remainder);
    const int cells = this->Size[axis] - 1 - this->Origin[axis];
    this->Count[axis] = (cells + this->Cells[axis] - 1) / this->Cells[axis];
  }
}

void BrickGrid::AppendBricks(
  int layersBegin, int layersEnd, std::vector<std::uint32_t>& bricks) const
{
  constexpr auto whole = std::uint32_t{ DEFORMVOLUME_WHOLE_BRICK } << DEFORMVOLUME_BRICK_BITS;
  const int layer = this->Count[0] * this->Count[1];
  const int end = (layersEnd - 1 - this->Origin[2]) / this->Cells[2] + 1;
  for (int z = (layersBegin - this->Origin[2]) / this->Cells[2]; z < end; z += BricksInTurn)
  {
    for (int inLayer = 0; inLayer < layer; ++inLayer)
    {
      for (int i = z; i < std::min(z + BricksInTurn, end); ++i)
      {
        bricks.push_back(static_cast<std::uint32_t>(i * layer + inLayer) | whole);
      }
    }
  }
}

BrickGrid BrickGrid::GetSubBricks() const
{
  BrickGrid subBricks = *this;
  for (int axis = 0; axis < 3; ++axis)
  {
    subBricks.Cells[axis] = SubBrickSize[axis];
    subBricks.Count[axis] = this->Count[axis] * (this->Cells[axis] / SubBrickSize[axis]);
  }
  return subBricks;
}

std::pair<std::size_t, std::uint32_t> BrickGrid::GetBrick(
  const BrickGrid& subBricks, std::size_t subBrick) const
{
  std::size_t brick = 0;
  std::size_t stride = 1;
  int inBrick[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    const auto count = static_cast<std::size_t>(subBricks.Count[axis]);
    const int cell = static_cast<int>(subBrick % count) * subBricks.Cells[axis];
    inBrick[axis] = cell % this->Cells[axis];
    brick += stride * static_cast<std::size_t>(cell / this->Cells[axis]);
    subBrick /= count;
    stride *= static_cast<std::size_t>(this->Count[axis]);
  }
  return { brick,
    MakeSectionBits(static_cast<std::uint32_t>(inBrick[0] / DEFORMVOLUME_SPAN),
      inBrick[1] >= this->Cells[1] / 2, inBrick[2] >= this->Cells[2] / 2) };
}

Extent BrickGrid::GetVertices(std::size_t brick, int halo) const
{
  const std::size_t index[3] = { brick % this->Count[0], brick / this->Count[0] % this->Count[1],
    brick / this->Count[0] / this->Count[1] };
  Extent vertices;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int begin = this->Origin[axis] + static_cast<int>(index[axis]) * this->Cells[axis];
    vertices[2 * axis] = std::max(begin - halo, 0);
    vertices[2 * axis + 1] = std::min(begin + this->Cells[axis] + halo, this->Size[axis] - 1);
  }
  return vertices;
}

} // namespace deformvolume
