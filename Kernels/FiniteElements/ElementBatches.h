// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeElementBatches_h
#define DeformVolumeElementBatches_h

#include "ElasticBody.h"
#include "Lanes.h"
#include "QuadraticTetrahedron.h"
#include "Watch.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The ends of the edges of a tetrahedron of a batch, in the order of its mid-side nodes.
constexpr int BatchEdges[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 }, { 1, 3 }, { 2, 3 } };

/// The node of a batch in the middle of the edge between two corners.
constexpr int BatchMiddle[4][4] = { { -1, 4, 5, 6 }, { 4, -1, 7, 8 }, { 5, 7, -1, 9 },
  { 6, 8, 9, -1 } };

/// As many ten-node tetrahedra as there are lanes. Where a lane has none, it repeats another one
/// without a volume.
struct ElementBatch
{
  static constexpr int NumberOfNodes = QuadraticTetrahedron::NumberOfNodes;
  static constexpr int NumberOfGaussPoints = QuadraticTetrahedron::NumberOfGaussPoints;

  /// First the corners in rising order, then the nodes in the middle of BatchEdges.
  std::int32_t Nodes[NumberOfNodes][NumberOfLanes];
  /// By how much the coordinates of the last three corners change with the place at rest, at each
  /// Gauss point, in 1/m.
  LaneVector Gradients[NumberOfGaussPoints][3];
  /// Of each Gauss point, in m^3.
  Lanes Volumes[NumberOfGaussPoints];
  /// 1 by their sum; 0 where there is no volume.
  Lanes InverseVolume;
  /// In Pa. What of lambda is more than 4 mu, as for Poisson ratios of more than 0.4, acts on the
  /// mean dilatation of the tetrahedron only: otherwise it hardly bends any more.
  Lanes Mu;
  Lanes Lambda;
  Lanes MeanLambda;
};

/// The tetrahedra of a body in batches, and which of these may be worked on side by side: batches
/// make chunks, and chunks of one color have no node in common. What is added at a node is added
/// in the same order whatever the threads do.
struct ElementBatches
{
  /// Batches of a chunk, but for the last one.
  static constexpr std::size_t ChunkSize = 8;

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

/// The body needs mid-side nodes.
ElementBatches MakeElementBatches(Watch& watch, const ElasticBody& body);

/// Leaves out the tetrahedra of some pieces of a body: they exert no forces, and do not count as
/// inverted. isActive: of each piece whether its tetrahedra are there.
void SetActivePieces(ElementBatches& batches, const ElasticBody& body,
  const std::vector<std::int32_t>& pieceOfTetrahedron, const std::vector<bool>& isActive);

/// Takes over the materials of a body.
void SetMaterials(ElementBatches& batches, const ElasticBody& body);

} // namespace deformvolume

#endif
