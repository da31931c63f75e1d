// SPDX-License-Identifier: BSD-3-Clause
#include "TriangleCrossing.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace deformvolume
{

bool TriangleCrossing::AreApart(const SnappedBox& box, const SnappedPoint& direction) const
{
  std::int64_t boxLow = 0;
  std::int64_t boxHigh = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const std::int64_t low = direction[axis] * (box.Min[axis] - this->Triangle[0][axis]);
    const std::int64_t high = direction[axis] * (box.Max[axis] - this->Triangle[0][axis]);
    boxLow += std::min(low, high);
    boxHigh += std::max(low, high);
  }
  const std::int64_t second = Dot(direction, this->Triangle[1] - this->Triangle[0]);
  const std::int64_t third = Dot(direction, this->Triangle[2] - this->Triangle[0]);
  return boxLow > std::max(std::int64_t{ 0 }, std::max(second, third)) ||
    boxHigh < std::min(std::int64_t{ 0 }, std::min(second, third));
}

bool TriangleCrossing::MayIntersect(const SnappedBox& box) const
{
  if (this->AreApart(box, this->Normal))
  {
    return false;
  }
  for (int k = 0; k < 3; ++k)
  {
    const SnappedPoint edge = this->Triangle[(k + 1) % 3] - this->Triangle[k];
    // The cross products of the edge with the axes.
    if (this->AreApart(box, SnappedPoint(0, edge.z, -edge.y)) ||
      this->AreApart(box, SnappedPoint(-edge.z, 0, edge.x)) ||
      this->AreApart(box, SnappedPoint(edge.y, -edge.x, 0)))
    {
      return false;
    }
  }
  return true;
}

int TriangleCrossing::GetSide(const SnappedPoint& p, const SnappedPoint& q, int k) const
{
  const SnappedPoint& a = this->Triangle[k];
  const SnappedPoint& b = this->Triangle[(k + 1) % 3];
  const SnappedPoint along = q - p;
  const int sign = GetSign(Dot(along, Cross(a - p, b - p)));
  return sign != 0 ? sign : FindSign(Cross(along, b - a));
}

double TriangleCrossing::GetDistance(const SnappedPoint& vertex) const
{
  return std::abs(static_cast<double>(Dot(this->Normal, vertex - this->Triangle[0]))) /
    glm::length(glm::dvec3(this->Normal)) / static_cast<double>(StepsPerVoxel);
}

// If a triangle and a tetrahedron intersect, one of three cases holds: an edge of the tetrahedron
// crosses the triangle; an edge of the triangle crosses a face of the tetrahedron; or a point of
// the triangle is inside the tetrahedron.
bool TriangleCrossing::Crosses(
  const Tetrahedron& vertices, const std::array<bool, 4>& isAbove) const
{
  if (isAbove[0] == isAbove[1] && isAbove[0] == isAbove[2] && isAbove[0] == isAbove[3])
  {
    return false;
  }
  return this->HasEdgeThroughTriangle(vertices, isAbove) || this->HasPartInside(vertices);
}

bool TriangleCrossing::HasEdgeThroughTriangle(
  const Tetrahedron& vertices, const std::array<bool, 4>& isAbove) const
{
  static constexpr int edges[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 }, { 1, 3 }, { 2, 3 } };
  for (const auto& edge : edges)
  {
    if (isAbove[edge[0]] == isAbove[edge[1]])
    {
      continue;
    }
    if (this->CrossesEdge(vertices[edge[0]], vertices[edge[1]]))
    {
      return true;
    }
  }
  return false;
}

bool TriangleCrossing::HasPartInside(const Tetrahedron& vertices) const
{
  static constexpr int faces[4][3] = { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } };
  const int orientation = GetSign(
    Dot(Cross(vertices[1] - vertices[0], vertices[2] - vertices[0]), vertices[3] - vertices[0]));
  bool isInside[3] = { orientation != 0, orientation != 0, orientation != 0 };
  for (const auto& face : faces)
  {
    const SnappedPoint& p = vertices[face[0]];
    const SnappedPoint& q = vertices[face[1]];
    const SnappedPoint& r = vertices[face[2]];
    const SnappedPoint normal = Cross(q - p, r - p);
    // A face without area contains nothing and has no sides.
    const int movement = FindSign(normal);
    if (movement == 0)
    {
      continue;
    }
    int sides[3];
    for (int k = 0; k < 3; ++k)
    {
      const int sign = GetSign(Dot(normal, this->Triangle[k] - p));
      sides[k] = sign != 0 ? sign : -movement;
      // Normals point outwards if the orientation is positive.
      isInside[k] = isInside[k] && sides[k] == -orientation;
    }
    for (int k = 0; k < 3; ++k)
    {
      if (sides[k] == sides[(k + 1) % 3])
      {
        continue;
      }
      const int side = this->GetSide(p, q, k);
      if (this->GetSide(q, r, k) == side && this->GetSide(r, p, k) == side)
      {
        return true;
      }
    }
  }
  return isInside[0] || isInside[1] || isInside[2];
}

} // namespace deformvolume
