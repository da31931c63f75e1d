// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTriangleCrossing_h
#define DeformVolumeTriangleCrossing_h

#include "ExactVectors.h"
#include "SnappedPoint.h"

#include <array>
#include <cstdint>

namespace deformvolume
{

/// Whether a triangle of a sheet crosses tetrahedra, decided exactly.
///
/// All vertices of the sampling mesh count as moved by (e, e^2, e^3), where e is smaller than all
/// that can be told apart. Then no vertex lies in the plane of a triangle, no edge meets an edge,
/// and triangle and tetrahedron cross or have a distance. The mesh moves as a whole, so that
/// tetrahedra that share a face are decided alike; what is decided depends neither on the order of
/// the points of a triangle nor on that of the vertices. Where the value of a predicate is 0, the
/// sign of its derivative in the direction of the movement decides.
///
/// Exact in 64 bits: a difference D between points is at most 2^20 steps where the triangle is not
/// longer than 2^17 (Sheet::LongestTriangle) and the vertices lie within 2^19 (LargestBox) of each
/// other and in boxes that overlap. A component of a cross product is then at most 2 D^2, and a
/// triple product with its partial sums at most 6 D^3 < 2^63.
class TriangleCrossing
{
public:
  /// The triangle has area.
  explicit TriangleCrossing(const SnappedTriangle& triangle)
    : Triangle(triangle)
    , Normal(Cross(triangle[1] - triangle[0], triangle[2] - triangle[0]))
    , NormalSign(FindSign(this->Normal))
  {
  }

  /// Vertices that are looked at together lie in a box of this length, in steps.
  static constexpr std::int64_t LargestBox = std::int64_t{ 1 } << 19;

  /// False only where the triangle and a box are apart.
  bool MayIntersect(const SnappedBox& box) const;

  /// Whether a vertex lies above the plane of the triangle.
  bool IsAbove(const SnappedPoint& vertex) const
  {
    const int sign = GetSign(Dot(this->Normal, vertex - this->Triangle[0]));
    return (sign != 0 ? sign : this->NormalSign) > 0;
  }

  /// Whether the edge between two vertices crosses the triangle, of which one lies above its plane
  /// and one does not.
  bool CrossesEdge(const SnappedPoint& p, const SnappedPoint& q) const
  {
    // The edge crosses the plane, so it is parallel to no edge of the triangle: no side is 0.
    const int side = this->GetSide(p, q, 0);
    return this->GetSide(p, q, 1) == side && this->GetSide(p, q, 2) == side;
  }

  /// How far a vertex is from the plane, in voxels, rounded.
  double GetDistance(const SnappedPoint& vertex) const;

  using Tetrahedron = std::array<SnappedPoint, 4>;

  /// isAbove: IsAbove() of each vertex. The tetrahedron may be flat.
  bool Crosses(const Tetrahedron& vertices, const std::array<bool, 4>& isAbove) const;

private:
  /// Whether a direction shows that the triangle and a box are apart.
  bool AreApart(const SnappedBox& box, const SnappedPoint& direction) const;
  /// The sign of the volume of the tetrahedron of edge p q of the mesh and edge k of the triangle.
  int GetSide(const SnappedPoint& p, const SnappedPoint& q, int k) const;
  bool HasEdgeThroughTriangle(
    const Tetrahedron& vertices, const std::array<bool, 4>& isAbove) const;
  bool HasPartInside(const Tetrahedron& vertices) const;

  SnappedTriangle Triangle;
  SnappedPoint Normal;
  int NormalSign;
};

} // namespace deformvolume

#endif
