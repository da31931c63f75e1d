// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshAtRest_h
#define DeformVolumeMeshAtRest_h

#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A view of a deformation mesh at rest. The data must outlive this object.
struct MeshAtRest
{
  /// The tetrahedra of the mesh.
  const std::vector<Tetrahedron>& Tetrahedra;
  /// The positions of the nodes, in continuous indices of the volume.
  const std::vector<glm::dvec3>& Points;
  ///@{
  /// The owner of the mesh, and the version of its shape. Together they identify the mesh.
  const void* Owner;
  std::uint64_t ShapeVersion;
  ///@}
  /// Changes if the shape, the nodes of a tetrahedron or the number of nodes changes.
  std::uint64_t ConnectivityVersion;
};

} // namespace deformvolume

#endif
