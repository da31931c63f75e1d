// SPDX-License-Identifier: BSD-3-Clause
#ifndef LatticeBody_h
#define LatticeBody_h

#include "ElasticBody.h"

#include <array>
#include <cstddef>
#include <functional>

namespace physicsTesting
{

/// A box of nodes at equal distances, with cells of five tetrahedra each, mirrored from cell to
/// cell; all tetrahedra go round the same way.
deformvolume::ElasticBody MakeLatticeBody(const std::array<int, 3>& nodes,
  const glm::dvec3& spacing, const deformvolume::ElasticMaterial& material = {});

/// The node at a place of such a box.
inline std::size_t GetNode(const std::array<int, 3>& nodes, int x, int y, int z)
{
  return static_cast<std::size_t>(x + nodes[0] * (y + nodes[1] * z));
}

/// Fixes the nodes that a function chooses by their positions.
void FixNodes(
  deformvolume::ElasticBody& body, const std::function<bool(const glm::dvec3&)>& isFixed);

} // namespace physicsTesting

#endif
