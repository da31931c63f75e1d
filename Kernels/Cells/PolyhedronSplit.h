// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePolyhedronSplit_h
#define DeformVolumePolyhedronSplit_h

#include "CellSplit.h" // for CellFaces
#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// How a polyhedron is split.
struct PolyhedronSplit
{
  /// Between its own nodes; empty where it is split round a center.
  std::vector<Tetrahedron> Tetrahedra;
  /// What each of its nodes contributes to the center, and the triangles that make tetrahedra with
  /// it; else empty.
  std::vector<double> CenterWeights;
  std::vector<std::array<std::int32_t, 3>> Triangles;
};

/// Splits a polyhedron. nodes: their numbers in the mesh; points: where they are at rest; rounding:
/// relative error of these.
/// Where the tetrahedra of SplitCell() fill it, as they do in convex cells, they are taken. Else
/// the triangles of its faces are joined to a point that sees all of them from inside. The
/// triangles of a face follow from its nodes and their places, and cells that share a face agree on
/// them. Returns false where there is no such point. A polyhedron that is not closed is split by
/// SplitCell().
bool SplitPolyhedron(const std::vector<std::int32_t>& nodes, const CellFaces& faces,
  const std::vector<glm::dvec3>& points, double rounding, PolyhedronSplit& split);

} // namespace deformvolume

#endif
