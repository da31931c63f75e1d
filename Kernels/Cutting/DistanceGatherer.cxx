// SPDX-License-Identifier: BSD-3-Clause
#include "DistanceGatherer.h"

namespace deformvolume
{

void DistanceGatherer::Add(const Extent& vertices, const float* distances)
{
  constexpr int length = CellBricks::Length;
  const std::lock_guard<std::mutex> lock(this->Mutex);
  ForEachPoint(vertices,
    [&](int i, int j, int k)
    {
      const float distance = *distances++;
      if (distance == this->Far)
      {
        return;
      }
      const int x = i - this->Volume[0];
      const int y = j - this->Volume[2];
      const int z = k - this->Volume[4];
      const auto [found, isNew] = this->Blocks.try_emplace(this->Bricks.FindBrick({ { x, y, z } }));
      if (isNew)
      {
        found->second.fill(this->Far);
      }
      float& last = found->second[TetrahedronSet::GetIndex(x % length, y % length, z % length)];
      last = this->Join(last, distance);
    });
}

DistanceSet DistanceGatherer::Take() const
{
  DistanceSet set;
  for (const auto& [brick, block] : this->Blocks)
  {
    set.Bricks.push_back(brick);
    set.Blocks.push_back(block);
  }
  return set;
}

} // namespace deformvolume
