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

/// For each sub-brick, what moves its cells at the boundary of the deformation mesh: tetrahedra of
/// the mesh, or a box of points of the field. The other list is empty; both are without a boundary.
struct BoundaryDependencies
{
  std::vector<std::vector<std::int32_t>> Tetrahedra;
  std::vector<Extent> FieldPoints;
};

/// vertices: the extent of the volume. isField: whether the boundary is that of a field.
BoundaryDependencies FindBoundaryDependencies(
  const MeshBoundary& boundary, bool isField, const Extent& vertices, const BrickGrid& subBricks);

} // namespace deformvolume

#endif
