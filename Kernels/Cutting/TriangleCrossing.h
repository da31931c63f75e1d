// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTriangleCrossing_h
#define DeformVolumeTriangleCrossing_h

#include "ExactVectors.h"
#include "SnappedPoint.h"

#include <array>
#include <cstdint>

namespace deformvolume
{

/// Decides exactly whether a triangle of a sheet crosses tetrahedra.
///
/// All vertices of the sampling mesh are shifted symbolically by (e, e^2, e^3), e > 0 being
/// infinitesimal. Then no vertex lies in the plane of a triangle, no edge meets an edge, and a
/// triangle either crosses a tetrahedron or is apart from it. The whole mesh is shifted, so
/// decisions for tetrahedra that share a face are consistent. Decisions do not depend on the order
/// of the points of a triangle or of the vertices. If a predicate is 0, the sign of its derivative
/// in the direction of the shift decides.
///
/// Exact in 64 bits: a difference D between points is at most 2^20 steps if the triangle is not
/// longer than 2^17 (Sheet::LongestTriangle), the vertices lie within 2^19 (LargestBox) of each
/// other, and the boxes of the triangle and of the vertices overlap. A component of a cross product
/// is then at most 2 D^2, and a triple product with its partial sums at most 6 D^3 < 2^63.
class TriangleCrossing
{
public:
  /// The triangle must have area.
  explicit TriangleCrossing(const SnappedTriangle& triangle)
    : Triangle(triangle)
    , Normal(Cross(triangle[1] - triangle[0], triangle[2] - triangle[0]))
    , NormalSign(FindSign(this->Normal))
  {
  }

  /// The largest length, in steps, of a box of vertices that are tested together.
  static constexpr std::int64_t LargestBox = std::int64_t{ 1 } << 19;

  /// Whether the triangle may intersect a box. If false, it does not; if true, it need not.
  bool MayIntersect(const SnappedBox& box) const;

  /// Whether a vertex lies above the plane of the triangle.
  bool IsAbove(const SnappedPoint& vertex) const
  {
    const int sign = GetSign(Dot(this->Normal, vertex - this->Triangle[0]));
    return (sign != 0 ? sign : this->NormalSign) > 0;
  }

  /// Whether the edge between two vertices crosses the triangle. Exactly one of the two must be
  /// above its plane.
  bool CrossesEdge(const SnappedPoint& p, const SnappedPoint& q) const
  {
    // The edge crosses the plane, so it is not parallel to an edge of the triangle, and no side is
    // 0.
    const int side = this->GetSide(p, q, 0);
    return this->GetSide(p, q, 1) == side && this->GetSide(p, q, 2) == side;
  }

  /// Returns the distance of a vertex from the plane, in voxels, with rounding errors.
  double GetDistance(const SnappedPoint& vertex) const;

  using Tetrahedron = std::array<SnappedPoint, 4>;

  /// Whether the triangle crosses a tetrahedron, which may be flat. isAbove: IsAbove() of each
  /// vertex.
  bool Crosses(const Tetrahedron& vertices, const std::array<bool, 4>& isAbove) const;

private:
  /// Whether a direction separates the triangle from a box.
  bool AreApart(const SnappedBox& box, const SnappedPoint& direction) const;
  /// Returns the sign of the volume of the tetrahedron spanned by the mesh edge p q and edge k of
  /// the triangle.
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
