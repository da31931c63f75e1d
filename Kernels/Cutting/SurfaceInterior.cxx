// SPDX-License-Identifier: BSD-3-Clause
#include "SurfaceInterior.h"

#include "BoxTree.h"
#include "Error.h"
#include "ExactVectors.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace deformvolume
{
namespace
{

// Points are integers in quarters of a step.
constexpr std::int64_t PointsPerStep = 4;
// An x coordinate greater than that of any point, and small enough that adding to it does not
// overflow.
constexpr std::int64_t Beyond = std::int64_t{ 1 } << 60;

// A triangle that rays along x may cross. Predicates are exact in 64 bits: differences on y and z
// are at most 2^19, the length of a triangle (Sheet::LongestTriangle) in quarters of a step. The
// same holds for x: if x of the point is outside the box of the triangle, no product is needed.
class RayTriangle
{
public:
  explicit RayTriangle(const SnappedTriangle& triangle)
    : Triangle{ { PointsPerStep * triangle[0], PointsPerStep * triangle[1],
        PointsPerStep * triangle[2] } }
    , Box(deformvolume::GetBox(this->Triangle))
    , Normal(deformvolume::Cross(
        this->Triangle[1] - this->Triangle[0], this->Triangle[2] - this->Triangle[0]))
  {
  }

  const SnappedBox& GetBox() const { return this->Box; }

  // Whether the ray from a point towards greater x crosses the triangle.
  bool IsCrossed(const SnappedPoint& point) const
  {
    if (this->Normal.x == 0 || point.x >= this->Box.Max.x || point.y < this->Box.Min.y ||
      point.y >= this->Box.Max.y || point.z < this->Box.Min.z || point.z >= this->Box.Max.z)
    {
      return false;
    }
    const int side = this->GetSide(point, 0);
    if (this->GetSide(point, 1) != side || this->GetSide(point, 2) != side)
    {
      return false;
    }
    // 1 if the point is above the plane, which is the side of the normal, -1 if it is below, 0 if
    // it lies in the plane.
    const int height = point.x < this->Box.Min.x
      ? -GetSign(this->Normal.x)
      : GetSign(Dot(this->Normal, point - this->Triangle[0]));
    return height == -GetSign(this->Normal.x);
  }

private:
  // Returns the side of an edge on which a point lies, seen along x. If the point lies on the edge,
  // the direction of its symbolic shift decides: e^2 on y and e^3 on z.
  int GetSide(const SnappedPoint& point, int k) const
  {
    const SnappedPoint& a = this->Triangle[k];
    const SnappedPoint along = this->Triangle[(k + 1) % 3] - a;
    const SnappedPoint to = point - a;
    const int sign = GetSign(along.y * to.z - along.z * to.y);
    return sign != 0 ? sign : along.z != 0 ? -GetSign(along.z) : GetSign(along.y);
  }

  SnappedTriangle Triangle;
  SnappedBox Box;
  SnappedPoint Normal;
};

class Interior
{
public:
  explicit Interior(std::vector<RayTriangle> triangles)
    : Triangles(std::move(triangles))
    , Tree(this->Triangles, [](const RayTriangle& triangle) { return triangle.GetBox(); })
  {
  }

  void operator()(const glm::dvec3* points, std::size_t count, double* values) const
  {
    SnappedBox box;
    std::vector<SnappedPoint> snapped(count);
    for (std::size_t i = 0; i < count; ++i)
    {
      snapped[i] = Snap(static_cast<double>(PointsPerStep) * points[i]);
      box.Add(snapped[i]);
    }
    // If no triangle is near the points, all points are on the same side as the first point.
    SnappedBox wider = box;
    wider.Min -= std::int64_t{ 1 };
    wider.Max += std::int64_t{ 1 };
    const bool isCrossed = this->Tree.Overlaps(wider);
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < (isCrossed ? count : std::min<std::size_t>(count, 1)); ++i)
    {
      values[i] = this->IsInside(snapped[i], near) ? -1.0 : 1.0;
    }
    if (!isCrossed && count > 0)
    {
      std::fill_n(values, count, values[0]);
    }
  }

private:
  bool IsInside(const SnappedPoint& point, std::vector<std::size_t>& near) const
  {
    SnappedBox ray;
    ray.Add(point);
    ray.Add(SnappedPoint(Beyond, point.y, point.z));
    near.clear();
    this->Tree.Find(ray, near);
    return std::count_if(near.begin(), near.end(),
             [&](std::size_t triangle) { return this->Triangles[triangle].IsCrossed(point); }) %
      2 !=
      0;
  }

  std::vector<RayTriangle> Triangles;
  BoxTree<SnappedBox> Tree;
};

} // namespace

CarvingTool MakeSurfaceInterior(const Sheet& surface, const SnappedBox& within)
{
  if (!surface.IsClosed())
  {
    throw Error("The surface to carve with is open: an edge belongs to an odd number of triangles, "
                "so that there is no inside. Close its holes, for example with vtkFillHolesFilter, "
                "or cut with it as a sheet.");
  }
  // The region that rays from the box can cross.
  SnappedBox swept = within;
  swept.Max.x = Beyond;
  std::vector<RayTriangle> triangles;
  for (const SnappedTriangle& triangle : surface.Divide(swept))
  {
    triangles.emplace_back(triangle);
  }
  const auto interior = std::make_shared<const Interior>(std::move(triangles));
  CarvingTool tool;
  tool.Function = [interior](const glm::dvec3* points, std::size_t count, double* values)
  { (*interior)(points, count, values); };
  constexpr auto steps = static_cast<double>(StepsPerVoxel);
  tool.Bounds.Min = glm::dvec3(surface.GetBox().Min) / steps;
  tool.Bounds.Max = glm::dvec3(surface.GetBox().Max) / steps;
  return tool;
}

} // namespace deformvolume
