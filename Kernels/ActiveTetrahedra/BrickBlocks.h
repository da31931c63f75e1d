// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBrickBlocks_h
#define DeformVolumeBrickBlocks_h

#include "TetrahedronSet.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Returns the block of a brick, or null if the set does not have the brick.
template <typename Value>
const typename BrickSet<Value>::Block* FindBlock(const BrickSet<Value>& set, std::size_t brick)
{
  const auto index = std::lower_bound(set.Bricks.begin(), set.Bricks.end(), brick);
  return index != set.Bricks.end() && *index == brick
    ? &set.Blocks[static_cast<std::size_t>(index - set.Bricks.begin())]
    : nullptr;
}

/// Returns the marked bricks in ascending order, and clears all marks.
inline std::vector<std::size_t> TakeMarked(std::vector<bool>& marked)
{
  std::vector<std::size_t> taken;
  for (std::size_t brick = 0; brick < marked.size(); ++brick)
  {
    if (marked[brick])
    {
      taken.push_back(brick);
      marked[brick] = false;
    }
  }
  return taken;
}

/// Calls function(local indices, index in the block of the brick, index in the volume) for the
/// cells of a brick, or for the vertices of a brick of vertices (GetVertexBricks()).
template <typename Function>
void ForEachCell(const CellBricks& bricks, std::size_t brick, Function&& function)
{
  const Extent cells = bricks.GetCells(brick);
  const std::array<int, 3> size = bricks.GetSize();
  ForEachPoint(cells,
    [&](int x, int y, int z)
    {
      const std::int64_t row = std::int64_t{ z } * size[1] + y;
      function(std::array<int, 3>{ { x, y, z } },
        TetrahedronSet::GetIndex(x - cells[0], y - cells[2], z - cells[4]),
        static_cast<std::size_t>(row * size[0] + x));
    });
}

} // namespace deformvolume

#endif
