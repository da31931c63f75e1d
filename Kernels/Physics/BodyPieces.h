// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBodyPieces_h
#define DeformVolumeBodyPieces_h

#include "DeformVolumeExport.h"
#include "ElasticBody.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <utility>
#include <vector>

namespace deformvolume
{

class AbortCheck;

/// The pieces of a body: tetrahedra that are connected through faces. Two pieces can still share
/// one node, two nodes (a hinge) or more.
struct BodyPieces
{
  /// The piece of each tetrahedron.
  std::vector<std::int32_t> PieceOfTetrahedron;
  /// The tetrahedra, sorted by pieces.
  std::vector<std::int32_t> Tetrahedra;
  /// Index in Tetrahedra of the first tetrahedron of each piece. The last value is the end.
  std::vector<std::size_t> Begins;
  /// The lowest piece of each node; -1 for a node without a tetrahedron.
  std::vector<std::int32_t> PieceOfNode;
  /// Pairs of a node and a piece, for nodes that belong to several pieces, sorted by nodes. A node
  /// has one pair for each of its pieces, the lowest one included.
  std::vector<std::pair<std::int32_t, std::int32_t>> SharedNodes;
  /// The same pairs as a piece and a node, sorted by pieces.
  std::vector<std::pair<std::int32_t, std::int32_t>> SharedByPieces;
  /// The number of pieces.
  std::int32_t NumberOfPieces = 0;
};
/// Finds the pieces of a body. abortCheck: checks for an abort. Callers outside the engine pass
/// null.
DEFORMVOLUME_EXPORT BodyPieces FindBodyPieces(
  const ElasticBody& body, AbortCheck* abortCheck = nullptr);

/// A piece that is not held, but has supporting nodes: one node, or several on a line. Supporting
/// nodes are fixed, held by handles, or shared with a piece that is held or that follows other
/// pieces.
struct FollowingPiece
{
  /// The number of the piece.
  std::int32_t Piece;
  /// A supporting node of the piece.
  std::int32_t First;
  /// Another supporting node; -1 if there is none.
  std::int32_t Second;
};

/// Which pieces of a body are held, and which follow others.
struct PieceSupports
{
  /// Whether each piece is held. A piece is held if at least three of its supporting nodes lie on
  /// no common line, or if its supporting nodes and sliding nodes together prevent all rigid-body
  /// motions.
  std::vector<bool> IsHeld;
  /// The pieces that are not held, but follow other pieces, sorted so that each piece comes after
  /// the pieces that it follows. Pieces that have no supporting node are neither held nor listed
  /// here.
  std::vector<FollowingPiece> Following;
};
/// Finds which pieces cannot move as rigid bodies, and in which order the others follow.
/// isConstrained: one byte for each node, not 0 if the node is fixed or held by a handle.
DEFORMVOLUME_EXPORT PieceSupports FindSupports(const ElasticBody& body, const BodyPieces& pieces,
  const std::vector<unsigned char>& isConstrained);

/// Moves each following piece like a rigid body, so that its supporting nodes keep their
/// displacements. A piece with two supporting nodes is rotated by the smallest possible angle.
/// isSettled: nodes that already have their final displacement; the nodes of the moved pieces are
/// added.
DEFORMVOLUME_EXPORT void MoveFollowing(const ElasticBody& body, const BodyPieces& pieces,
  const std::vector<FollowingPiece>& following, std::vector<unsigned char>& isSettled,
  std::vector<glm::dvec3>& displacements);

/// Returns for each piece whether it is free: neither held nor following others.
DEFORMVOLUME_EXPORT std::vector<bool> FindFreePieces(const PieceSupports& supports);

/// Gives free pieces their shape at rest again, each at the place that fits its displacements best.
/// Pieces that share nodes are fitted together. Sliding nodes may leave their planes.
DEFORMVOLUME_EXPORT void MakePiecesRigid(const ElasticBody& body, const BodyPieces& pieces,
  const std::vector<bool>& isFree, std::vector<glm::dvec3>& displacements);

} // namespace deformvolume

#endif
