// SPDX-License-Identifier: BSD-3-Clause
#include "SheetCrossings.h"

#include "Error.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace deformvolume
{
namespace
{

// In lengths of the mesh. The limit of Sheet is slightly larger: 2^20.
constexpr double FarthestPoint = 1e6;

// Converts the sheet to voxels, the unit of Sheet, such that the steps of Sheet are the steps of
// the mesh.
std::vector<SnappedTriangle> SnapSheet(const MeshSteps& steps,
  const std::vector<glm::dvec3>& points, const std::vector<Sheet::Triangle>& triangles)
{
  std::vector<glm::dvec3> indices(points.size());
  std::transform(points.begin(), points.end(), indices.begin(),
    [&](const glm::dvec3& point) { return steps.Get(point) / static_cast<double>(StepsPerVoxel); });
  constexpr double meshLength =
    static_cast<double>(MeshSteps::Length) / static_cast<double>(StepsPerVoxel);
  for (const Sheet::Triangle& triangle : triangles)
  {
    for (const std::int64_t point : triangle)
    {
      const glm::dvec3 far = glm::abs(indices[static_cast<std::size_t>(point)]);
      if (!(std::max(far.x, std::max(far.y, far.z)) <= FarthestPoint * meshLength))
      {
        throw Error("Point " + std::to_string(point) +
          " of the sheet is more than a million times as far away as the mesh is long. Give the "
          "sheet in the coordinates of the mesh, or bring the point nearer.");
      }
    }
  }
  SnappedBox mesh;
  mesh.Add(SnappedPoint(0));
  mesh.Add(SnappedPoint(MeshSteps::Length));
  return Sheet(indices, triangles).Divide(mesh);
}

} // namespace

MeshSteps::MeshSteps(const glm::dvec3& low, const glm::dvec3& high)
  : Low(low)
  , Scale(0.0)
{
  const glm::dvec3 size = high - low;
  const double longest = std::max(size.x, std::max(size.y, size.z));
  const double scale = static_cast<double>(MeshSteps::Length) / longest;
  if (longest > 0.0 && std::isfinite(scale))
  {
    this->Scale = scale;
  }
}

SheetCrossings::SheetCrossings(const MeshSteps& steps, const std::vector<glm::dvec3>& points,
  const std::vector<Sheet::Triangle>& triangles)
{
  const std::vector<SnappedTriangle> divided = SnapSheet(steps, points, triangles);
  this->Crossings.reserve(divided.size());
  for (const SnappedTriangle& triangle : divided)
  {
    this->Crossings.emplace_back(triangle);
  }
  this->Tree =
    BoxTree<SnappedBox>(divided, [](const SnappedTriangle& triangle) { return GetBox(triangle); });
}

bool SheetCrossings::MayIntersect(const SnappedBox& box) const
{
  bool mayIntersect = false;
  this->Tree.Visit(box,
    [&](std::size_t number)
    {
      mayIntersect = this->Crossings[number].MayIntersect(box);
      return !mayIntersect;
    });
  return mayIntersect;
}

bool SheetCrossings::IsCrossedOddly(const SnappedPoint& p, const SnappedPoint& q) const
{
  SnappedBox box;
  box.Add(p);
  box.Add(q);
  bool isOdd = false;
  this->Tree.Visit(box,
    [&](std::size_t number)
    {
      const TriangleCrossing& crossing = this->Crossings[number];
      isOdd ^= crossing.IsAbove(p) != crossing.IsAbove(q) && crossing.CrossesEdge(p, q);
      return true;
    });
  return isOdd;
}

} // namespace deformvolume
