// SPDX-License-Identifier: BSD-3-Clause
#include "TetrahedronClipping.h"

#include <glm/vector_relational.hpp>

#include <algorithm>

namespace deformvolume
{

namespace
{

// Clips a convex polygon to a box. Each side of the box adds at most one corner to a convex
// polygon. Rounding may make the polygon slightly concave: there is room for half as many new
// corners as the polygon has, for each side.
class ClippedPolygon
{
public:
  void SetTriangle(const MovedPoint& a, const MovedPoint& b, const MovedPoint& c)
  {
    this->Points[0] = a;
    this->Points[1] = b;
    this->Points[2] = c;
    this->Count = 3;
  }

  void Clip(const IndexBounds& box)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      this->ClipSide(axis, 1.0, box.Min[axis]);
      this->ClipSide(axis, -1.0, box.Max[axis]);
    }
  }

  void AddTo(IndexBounds& bounds) const
  {
    for (int i = 0; i < this->Count; ++i)
    {
      bounds.Add(this->Points[i].Moved);
    }
  }

private:
  static constexpr int Room = 28;

  // Keeps the part above the plane (sign 1), or below it (sign -1).
  void ClipSide(int axis, double sign, double plane)
  {
    std::array<MovedPoint, Room> kept;
    int count = 0;
    for (int i = 0; i < this->Count; ++i)
    {
      const MovedPoint& from = this->Points[i];
      const MovedPoint& to = this->Points[(i + 1) % this->Count];
      const double before = sign * (from.Rest[axis] - plane);
      const double after = sign * (to.Rest[axis] - plane);
      if (before >= 0.0)
      {
        kept[count++] = from;
      }
      if ((before > 0.0 && after < 0.0) || (before < 0.0 && after > 0.0))
      {
        const double t = before / (before - after);
        MovedPoint& point = kept[count++];
        point.Rest = from.Rest + t * (to.Rest - from.Rest);
        point.Rest[axis] = plane;
        point.Moved = from.Moved + t * (to.Moved - from.Moved);
      }
    }
    std::copy(kept.begin(), kept.begin() + count, this->Points.begin());
    this->Count = count;
  }

  std::array<MovedPoint, Room> Points;
  int Count = 0;
};

} // namespace

void AddClippedTetrahedron(const std::array<MovedPoint, 4>& nodes, const BarycentricMap& map,
  const IndexBounds& box, IndexBounds& bounds)
{
  glm::dvec3 min = nodes[0].Rest;
  glm::dvec3 max = nodes[0].Rest;
  for (const MovedPoint& node : nodes)
  {
    min = glm::min(min, node.Rest);
    max = glm::max(max, node.Rest);
  }
  if (glm::any(glm::lessThan(max, box.Min)) || glm::any(glm::greaterThan(min, box.Max)))
  {
    return;
  }
  if (glm::all(glm::greaterThanEqual(min, box.Min)) && glm::all(glm::lessThanEqual(max, box.Max)))
  {
    for (const MovedPoint& node : nodes)
    {
      bounds.Add(node.Moved);
    }
    return;
  }
  // Each corner of the clipped part is a corner of a clipped face or of the box.
  for (int face = 0; face < 4; ++face)
  {
    ClippedPolygon polygon;
    polygon.SetTriangle(nodes[(face + 1) % 4], nodes[(face + 2) % 4], nodes[(face + 3) % 4]);
    polygon.Clip(box);
    polygon.AddTo(bounds);
  }
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::dvec3 point((corner & 1 ? box.Max : box.Min).x, (corner & 2 ? box.Max : box.Min).y,
      (corner & 4 ? box.Max : box.Min).z);
    const glm::dvec4 weights = map.GetAllWeights(point);
    if (glm::all(glm::greaterThanEqual(weights, glm::dvec4(0.0))))
    {
      bounds.Add(weights.x * nodes[0].Moved + weights.y * nodes[1].Moved +
        weights.z * nodes[2].Moved + weights.w * nodes[3].Moved);
    }
  }
}

} // namespace deformvolume
