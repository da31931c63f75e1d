// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeNodeParts_h
#define DeformVolumeNodeParts_h

#include "FaceNeighbours.h"
#include "Tetrahedron.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The parts into which the tetrahedra of nodes fall, each of which needs a node of its own.
struct NodeParts
{
  /// The part that corner k of tetrahedron t, at 4 t + k, belongs to of those of its node: 0 for
  /// the part with the lowest tetrahedron, and so on.
  std::vector<std::int32_t> PartOfCorner;
  /// Of each node how many parts there are besides the first.
  std::vector<std::int32_t> NumberOfCopies;
};

/// The parts that hold together by faces which are not split. isSplit: of each face. isWanted: of
/// each node; others stay in one part. All tetrahedra of wanted nodes have to be there.
NodeParts FindNodeParts(const std::vector<Tetrahedron>& tetrahedra,
  const FaceNeighbours& neighbours, const std::vector<unsigned char>& isSplit,
  const std::vector<unsigned char>& isWanted);

} // namespace deformvolume

#endif
