// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDistanceSet_h
#define DeformVolumeDistanceSet_h

#include "CellBricks.h"
#include "TetrahedronSet.h"

#include <array>
#include <cstddef>
#include <vector>

namespace deformvolume
{

/// Signed distances of vertices to the boundary of what one edit carves out, negative inside. What
/// is not in the set is far outside.
struct DistanceSet
{
  /// One float a vertex of a brick of 8 x 8 x 8 vertices (GetVertexBricks), at the place that
  /// TetrahedronSet::GetPlace() gives it.
  using Block = std::array<float, CellBricks::Cells>;

  /// Bricks with vertices of the set, in ascending order, and as many blocks.
  std::vector<std::size_t> Bricks;
  /// The block of each of these bricks.
  std::vector<Block> Blocks;

  /// Whether no vertex is in it.
  bool IsEmpty() const { return this->Bricks.empty(); }
};

/// The bricks of the vertices of a volume. They are those of the cells of a volume that is larger
/// by one voxel on each axis: each vertex is the first one of such a cell.
inline CellBricks GetVertexBricks(const Extent& vertices)
{
  Extent larger = vertices;
  for (int axis = 0; axis < 3; ++axis)
  {
    ++larger[2 * axis + 1];
  }
  return CellBricks(larger);
}

} // namespace deformvolume

#endif
