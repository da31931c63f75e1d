// SPDX-License-Identifier: BSD-3-Clause
#include "DistanceGatherer.h"

namespace deformvolume
{

void DistanceGatherer::Add(const Extent& vertices, const float* distances)
{
  constexpr int length = CellBricks::Length;
  const std::lock_guard<std::mutex> lock(this->Mutex);
  for (int z = vertices[4] - this->Volume[4]; z <= vertices[5] - this->Volume[4]; ++z)
  {
    for (int y = vertices[2] - this->Volume[2]; y <= vertices[3] - this->Volume[2]; ++y)
    {
      for (int x = vertices[0] - this->Volume[0]; x <= vertices[1] - this->Volume[0]; ++x)
      {
        const float distance = *distances++;
        if (distance == this->Far)
        {
          continue;
        }
        const auto [found, isNew] =
          this->Blocks.try_emplace(this->Bricks.FindBrick({ { x, y, z } }));
        if (isNew)
        {
          found->second.fill(this->Far);
        }
        float& last = found->second[TetrahedronSet::GetIndex(x % length, y % length, z % length)];
        last = this->Join(last, distance);
      }
    }
  }
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
