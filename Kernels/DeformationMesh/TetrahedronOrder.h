// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronOrder_h
#define DeformVolumeTetrahedronOrder_h

#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <mutex>
#include <vector>

namespace deformvolume
{

/// The precedence of the tetrahedra of a mesh where several of them contain a voxel or a point at
/// rest. It does not depend on the numbers of nodes and tetrahedra.
///
/// A body is a part of the mesh that shares no node, and no position of a node at rest, with other
/// parts. Of overlapping bodies, the one with less volume comes first, so that a part that is
/// embedded in another one is not lost. Of bodies whose volumes are equal up to rounding to single
/// precision, the one with the lowest position of a node comes first (by x, then y, then z). Within
/// a body, the tetrahedron whose nodes come first in lexicographic order comes first: the positions
/// of the first nodes are compared, then those of the second nodes, and so on. Only if tetrahedra
/// have equal positions, the lowest number comes first.
///
/// Several threads may call the functions at the same time.
class TetrahedronOrder
{
public:
  /// points: at rest. Both arguments must outlive the object.
  TetrahedronOrder(
    const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra);

  /// Whether two tetrahedra belong to one body. Bodies are found when two tetrahedra without a
  /// common node are compared for the first time, which is rare in meshes that do not overlap.
  bool AreInOneBody(std::int32_t a, std::int32_t b) const;
  /// Whether tetrahedron a takes precedence over tetrahedron b.
  bool ComesBefore(std::int32_t a, std::int32_t b) const;

private:
  void RankBodies() const;

  const std::vector<glm::dvec3>& Points;
  const std::vector<Tetrahedron>& Tetrahedra;
  mutable std::once_flag Once;
  mutable std::vector<std::int32_t> Ranks; // of the bodies of the tetrahedra
};

} // namespace deformvolume

#endif
