// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLatticeBody_h
#define DeformVolumeLatticeBody_h

#include "ElasticBody.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>

/// A lattice of nodes from the origin on, and five tetrahedra in each of its cells, mirrored from
/// cell to cell as those of the sampling mesh are. Every tetrahedron has a volume greater than 0.
struct LatticeBody
{
  using Place = std::array<std::int32_t, 3>;

  LatticeBody(const Place& nodes, double spacing, const deformvolume::ElasticMaterial& material);

  std::int32_t GetNode(const Place& place) const
  {
    return (place[2] * this->Nodes[1] + place[1]) * this->Nodes[0] + place[0];
  }

  /// Holds the nodes at rest for which this is true.
  void Fix(const std::function<bool(const Place&)>& isFixed);

  /// Calls this for all nodes.
  void ForNodes(const std::function<void(const Place&, std::int32_t node)>& visit) const;

  Place Nodes;
  double Spacing;
  deformvolume::ElasticBody Body;
};

namespace physicsTesting
{

/// The same where distances differ from axis to axis.
deformvolume::ElasticBody MakeLatticeBody(const LatticeBody::Place& nodes,
  const glm::dvec3& spacing, const deformvolume::ElasticMaterial& material = {});

/// The node at a place of such a body.
inline std::size_t GetNode(const LatticeBody::Place& nodes, int x, int y, int z)
{
  return static_cast<std::size_t>(x + nodes[0] * (y + nodes[1] * z));
}

/// Holds the nodes at rest whose positions a function chooses.
void FixNodes(
  deformvolume::ElasticBody& body, const std::function<bool(const glm::dvec3&)>& isFixed);

} // namespace physicsTesting

#endif
