// SPDX-License-Identifier: BSD-3-Clause
#include "BodyPieces.h"

#include "AbortCheck.h"
#include "CountedLists.h"
#include "DisjointSets.h"
#include "FaceNeighbors.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace deformvolume
{
namespace
{

void FindNodes(const ElasticBody& body, BodyPieces& pieces)
{
  pieces.PieceOfNode.assign(body.Points.size(), -1);
  for (std::size_t t = 0; t < body.Tetrahedra.size(); ++t)
  {
    const std::int32_t here = pieces.PieceOfTetrahedron[t];
    body.ForNodes(t,
      [&](std::int32_t node)
      {
        std::int32_t& piece = pieces.PieceOfNode[static_cast<std::size_t>(node)];
        if (piece >= 0 && piece != here)
        {
          pieces.SharedNodes.emplace_back(node, piece);
          pieces.SharedNodes.emplace_back(node, here);
        }
        piece = piece < 0 ? here : std::min(piece, here);
      });
  }
  std::vector<std::pair<std::int32_t, std::int32_t>>& shared = pieces.SharedNodes;
  std::sort(shared.begin(), shared.end());
  shared.erase(std::unique(shared.begin(), shared.end()), shared.end());
  for (const auto& [node, piece] : shared)
  {
    pieces.SharedByPieces.emplace_back(piece, node);
  }
  std::sort(pieces.SharedByPieces.begin(), pieces.SharedByPieces.end());
}

void SortTetrahedra(BodyPieces& pieces)
{
  MakeLists(
    static_cast<std::size_t>(pieces.NumberOfPieces),
    [&](const auto& take)
    {
      for (std::size_t t = 0; t < pieces.PieceOfTetrahedron.size(); ++t)
      {
        take(static_cast<std::size_t>(pieces.PieceOfTetrahedron[t]), static_cast<std::int32_t>(t));
      }
    },
    pieces.Begins, pieces.Tetrahedra);
}

// Calls take(second) for all pairs whose first number is `first`.
template <typename Take>
void ForPairs(
  const std::vector<std::pair<std::int32_t, std::int32_t>>& pairs, std::int32_t first, Take&& take)
{
  const auto isBefore = [](const auto& pair, std::int32_t number) { return pair.first < number; };
  for (auto pair = std::lower_bound(pairs.begin(), pairs.end(), first, isBefore);
       pair != pairs.end() && pair->first == first; ++pair)
  {
    take(pair->second);
  }
}

// Finds whether planes prevent all six rigid-body motions. A plane prevents its point from moving
// along its normal.
class PlaneSupport
{
public:
  void Add(const glm::dvec3& point, const glm::dvec3& normal)
  {
    this->Points.push_back(point);
    this->Normals.push_back(normal);
  }

  // Whether all motions are prevented, by more than the rounding of normals and coordinates.
  // Translations and rotations have different units, so a rotation is measured by the farthest
  // point from its axis. A slender body is also held by the levers across its length, but not by
  // those of points that lie on a line up to rounding.
  bool Holds() const
  {
    constexpr double leastShare = 0.1; // of the extent of the points
    if (this->Points.size() < 6)
    {
      return false;
    }
    const auto columns = static_cast<Eigen::Index>(this->Points.size());
    Eigen::Matrix3Xd points = Eigen::Map<const Eigen::Matrix3Xd>(&this->Points[0].x, 3, columns);
    points.colwise() -= points.rowwise().mean().eval();
    const Eigen::Matrix3d axes =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(points * points.transpose()).eigenvectors();
    points = axes.transpose() * points;
    Eigen::Matrix<double, 6, Eigen::Dynamic> motions(6, columns);
    motions.topRows<3>() =
      axes.transpose() * Eigen::Map<const Eigen::Matrix3Xd>(&this->Normals[0].x, 3, columns);
    const double extent = points.colwise().norm().maxCoeff();
    if (!(extent > 0.0))
    {
      return false;
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      const auto y = points.row((axis + 1) % 3).array();
      const auto z = points.row((axis + 2) % 3).array();
      const double scale =
        std::max((y.square() + z.square()).sqrt().maxCoeff(), leastShare * extent);
      motions.row(3 + axis) =
        (y * motions.row((axis + 2) % 3).array() - z * motions.row((axis + 1) % 3).array()) / scale;
    }
    Eigen::ColPivHouseholderQR<Eigen::Matrix<double, 6, Eigen::Dynamic>> factors(motions);
    factors.setThreshold(ElasticBody::ParallelSine);
    return factors.rank() == 6;
  }

private:
  std::vector<glm::dvec3> Points;
  std::vector<glm::dvec3> Normals;
};

// The supporting nodes of a piece: the first two, and whether they hold the piece.
class Support
{
public:
  // Adds a sliding node. Add all sliding nodes before the supporting nodes.
  void AddSliding(const glm::dvec3& point, const glm::dvec3& normal)
  {
    this->Slides = true;
    this->Planes.Add(point, normal);
  }

  void Add(const std::vector<glm::dvec3>& points, std::int32_t node)
  {
    const auto at = [&](std::int32_t i) { return points[static_cast<std::size_t>(i)]; };
    if (this->Slides)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        glm::dvec3 normal(0.0);
        normal[axis] = 1.0;
        this->Planes.Add(at(node), normal);
      }
    }
    if (this->Nodes[0] < 0)
    {
      this->Nodes[0] = node;
      return;
    }
    const glm::dvec3 offset = at(node) - at(this->Nodes[0]);
    if (this->Nodes[1] < 0)
    {
      this->Nodes[1] = glm::length(offset) > 0.0 ? node : -1;
      return;
    }
    const glm::dvec3 along = at(this->Nodes[1]) - at(this->Nodes[0]);
    // Points on a line lie on it only up to the rounding of floats.
    this->IsStiff = this->IsStiff ||
      glm::length(glm::cross(offset, along)) >
        ElasticBody::ParallelSine * glm::length(offset) * glm::length(along);
  }

  bool Holds() const { return this->IsStiff || (this->Slides && this->Planes.Holds()); }

  std::array<std::int32_t, 2> Nodes{ { -1, -1 } };

private:
  bool IsStiff = false;
  bool Slides = false;
  PlaneSupport Planes;
};

// Rotates a vector by the smallest rotation that turns the unit vector `from` into `to`.
glm::dvec3 RotateBetween(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& vector)
{
  const glm::dvec3 axis = glm::cross(from, to);
  const double cosine = glm::dot(from, to);
  constexpr double opposite = -1.0 + 1e-12;
  if (cosine > opposite)
  {
    return vector + glm::cross(axis, vector) +
      glm::cross(axis, glm::cross(axis, vector)) / (1.0 + cosine);
  }
  // Opposite directions: rotate by 180 degrees about any axis normal to `from`.
  const glm::dvec3 other = std::abs(from.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 across = glm::normalize(glm::cross(from, other));
  return 2.0 * glm::dot(across, vector) * across - vector;
}

} // namespace

BodyPieces FindBodyPieces(const ElasticBody& body, AbortCheck* abortCheck)
{
  AbortCheck none(nullptr);
  AbortCheck& given = abortCheck ? *abortCheck : none;
  const FaceNeighbors neighbors(body.Tetrahedra, body.Points.size(), &given);
  given.Check();
  DisjointSets<std::int32_t> sets(body.Tetrahedra.size());
  ForItems(given, body.Tetrahedra.size(),
    [&](std::size_t t)
    {
      for (std::size_t face = 4 * t; face < 4 * t + 4; ++face)
      {
        sets.Unite(
          static_cast<std::int32_t>(t), static_cast<std::int32_t>(neighbors.GetNext(face) / 4));
      }
    });
  BodyPieces pieces;
  pieces.PieceOfTetrahedron.resize(body.Tetrahedra.size());
  for (std::size_t t = 0; t < body.Tetrahedra.size(); ++t)
  {
    // The root of a set is its lowest tetrahedron.
    const auto root = static_cast<std::size_t>(sets.Find(static_cast<std::int32_t>(t)));
    pieces.PieceOfTetrahedron[t] =
      root == t ? pieces.NumberOfPieces++ : pieces.PieceOfTetrahedron[root];
  }
  given.Check();
  SortTetrahedra(pieces);
  given.Check();
  FindNodes(body, pieces);
  given.Check();
  return pieces;
}

PieceSupports FindSupports(const ElasticBody& body, const BodyPieces& pieces,
  const std::vector<unsigned char>& isConstrained)
{
  const auto number = static_cast<std::size_t>(pieces.NumberOfPieces);
  std::vector<Support> supports(number);
  const bool slides = !body.SlidingNormals.empty() || !body.SecondSlidingNormals.empty();
  for (std::size_t node = 0; node < body.Points.size() && slides; ++node)
  {
    if (isConstrained[node] != 0 || pieces.PieceOfNode[node] < 0)
    {
      continue;
    }
    for (const glm::dvec3& normal : GetSlidingNormals(body, node))
    {
      const auto slide = [&](std::int32_t piece)
      { supports[static_cast<std::size_t>(piece)].AddSliding(body.Points[node], normal); };
      if (normal == glm::dvec3(0.0))
      {
        continue;
      }
      slide(pieces.PieceOfNode[node]);
      ForPairs(pieces.SharedNodes, static_cast<std::int32_t>(node),
        [&](std::int32_t piece)
        {
          if (piece != pieces.PieceOfNode[node])
          {
            slide(piece);
          }
        });
    }
  }
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    if (isConstrained[node] != 0 && pieces.PieceOfNode[node] >= 0)
    {
      supports[static_cast<std::size_t>(pieces.PieceOfNode[node])].Add(
        body.Points, static_cast<std::int32_t>(node));
    }
  }
  for (const auto& [node, piece] : pieces.SharedNodes)
  {
    if (isConstrained[static_cast<std::size_t>(node)] != 0)
    {
      supports[static_cast<std::size_t>(piece)].Add(body.Points, node);
    }
  }
  // Takes all pieces whose support satisfies isNext, and calls take for each of them. The shared
  // nodes of a taken piece then support its neighbors, so these neighbors are tried again.
  std::vector<bool> isTaken(number, false);
  std::vector<bool> isSettled(body.Points.size(), false);
  const auto spread = [&](auto&& isNext, auto&& take)
  {
    std::vector<std::int32_t> open(number);
    std::iota(open.begin(), open.end(), 0);
    for (std::size_t i = 0; i < open.size(); ++i)
    {
      const std::int32_t piece = open[i];
      if (isTaken[static_cast<std::size_t>(piece)] ||
        !isNext(supports[static_cast<std::size_t>(piece)]))
      {
        continue;
      }
      isTaken[static_cast<std::size_t>(piece)] = true;
      take(piece);
      ForPairs(pieces.SharedByPieces, piece,
        [&](std::int32_t node)
        {
          if (isSettled[static_cast<std::size_t>(node)])
          {
            return;
          }
          isSettled[static_cast<std::size_t>(node)] = true;
          ForPairs(pieces.SharedNodes, node,
            [&](std::int32_t other)
            {
              supports[static_cast<std::size_t>(other)].Add(body.Points, node);
              open.push_back(other);
            });
        });
    }
  };
  PieceSupports result;
  spread([](const Support& support) { return support.Holds(); }, [](std::int32_t) {});
  result.IsHeld = isTaken;
  spread([](const Support& support) { return support.Nodes[0] >= 0; },
    [&](std::int32_t piece)
    {
      const std::array<std::int32_t, 2>& nodes = supports[static_cast<std::size_t>(piece)].Nodes;
      result.Following.push_back({ piece, nodes[0], nodes[1] });
    });
  return result;
}

void MoveFollowing(const ElasticBody& body, const BodyPieces& pieces,
  const std::vector<FollowingPiece>& following, std::vector<unsigned char>& isSettled,
  std::vector<glm::dvec3>& displacements)
{
  for (const FollowingPiece& follower : following)
  {
    const auto first = static_cast<std::size_t>(follower.First);
    const glm::dvec3 origin = body.Points[first];
    const glm::dvec3 moved = origin + displacements[first];
    glm::dvec3 from(1.0, 0.0, 0.0);
    glm::dvec3 to = from;
    if (follower.Second >= 0)
    {
      const auto second = static_cast<std::size_t>(follower.Second);
      from = glm::normalize(body.Points[second] - origin);
      const glm::dvec3 along = body.Points[second] + displacements[second] - moved;
      to = glm::length(along) > 0.0 ? glm::normalize(along) : from;
    }
    const auto piece = static_cast<std::size_t>(follower.Piece);
    for (std::size_t i = pieces.Begins[piece]; i < pieces.Begins[piece + 1]; ++i)
    {
      body.ForNodes(static_cast<std::size_t>(pieces.Tetrahedra[i]),
        [&](std::int32_t number)
        {
          const auto node = static_cast<std::size_t>(number);
          if (isSettled[node] == 0)
          {
            isSettled[node] = 1;
            displacements[node] =
              moved + RotateBetween(from, to, body.Points[node] - origin) - body.Points[node];
          }
        });
    }
  }
}

std::vector<bool> FindFreePieces(const PieceSupports& supports)
{
  std::vector<bool> isFree(supports.IsHeld);
  isFree.flip();
  for (const FollowingPiece& follower : supports.Following)
  {
    isFree[static_cast<std::size_t>(follower.Piece)] = false;
  }
  return isFree;
}

void MakePiecesRigid(const ElasticBody& body, const BodyPieces& pieces,
  const std::vector<bool>& isFree, std::vector<glm::dvec3>& displacements)
{
  DisjointSets<std::int32_t> sets(isFree.size());
  for (const auto& [node, piece] : pieces.SharedNodes)
  {
    sets.Unite(piece, pieces.PieceOfNode[static_cast<std::size_t>(node)]);
  }
  std::vector<std::vector<std::size_t>> nodesOfSets(isFree.size());
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    const std::int32_t piece = pieces.PieceOfNode[node];
    if (piece >= 0 && isFree[static_cast<std::size_t>(piece)])
    {
      nodesOfSets[static_cast<std::size_t>(sets.Find(piece))].push_back(node);
    }
  }
  // A motion that is rigid up to rounding does not change.
  constexpr double rounding = 1e-9;
  for (const std::vector<std::size_t>& nodes : nodesOfSets)
  {
    if (nodes.empty())
    {
      continue;
    }
    const auto number = static_cast<Eigen::Index>(nodes.size());
    Eigen::Matrix3Xd rest(3, number);
    Eigen::Matrix3Xd moved(3, number);
    for (Eigen::Index i = 0; i < number; ++i)
    {
      const std::size_t node = nodes[static_cast<std::size_t>(i)];
      rest.col(i) = Eigen::Map<const Eigen::Vector3d>(&body.Points[node].x);
      moved.col(i) = rest.col(i) + Eigen::Map<const Eigen::Vector3d>(&displacements[node].x);
    }
    const Eigen::Matrix4d motion = Eigen::umeyama(rest, moved, false);
    const Eigen::Matrix3Xd rigid =
      (motion.topLeftCorner<3, 3>() * rest).colwise() + motion.topRightCorner<3, 1>();
    const bool isRigid = (rigid - moved).cwiseAbs().maxCoeff() <=
      rounding * std::max(rest.cwiseAbs().maxCoeff(), moved.cwiseAbs().maxCoeff());
    for (Eigen::Index i = 0; i < number && !isRigid; ++i)
    {
      Eigen::Map<Eigen::Vector3d>(&displacements[nodes[static_cast<std::size_t>(i)]].x) =
        rigid.col(i) - rest.col(i);
    }
  }
}

} // namespace deformvolume
