// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDistanceSet_h
#define DeformVolumeDistanceSet_h

#include "CellBricks.h"
#include "TetrahedronSet.h"

namespace deformvolume
{

/// The signed distances of vertices from the surface of the region that one edit carves out,
/// negative inside it. A CrossingSet stores distances from a sheet in the same format. Vertices
/// that are not in the set are far outside the carved region.
using DistanceSet = BrickSet<float>;

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
