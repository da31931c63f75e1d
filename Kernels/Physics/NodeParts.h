// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeNodeParts_h
#define DeformVolumeNodeParts_h

#include "FaceNeighbors.h"
#include "Tetrahedron.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The parts into which a cut divides the tetrahedra around each node. Each part needs a node of
/// its own.
struct NodeParts
{
  /// The part of each corner of each tetrahedron: item 4 t + k is for corner k of tetrahedron t.
  /// The parts of a node are numbered from 0, in the order of the lowest tetrahedron of each part.
  std::vector<std::int32_t> PartOfCorner;
  /// The number of parts of each node minus 1.
  std::vector<std::int32_t> NumberOfCopies;
};

/// Finds the parts that are connected through faces which are not split. isSplit: for each face.
/// isWanted: for each node; other nodes have one part. `tetrahedra` must include all tetrahedra of
/// the wanted nodes.
NodeParts FindNodeParts(const std::vector<Tetrahedron>& tetrahedra, const FaceNeighbors& neighbors,
  const std::vector<unsigned char>& isSplit, const std::vector<unsigned char>& isWanted);

} // namespace deformvolume

#endif
