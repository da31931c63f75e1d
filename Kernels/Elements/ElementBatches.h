// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeElementBatches_h
#define DeformVolumeElementBatches_h

#include "AbortCheck.h"
#include "ElasticBody.h"
#include "Lanes.h"
#include "QuadraticTetrahedron.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The two ends of each edge of a tetrahedron of a batch, in the order of its mid-side nodes.
constexpr int BatchEdges[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 }, { 1, 3 }, { 2, 3 } };

/// The mid-side node of the edge between two corners of a batch.
constexpr int BatchMiddle[4][4] = { { -1, 4, 5, 6 }, { 4, -1, 7, 8 }, { 5, 7, -1, 9 },
  { 6, 8, 9, -1 } };

/// Ten-node tetrahedra, one in each lane. An empty lane holds a copy of another tetrahedron with
/// volume 0.
struct ElementBatch
{
  static constexpr int NumberOfNodes = QuadraticTetrahedron::NumberOfNodes;
  static constexpr int NumberOfGaussPoints = QuadraticTetrahedron::NumberOfGaussPoints;

  /// The corners in ascending order of their numbers, then the mid-side nodes in the order of
  /// BatchEdges.
  std::int32_t Nodes[NumberOfNodes][NumberOfLanes];
  /// The gradients of the barycentric coordinates of the last three corners with respect to the
  /// rest position, at each Gauss point, in 1/m.
  LaneVector Gradients[NumberOfGaussPoints][3];
  /// The volume of each Gauss point, in m^3.
  Lanes Volumes[NumberOfGaussPoints];
  /// 1 divided by the sum of Volumes; 0 for an empty lane.
  Lanes InverseVolume;
  /// The Lame parameters, in Pa. The part of lambda above 4 mu (Poisson ratios above 0.4) is
  /// MeanLambda. MeanLambda acts on the mean dilatation of the tetrahedron only, to avoid
  /// volumetric locking.
  Lanes Mu;
  Lanes Lambda;
  Lanes MeanLambda;
};

/// The tetrahedra of a body in batches. Consecutive batches form chunks. Chunks of the same color
/// have no node in common, so they can be handled in parallel. Contributions to a node are always
/// added in the same order, for any number of threads.
struct ElementBatches
{
  /// The number of batches in a chunk; the last chunk may have fewer.
  static constexpr std::size_t ChunkSize = 8;

  std::vector<ElementBatch> Batches;
  /// The tetrahedron in each lane of each batch; -1 for an empty lane.
  std::vector<std::int32_t> Tetrahedra;
  /// The chunks of each color.
  std::vector<std::vector<std::uint32_t>> Colors;

  std::size_t GetNumberOfChunks() const
  {
    return (this->Batches.size() + ChunkSize - 1) / ChunkSize;
  }
};

/// Makes batches of the tetrahedra of a body, which must have mid-side nodes.
ElementBatches MakeElementBatches(AbortCheck& abortCheck, const ElasticBody& body);

/// Chooses the pieces of a body whose tetrahedra are active. The tetrahedra of other pieces exert
/// no forces, and do not count as inverted. isActive: for each piece.
void SetActivePieces(ElementBatches& batches, const ElasticBody& body,
  const std::vector<std::int32_t>& pieceOfTetrahedron, const std::vector<bool>& isActive);

/// Sets the material parameters from a body.
void SetMaterials(ElementBatches& batches, const ElasticBody& body);

} // namespace deformvolume

#endif
