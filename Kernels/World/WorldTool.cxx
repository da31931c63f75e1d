// SPDX-License-Identifier: BSD-3-Clause
#include "WorldTool.h"

#include "ClosestFace.h"

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace deformvolume
{

PointFunction MakeFirstOrderDistance(const PointFunction& function, const PointGradient& gradient)
{
  return [function, gradient](const glm::dvec3* points, std::size_t count, double* distances)
  {
    std::vector<glm::dvec3> gradients(count, glm::dvec3(0.0));
    gradient(points, count, gradients.data());
    function(points, count, distances);
    for (std::size_t i = 0; i < count; ++i)
    {
      const double slope = glm::length(gradients[i]);
      const double value = std::abs(distances[i]);
      distances[i] = slope > 0.0 ? value / slope : value;
    }
  };
}

PointFunction MakeSurfaceDistance(const WorldSheet& surface)
{
  std::vector<ClosestFace::Triangle> triangles;
  for (const Sheet::Triangle& triangle : surface.Triangles)
  {
    ClosestFace::Triangle corners;
    for (std::size_t k = 0; k < 3; ++k)
    {
      corners[k] = surface.Points[static_cast<std::size_t>(triangle[k])];
    }
    // Ignore triangles without area. In a closed surface, their edges belong to other triangles as
    // well.
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (normal != glm::dvec3(0.0))
    {
      triangles.push_back(corners);
    }
  }
  const auto faces = std::make_shared<const ClosestFace>(std::move(triangles));
  return [faces](const glm::dvec3* points, std::size_t count, double* distances)
  {
    std::int32_t last = -1;
    for (std::size_t i = 0; i < count; ++i)
    {
      const ClosestFace::Result closest = faces->Find(points[i], last);
      last = closest.Face;
      distances[i] = std::sqrt(closest.SquaredDistance);
    }
  };
}

PointFunction GetInIndices(const PointFunction& function, const ImageGeometry& volume)
{
  return [function, toWorld = volume.GetIndexToWorld()](
           const glm::dvec3* points, std::size_t count, double* values)
  {
    std::vector<glm::dvec3> world(count);
    for (std::size_t i = 0; i < count; ++i)
    {
      world[i] = glm::dvec3(toWorld * glm::dvec4(points[i], 1.0));
    }
    function(world.data(), count, values);
  };
}

CarvingTool GetInIndices(const CarvingTool& tool, const ImageGeometry& volume)
{
  CarvingTool moved;
  moved.IsLinear = tool.IsLinear;
  moved.Bounds = GetUnlimitedBounds();
  if (IsFinite(tool.Bounds.Min) && IsFinite(tool.Bounds.Max))
  {
    moved.Bounds = TransformBox(volume.GetWorldToIndex(), tool.Bounds);
    // Rounding must not exclude points on the bounds.
    constexpr double margin = 1e-3; // voxels
    moved.Bounds.Min -= glm::dvec3(margin);
    moved.Bounds.Max += glm::dvec3(margin);
  }
  moved.Function = GetInIndices(tool.Function, volume);
  if (tool.Distance)
  {
    moved.Distance = GetInIndices(tool.Distance, volume);
  }
  return moved;
}

} // namespace deformvolume
