// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBoundaryFaces_h
#define DeformVolumeBoundaryFaces_h

#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A face of a tetrahedron, which is opposite one of its nodes.
struct TetrahedronFace
{
  /// The number of the tetrahedron.
  std::int32_t Tetrahedron = 0;
  /// The node of the tetrahedron that is opposite the face, 0 to 3.
  std::int32_t Opposite = 0;

  /// Returns the nodes of the face, in their order in the tetrahedron. nodes: of the tetrahedron.
  std::array<std::int32_t, 3> GetNodes(const deformvolume::Tetrahedron& nodes) const
  {
    const auto at = [&](int k)
    { return nodes[static_cast<std::size_t>(k < this->Opposite ? k : k + 1)]; };
    return { { at(0), at(1), at(2) } };
  }
};

/// Finds the faces of a mesh that have tetrahedra on one side only, in ascending order of
/// tetrahedra. Faces are compared by the positions of their nodes at rest. Therefore two coincident
/// faces with tetrahedra on opposite sides are inside the mesh, even if their nodes differ, as
/// where the mesh is split. solid: the result of FindSolidTetrahedra(); other tetrahedra are
/// ignored.
std::vector<TetrahedronFace> FindBoundaryFaces(const std::vector<glm::dvec3>& points,
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<std::int32_t>& solid);

/// Returns the positions of the nodes of a face at rest, in ascending order. nodes: of the
/// tetrahedron.
std::array<glm::dvec3, 3> GetPositions(
  const TetrahedronFace& face, const std::vector<glm::dvec3>& points, const Tetrahedron& nodes);

/// Finds the tetrahedra that are not flat. Flat tetrahedra contain nothing, and their faces may
/// coincide.
std::vector<std::int32_t> FindSolidTetrahedra(
  const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra);

} // namespace deformvolume

#endif
