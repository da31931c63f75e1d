// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeElementBatches_h
#define DeformVolumeElementBatches_h

#include "ElasticBody.h"
#include "Lanes.h"
#include "Watch.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// As many tetrahedra as there are lanes. Where a lane has none, it repeats another one without a
/// volume.
struct ElementBatch
{
  /// In rising order, so that a block of a matrix that belongs to two of them, the first one before
  /// the second one, is above the diagonal.
  std::int32_t Nodes[4][NumberOfLanes];
  /// By how much the weights of the last three nodes change with the place at rest, in 1/m.
  LaneVector Gradients[3];
  /// In m^3.
  Lanes Volume;
  /// In Pa.
  Lanes Mu;
  Lanes Lambda;
};

/// The tetrahedra of a body in batches, and which of these may be worked on side by side: batches
/// make chunks, and chunks of one color have no node in common. What is added at a node is added
/// in the same order whatever the threads do.
struct ElementBatches
{
  /// Batches of a chunk, but for the last one.
  static constexpr std::size_t ChunkSize = 32;

  std::vector<ElementBatch> Batches;
  /// The tetrahedron in each lane of each batch; -1: none.
  std::vector<std::int32_t> Tetrahedra;
  /// Chunks by color.
  std::vector<std::vector<std::uint32_t>> Colors;

  std::size_t GetNumberOfChunks() const
  {
    return (this->Batches.size() + ChunkSize - 1) / ChunkSize;
  }
};

ElementBatches MakeElementBatches(Watch& watch, const ElasticBody& body);

/// Leaves out the tetrahedra of some pieces of a body: they exert no forces, and do not count as
/// inverted. isActive: of each piece whether its tetrahedra are there.
void SetActivePieces(ElementBatches& batches, const ElasticBody& body,
  const std::vector<std::int32_t>& pieceOfTetrahedron, const std::vector<bool>& isActive);

/// Takes over the materials of a body.
void SetMaterials(ElementBatches& batches, const ElasticBody& body);

} // namespace deformvolume

#endif
