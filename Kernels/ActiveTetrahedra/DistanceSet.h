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

/// The signed distances of vertices from the surface of the region that one edit carves out,
/// negative inside it. A CrossingSet stores distances from a sheet in the same format. Vertices
/// that are not in the set are far outside the carved region.
struct DistanceSet
{
  /// One float for each vertex of a brick of 8 x 8 x 8 vertices (GetVertexBricks), with the index
  /// of TetrahedronSet::GetIndex().
  using Block = std::array<float, CellBricks::Cells>;

  /// The bricks with vertices of the set, in ascending order.
  std::vector<std::size_t> Bricks;
  /// The block of each of these bricks.
  std::vector<Block> Blocks;

  /// Whether the set has no vertices.
  bool IsEmpty() const { return this->Bricks.empty(); }
};

/// Returns the bricks of the vertices of a volume. These are the bricks of cells of a volume with
/// one more voxel on each axis: each vertex is the first vertex of such a cell.
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
