// SPDX-License-Identifier: BSD-3-Clause
#include "Carving.h"

#include "BrickEdit.h"
#include "CarvingContainment.h"
#include "Error.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace deformvolume
{
namespace
{

// Whether a tetrahedron is hit, from the values at its vertices.
bool IsHit(const double* values, const std::array<std::size_t, 4>& v, CarvingRule rule)
{
  const int inside = (values[v[0]] < 0.0 ? 1 : 0) + (values[v[1]] < 0.0 ? 1 : 0) +
    (values[v[2]] < 0.0 ? 1 : 0) + (values[v[3]] < 0.0 ? 1 : 0);
  switch (rule)
  {
    case CarvingRule::Conservative:
      return inside > 0;
    case CarvingRule::Minimal:
      return inside == 4;
    default:
      return values[v[0]] + values[v[1]] + values[v[2]] + values[v[3]] < 0.0;
  }
}

void CarveByVertices(BrickEdit& edit, const double* values, CarvingRule rule)
{
  edit.HitIf(
    [&](const std::array<std::size_t, 4>& vertices) { return IsHit(values, vertices, rule); });
}

void CarveByCentroids(BrickEdit& edit, const CarvingTool& tool)
{
  std::vector<glm::dvec3> centroids;
  centroids.reserve(5 * CellBricks::Cells);
  edit.ForEachCell(
    [&](int x, int y, int z, std::size_t)
    {
      for (const std::array<std::size_t, 4>& v : edit.GetTetrahedra(x, y, z))
      {
        // The centroid has no rounding error: it is a multiple of 1/1024 voxel.
        centroids.push_back(0.25 *
          GetIndex(edit.GetPosition(v[0]) + edit.GetPosition(v[1]) + edit.GetPosition(v[2]) +
            edit.GetPosition(v[3])));
      }
    });
  std::vector<double> values(centroids.size());
  tool.Function(centroids.data(), centroids.size(), values.data());
  const double* value = values.data();
  edit.HitIf([&](const auto&) { return *value++ < 0.0; });
}

double GetSquaredDistance(const glm::dvec3& point, const glm::dvec3& from, const glm::dvec3& to)
{
  const glm::dvec3 along = to - from;
  const double length = glm::dot(along, along);
  const double share =
    length > 0.0 ? std::clamp(glm::dot(point - from, along) / length, 0.0, 1.0) : 0.0;
  const glm::dvec3 apart = point - (from + share * along);
  return glm::dot(apart, apart);
}

} // namespace

IndexBounds GetUnlimitedBounds()
{
  IndexBounds bounds;
  bounds.Min = glm::dvec3(-std::numeric_limits<double>::infinity());
  bounds.Max = glm::dvec3(std::numeric_limits<double>::infinity());
  return bounds;
}

CarvingTool MakeSweptSphere(const std::vector<glm::dvec3>& centers, const glm::dvec3& radii)
{
  if (centers.empty())
  {
    throw Error("A carving tool has no position. Give it one position or more.");
  }
  if (!IsFinite(radii) || !(radii.x > 0.0 && radii.y > 0.0 && radii.z > 0.0))
  {
    throw Error("The radius of a carving tool is not greater than 0, or not finite.");
  }
  CarvingTool tool;
  std::vector<glm::dvec3> path; // in units of the radii
  for (const glm::dvec3& center : centers)
  {
    if (!IsFinite(center))
    {
      throw Error("A position of a carving tool is not finite. Correct the position.");
    }
    tool.Bounds.Add(center - radii);
    tool.Bounds.Add(center + radii);
    path.push_back(center / radii);
  }
  tool.Function = [path, radii](const glm::dvec3* points, std::size_t count, double* values)
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      const glm::dvec3 point = points[i] / radii;
      double least = GetSquaredDistance(point, path.front(), path.front());
      for (std::size_t k = 1; k < path.size(); ++k)
      {
        least = std::min(least, GetSquaredDistance(point, path[k - 1], path[k]));
      }
      values[i] = least - 1.0;
    }
  };
  // A first-order distance: the function divided by the length of its gradient. Within half a
  // radius of the path this is not a distance, but distances are only needed near the boundary.
  tool.Distance = [function = tool.Function, radii](
                    const glm::dvec3* points, std::size_t count, double* distances)
  {
    const double radius = std::min({ radii.x, radii.y, radii.z });
    function(points, count, distances);
    for (std::size_t i = 0; i < count; ++i)
    {
      const double squared = distances[i] + 1.0; // squared distance from the path, in radii
      distances[i] = radius * std::abs(distances[i]) / (2.0 * std::max(std::sqrt(squared), 0.5));
    }
  };
  return tool;
}

TetrahedronSet FindCarvedTetrahedra(const VertexPositions& positions, const CarvingTool& tool,
  CarvingRule rule, const EditProgress& progress)
{
  return BrickEdit::ForEachBrick(
    positions.GetBricks().GetNumberOfBricks(),
    [&](std::size_t brick, BrickEdit& edit)
    {
      const CarvingContainment containment = FindContainment(positions.GetBox(brick), tool);
      if (containment == CarvingContainment::Nothing)
      {
        return;
      }
      edit.Set(positions, brick);
      if (containment == CarvingContainment::All)
      {
        edit.HitIf([](const auto&) { return true; });
        return;
      }
      if (rule == CarvingRule::Centroid && !tool.IsOfVertices)
      {
        CarveByCentroids(edit, tool);
        return;
      }
      std::array<glm::dvec3, BrickEdit::MaxVertices> points;
      edit.CopyPoints(points);
      std::array<double, BrickEdit::MaxVertices> values;
      tool.Function(points.data(), edit.GetNumberOfVertices(), values.data());
      CarveByVertices(edit, values.data(), rule);
    },
    progress);
}

} // namespace deformvolume
