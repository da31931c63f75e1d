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

/// A face of a tetrahedron: the one opposite to one of its nodes.
struct TetrahedronFace
{
  /// The number of the tetrahedron.
  std::int32_t Tetrahedron = 0;
  /// Which of its nodes is opposite to the face, 0 to 3.
  std::int32_t Opposite = 0;

  /// Its nodes, in the order in which the tetrahedron has them.
  std::array<std::int32_t, 3> GetNodes(const deformvolume::Tetrahedron& nodes) const
  {
    const auto at = [&](int k)
    { return nodes[static_cast<std::size_t>(k < this->Opposite ? k : k + 1)]; };
    return { { at(0), at(1), at(2) } };
  }
};

/// The faces of a mesh that have tetrahedra on one side only, by their places at rest: where the
/// mesh is split, or its parts were never joined, faces of different nodes in one place are inside
/// it. solid: FindSolidTetrahedra; others count as none. In ascending order of tetrahedra.
std::vector<TetrahedronFace> FindBoundaryFaces(const std::vector<glm::dvec3>& points,
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<std::int32_t>& solid);

/// The places of a face's nodes at rest, in ascending order. nodes: those of the tetrahedron.
std::array<glm::dvec3, 3> GetPlaces(
  const TetrahedronFace& face, const std::vector<glm::dvec3>& points, const Tetrahedron& nodes);

/// The tetrahedra that are not flat: flat ones hold nothing, and their faces may be in one place.
std::vector<std::int32_t> FindSolidTetrahedra(
  const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra);

} // namespace deformvolume

#endif
