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

/// The split of a polyhedron into tetrahedra.
struct PolyhedronSplit
{
  /// Tetrahedra between the nodes of the polyhedron. Empty if it is split around a center.
  std::vector<Tetrahedron> Tetrahedra;
  /// The weights of all nodes for the center. Empty if there is no center.
  std::vector<double> CenterWeights;
  /// The triangles that form tetrahedra with the center. Empty if there is no center.
  std::vector<std::array<std::int32_t, 3>> Triangles;
  /// Whether the faces do not close the polyhedron, so that there is no split.
  bool IsOpen = false;
};

/// Splits a polyhedron. points: positions of the nodes at rest. rounding: relative error of the
/// positions.
///
/// If the tetrahedra of SplitCell() fill the polyhedron, as in convex cells, they are the result.
/// Otherwise the triangles of the faces are connected to a point inside from which all triangles
/// are visible. Returns false if no such point is found, or if the faces do not close. The
/// triangles of a face depend only on its nodes and their positions, so cells that share a face
/// split it in the same way.
bool SplitPolyhedron(const std::vector<CellNode>& nodes, const CellFaces& faces,
  const std::vector<glm::dvec3>& points, double rounding, PolyhedronSplit& split);

} // namespace deformvolume

#endif
