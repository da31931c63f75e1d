// SPDX-License-Identifier: BSD-3-Clause
#include "BoundaryDistances.h"

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
    const auto place = std::lower_bound(set->Bricks.begin(), set->Bricks.end(), brick);
    if (place != set->Bricks.end() && *place == brick)
    {
      blocks.push_back(&set->Blocks[static_cast<std::size_t>(place - set->Bricks.begin())]);
    }
  }
  const Extent vertices = this->Bricks.GetCells(brick);
  const std::array<int, 3>& size = this->Bricks.GetSize();
  for (int z = vertices[4]; z <= vertices[5]; ++z)
  {
    for (int y = vertices[2]; y <= vertices[3]; ++y)
    {
      const std::size_t row = (static_cast<std::size_t>(z) * static_cast<std::size_t>(size[1]) +
                                static_cast<std::size_t>(y)) *
        static_cast<std::size_t>(size[0]);
      for (int x = vertices[0]; x <= vertices[1]; ++x)
      {
        const std::size_t place =
          TetrahedronSet::GetPlace(x - vertices[0], y - vertices[2], z - vertices[4]);
        const std::size_t vertex = row + static_cast<std::size_t>(x);
        float least = this->Base.empty() ? this->Far : this->Base[vertex];
        for (const DistanceSet::Block* block : blocks)
        {
          least = std::min(least, (*block)[place]);
        }
        this->Values[vertex] = least;
      }
    }
  }
}

std::vector<std::size_t> BoundaryDistances::TakeChangedBricks()
{
  std::vector<std::size_t> changed;
  for (std::size_t brick = 0; !this->Values.empty() && brick < this->Changed.size(); ++brick)
  {
    if (this->Changed[brick])
    {
      changed.push_back(brick);
      this->Changed[brick] = false;
    }
  }
  return changed;
}

std::uint64_t BoundaryDistances::GetMemory() const
{
  return (this->Base.size() + this->Values.size()) * sizeof(float);
}

} // namespace deformvolume
