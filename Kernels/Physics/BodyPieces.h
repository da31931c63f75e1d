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

class Watch;

/// The pieces of a body that hold together by faces of tetrahedra. Two pieces may still have nodes
/// in common: one, or two at a hinge, or more.
struct BodyPieces
{
  /// The piece of each tetrahedron.
  std::vector<std::int32_t> PieceOfTetrahedron;
  /// The tetrahedra of one piece after the other, and where those of each begin; one more is the
  /// end.
  std::vector<std::int32_t> Tetrahedra;
  /// Where the tetrahedra of each piece begin in Tetrahedra; one more is the end.
  std::vector<std::size_t> Begins;
  /// Of each node the lowest of its pieces; -1 for a node without a tetrahedron.
  std::vector<std::int32_t> PieceOfNode;
  /// Nodes with several pieces, each with one of these, the lowest included: sorted by nodes, and
  /// the other way round by pieces.
  std::vector<std::pair<std::int32_t, std::int32_t>> SharedNodes;
  /// Pairs of a piece and a node that it shares, sorted by pieces.
  std::vector<std::pair<std::int32_t, std::int32_t>> SharedByPieces;
  /// How many pieces there are.
  std::int32_t NumberOfPieces = 0;
};
/// watch: of the engine; asked now and then.
DEFORMVOLUME_EXPORT BodyPieces FindPieces(const ElasticBody& body, Watch* watch = nullptr);

/// A piece that is not held, but has nodes on a line, or one node, that others move: fixed nodes,
/// those of handles, and those that it shares with a piece that is held, or that follows itself.
struct FollowingPiece
{
  /// The number of the piece.
  std::int32_t Piece;
  /// A node of the piece that others move.
  std::int32_t First;
  /// Another such node; -1: there is none.
  std::int32_t Second;
};

/// Which pieces of a body are held, and which follow others.
struct PieceSupports
{
  /// Of each piece whether fixed nodes, those of handles and those that it shares with a held piece
  /// hold it: at least three of them that lie on no common line, or together with nodes that slide
  /// what leaves it no motion of a rigid body.
  std::vector<bool> IsHeld;
  /// Of the others those that follow, each after what it follows. What is neither held nor follows
  /// has no such node.
  std::vector<FollowingPiece> Following;
};
/// isNotFree: a byte a node, not 0 where it is fixed or held by a handle.
DEFORMVOLUME_EXPORT PieceSupports FindSupports(
  const ElasticBody& body, const BodyPieces& pieces, const std::vector<unsigned char>& isNotFree);

/// Moves the pieces that follow like rigid bodies, as their nodes of support say. isPlaced: nodes
/// that are where they belong already; those of the pieces are added. Where a piece has two such
/// nodes it is turned on the shortest way.
DEFORMVOLUME_EXPORT void MoveFollowing(const ElasticBody& body, const BodyPieces& pieces,
  const std::vector<FollowingPiece>& following, std::vector<unsigned char>& isPlaced,
  std::vector<glm::dvec3>& displacements);

} // namespace deformvolume

#endif
