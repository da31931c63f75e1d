// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLatticeBody_h
#define DeformVolumeLatticeBody_h

#include "ElasticBody.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>

/// A lattice of nodes that begins at the origin. Each cell has five tetrahedra, which are mirrored
/// from cell to cell like those of the sampling mesh. Every tetrahedron has a positive volume.
struct LatticeBody
{
  using Place = std::array<std::int32_t, 3>;

  LatticeBody(const Place& nodes, double spacing, const deformvolume::ElasticMaterial& material);

  std::int32_t GetNode(const Place& place) const
  {
    return (place[2] * this->Nodes[1] + place[1]) * this->Nodes[0] + place[0];
  }

  /// Fixes the nodes for which the function returns true.
  void Fix(const std::function<bool(const Place&)>& isFixed);

  /// Calls the function for all nodes.
  void ForNodes(const std::function<void(const Place&, std::int32_t node)>& visit) const;

  Place Nodes;
  double Spacing;
  deformvolume::ElasticBody Body;
};

namespace physicsTesting
{

/// Makes such a body with a different spacing on each axis.
deformvolume::ElasticBody MakeLatticeBody(const LatticeBody::Place& nodes,
  const glm::dvec3& spacing, const deformvolume::ElasticMaterial& material = {});

/// Returns the node with a structured index in such a body.
inline std::size_t GetNode(const LatticeBody::Place& nodes, int x, int y, int z)
{
  return static_cast<std::size_t>(x + nodes[0] * (y + nodes[1] * z));
}

/// Fixes the nodes for whose positions the function returns true.
void FixNodes(
  deformvolume::ElasticBody& body, const std::function<bool(const glm::dvec3&)>& isFixed);

} // namespace physicsTesting

#endif
