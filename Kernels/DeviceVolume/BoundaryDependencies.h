// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBoundaryDependencies_h
#define DeformVolumeBoundaryDependencies_h

#include "BrickPoints.h"
#include "Extent.h"
#include "MeshBoundary.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// For each sub-brick, the tetrahedra of the mesh, or the box of points of the field, that move its
/// cells at the boundary. The other list is empty. Both are empty if there is no boundary.
struct BoundaryDependencies
{
  std::vector<std::vector<std::int32_t>> Tetrahedra;
  std::vector<Extent> FieldPoints;
};

/// Finds the dependencies. vertices: extent of the volume. isField: whether the boundary is that of
/// a field.
BoundaryDependencies FindBoundaryDependencies(
  const MeshBoundary& boundary, bool isField, const Extent& vertices, const BrickGrid& subBricks);

} // namespace deformvolume

#endif
