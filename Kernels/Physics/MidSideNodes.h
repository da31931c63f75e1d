// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMidSideNodes_h
#define DeformVolumeMidSideNodes_h

#include "DeformVolumeExport.h"
#include "Tetrahedron.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

struct ElasticBody;

/// The nodes in the middle of the edges of a ten-node tetrahedron, in the order of
/// TetrahedronEdges, which is that of vtkQuadraticTetra.
using MidSideNodes = std::array<std::int32_t, 6>;

/// The corners at the ends of the edges of a tetrahedron.
constexpr std::size_t TetrahedronEdges[6][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 }, { 0, 3 }, { 1, 3 },
  { 2, 3 } };

/// Makes ten-node tetrahedra of those of a body: appends a node in the middle of each edge that has
/// none. Nodes that the body has in MidSides stay; there, -1 is an edge without one. New nodes are
/// fixed where both ends are. Returns the ends of the edge of each new node.
///
/// The new nodes are numbered by the ends of their edges, the lower one first.
///
/// Throws an Error where an edge has two different nodes in its middle.
DEFORMVOLUME_EXPORT std::vector<std::array<std::int32_t, 2>> AddMidSideNodes(ElasticBody& body);

/// After a cut has given tetrahedra other corners (SplitMesh): edges between the same two corners
/// have one node in their middle, and what was one edge before gets copies of its node. The first
/// tetrahedron with a node keeps it. Returns of each copy the node that it is a copy of; copies are
/// numbered from a number of nodes on.
///
/// tetrahedra: with their new corners. midSides: as before the cut; changed.
DEFORMVOLUME_EXPORT std::vector<std::int32_t> SplitMidSides(
  const std::vector<Tetrahedron>& tetrahedra, std::int32_t numberOfNodes,
  std::vector<MidSideNodes>& midSides);

} // namespace deformvolume

#endif
