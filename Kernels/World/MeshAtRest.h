// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshAtRest_h
#define DeformVolumeMeshAtRest_h

#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A deformation mesh at rest, which somebody else holds.
struct MeshAtRest
{
  /// The tetrahedra of the mesh.
  const std::vector<Tetrahedron>& Tetrahedra;
  /// The nodes in continuous indices of the volume.
  const std::vector<glm::dvec3>& Points;
  ///@{
  /// Who holds the mesh, and the version of its shape: together they tell it from all others.
  const void* Owner;
  std::uint64_t ShapeVersion;
  ///@}
};

} // namespace deformvolume

#endif
