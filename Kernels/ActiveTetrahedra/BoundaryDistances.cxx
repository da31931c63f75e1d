// SPDX-License-Identifier: BSD-3-Clause
#include "BoundaryDistances.h"

#include "BrickBlocks.h"

#include <algorithm>

namespace deformvolume
{

BoundaryDistances::BoundaryDistances(const Extent& vertices, float far)
  : Bricks(GetVertexBricks(vertices))
  , Far(far)
  , Changed(this->Bricks.GetNumberOfBricks(), true)
{
}

void BoundaryDistances::SetBase(const float* base, const std::vector<const DistanceSet*>& sets)
{
  const std::size_t count = this->Bricks.GetNumberOfCells();
  this->Base = base ? std::vector<float>(base, base + count) : std::vector<float>();
  if (!base && this->Values.empty())
  {
    return;
  }
  this->Values = base ? this->Base : std::vector<float>(count, this->Far);
  for (const DistanceSet* set : sets)
  {
    this->Update(set->Bricks, sets);
  }
  this->Changed.assign(this->Changed.size(), true);
}

void BoundaryDistances::Add(const DistanceSet& edit)
{
  if (this->Values.empty() && !edit.IsEmpty())
  {
    this->Values.assign(this->Bricks.GetNumberOfCells(), this->Far);
  }
  for (std::size_t i = 0; i < edit.Bricks.size(); ++i)
  {
    const DistanceSet::Block& block = edit.Blocks[i];
    ForEachCell(this->Bricks, edit.Bricks[i],
      [&](const std::array<int, 3>&, std::size_t index, std::size_t vertex)
      { this->Values[vertex] = std::min(this->Values[vertex], block[index]); });
    this->Changed[edit.Bricks[i]] = true;
  }
}

void BoundaryDistances::Update(
  const std::vector<std::size_t>& bricks, const std::vector<const DistanceSet*>& sets)
{
  if (this->Values.empty() && !bricks.empty())
  {
    this->Values.assign(this->Bricks.GetNumberOfCells(), this->Far);
  }
  for (const std::size_t brick : bricks)
  {
    this->UpdateBrick(brick, sets);
    this->Changed[brick] = true;
  }
}

void BoundaryDistances::UpdateBrick(std::size_t brick, const std::vector<const DistanceSet*>& sets)
{
  std::vector<const DistanceSet::Block*> blocks;
  for (const DistanceSet* set : sets)
  {
    if (const DistanceSet::Block* block = FindBlock(*set, brick))
    {
      blocks.push_back(block);
    }
  }
  ForEachCell(this->Bricks, brick,
    [&](const std::array<int, 3>&, std::size_t index, std::size_t vertex)
    {
      float least = this->Base.empty() ? this->Far : this->Base[vertex];
      for (const DistanceSet::Block* block : blocks)
      {
        least = std::min(least, (*block)[index]);
      }
      this->Values[vertex] = least;
    });
}

std::vector<std::size_t> BoundaryDistances::TakeChangedBricks()
{
  return this->Values.empty() ? std::vector<std::size_t>() : TakeMarked(this->Changed);
}

} // namespace deformvolume
