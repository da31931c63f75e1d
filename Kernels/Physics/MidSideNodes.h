// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMidSideNodes_h
#define DeformVolumeMidSideNodes_h

#include "DeformVolumeExport.h"
#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

struct ElasticBody;

/// The mid-side nodes of a ten-node tetrahedron, in the order of TetrahedronEdges.
/// vtkQuadraticTetra has the same order.
using MidSideNodes = std::array<std::int32_t, 6>;

/// The corners at the two ends of each edge of a tetrahedron.
constexpr std::size_t TetrahedronEdges[6][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 }, { 0, 3 }, { 1, 3 },
  { 2, 3 } };

/// Makes ten-node tetrahedra: appends a node in the middle of each edge that has no mid-side node.
/// An existing mid-side node is kept; -1 in MidSides stands for a missing one. A new node is fixed
/// if both ends of its edge are fixed. Returns the ends of the edge of each new node.
///
/// New nodes are numbered by the lower end of their edge, then by the other end.
///
/// forces: of the nodes; empty or null: none. Gets the forces of the new nodes. A uniform traction
/// on a face of ten-node tetrahedra acts on its mid-side nodes only, in equal parts. So the force
/// of a corner is passed on to the mid-side nodes of the boundary faces of four-node tetrahedra
/// that have forces at all three corners. Each of these faces gets a part that is proportional to
/// its area. The forces of other corners do not change.
///
/// Throws an Error if tetrahedra have different mid-side nodes for one edge.
DEFORMVOLUME_EXPORT std::vector<std::array<std::int32_t, 2>> AddMidSideNodes(
  ElasticBody& body, std::vector<glm::dvec3>* forces = nullptr);

/// Splits mid-side nodes after a cut (SplitMesh). Tetrahedra that still share an edge share its
/// mid-side node. Where one edge became several, the first tetrahedron keeps the node, and the
/// other edges get copies. Returns for each copy the node that it is a copy of. The first copy has
/// the number numberOfNodes.
///
/// tetrahedra: with their new corners. midSides: input as before the cut; output as after it.
DEFORMVOLUME_EXPORT std::vector<std::int32_t> SplitMidSideNodes(
  const std::vector<Tetrahedron>& tetrahedra, std::int32_t numberOfNodes,
  std::vector<MidSideNodes>& midSides);

} // namespace deformvolume

#endif
