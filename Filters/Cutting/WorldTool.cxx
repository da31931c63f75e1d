// SPDX-License-Identifier: BSD-3-Clause
#include "WorldTool.h"

#include "vtkBox.h"
#include "vtkCellArray.h"
#include "vtkGenericCell.h"
#include "vtkImplicitFunction.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkSphere.h"
#include "vtkStaticCellLocator.h"

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <mutex>
#include <string>

namespace deformvolume
{
namespace
{

// Their evaluation changes nothing of the function. Others keep what they have found, such as a
// cell.
bool IsThreadSafe(vtkImplicitFunction* function)
{
  const char* const classes[] = { "vtkBox", "vtkCone", "vtkCylinder", "vtkPlane", "vtkQuadric",
    "vtkSphere", "vtkSuperquadric" };
  return std::any_of(std::begin(classes), std::end(classes),
    [&](const char* name) { return function->IsA(name) != 0; });
}

// Planes of VTK and of ParaView. Other subclasses may be other bodies.
bool IsLinear(vtkImplicitFunction* function)
{
  const std::string name = function->GetClassName();
  return (name == "vtkPlane" || name == "vtkPVPlane") && !function->GetTransform();
}

IndexBounds FindBounds(vtkImplicitFunction* function)
{
  IndexBounds bounds = GetUnlimitedBounds();
  if (function->GetTransform())
  {
    return bounds;
  }
  const std::string name = function->GetClassName();
  if (name == "vtkSphere")
  {
    auto* sphere = vtkSphere::SafeDownCast(function);
    glm::dvec3 center;
    sphere->GetCenter(&center.x);
    const glm::dvec3 reach(std::abs(sphere->GetRadius()));
    bounds.Min = center - reach;
    bounds.Max = center + reach;
  }
  else if (name == "vtkBox")
  {
    vtkBox::SafeDownCast(function)->GetXMin(&bounds.Min.x);
    vtkBox::SafeDownCast(function)->GetXMax(&bounds.Max.x);
  }
  return bounds;
}

using PointFunction = decltype(CarvingTool::Function);

// A function of points in world coordinates, called with indices.
PointFunction CallInWorld(const PointFunction& function, const ImageGeometry& volume)
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

} // namespace

CarvingTool MakeWorldTool(vtkImplicitFunction* function)
{
  CarvingTool tool;
  tool.Bounds = FindBounds(function);
  tool.IsLinear = IsLinear(function);
  const vtkSmartPointer<vtkImplicitFunction> held = function;
  const auto mutex = IsThreadSafe(function) ? nullptr : std::make_shared<std::mutex>();
  tool.Function = [held, mutex](const glm::dvec3* points, std::size_t count, double* values)
  {
    const auto lock = mutex ? std::unique_lock<std::mutex>(*mutex) : std::unique_lock<std::mutex>();
    for (std::size_t i = 0; i < count; ++i)
    {
      values[i] = held->FunctionValue(&points[i].x);
    }
  };
  tool.Distance = [held, mutex](const glm::dvec3* points, std::size_t count, double* distances)
  {
    const auto lock = mutex ? std::unique_lock<std::mutex>(*mutex) : std::unique_lock<std::mutex>();
    for (std::size_t i = 0; i < count; ++i)
    {
      glm::dvec3 point = points[i];
      glm::dvec3 gradient(0.0);
      held->FunctionGradient(&point.x, &gradient.x);
      const double slope = glm::length(gradient);
      const double value = std::abs(held->FunctionValue(&point.x));
      distances[i] = slope > 0.0 ? value / slope : value;
    }
  };
  return tool;
}

PointFunction MakeDistance(const WorldSheet& surface, const ImageGeometry& volume)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const glm::dvec3& point : surface.Points)
  {
    points->InsertNextPoint(&point.x);
  }
  vtkNew<vtkCellArray> triangles;
  for (const Sheet::Triangle& triangle : surface.Triangles)
  {
    const std::array<vtkIdType, 3> ids{ { triangle[0], triangle[1], triangle[2] } };
    triangles->InsertNextCell(3, ids.data());
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(triangles);
  const auto locator = vtkSmartPointer<vtkStaticCellLocator>::New();
  locator->SetDataSet(data);
  locator->BuildLocator();
  data->GetCell(0); // builds what threads then read
  return CallInWorld(
    [locator](const glm::dvec3* places, std::size_t count, double* distances)
    {
      vtkNew<vtkGenericCell> cell;
      for (std::size_t i = 0; i < count; ++i)
      {
        glm::dvec3 nearest(0.0);
        vtkIdType id = -1;
        int part = 0;
        double squared = 0.0;
        locator->FindClosestPoint(&places[i].x, &nearest.x, cell, id, part, squared);
        distances[i] = std::sqrt(squared);
      }
    },
    volume);
}

CarvingTool GetInIndices(const CarvingTool& tool, const ImageGeometry& volume)
{
  CarvingTool moved;
  moved.IsLinear = tool.IsLinear;
  moved.Bounds = GetUnlimitedBounds();
  if (IsFinite(tool.Bounds.Min) && IsFinite(tool.Bounds.Max))
  {
    const glm::dmat4 toIndex = volume.GetWorldToIndex();
    moved.Bounds = IndexBounds();
    for (int corner = 0; corner < 8; ++corner)
    {
      glm::dvec4 point(0.0, 0.0, 0.0, 1.0);
      for (int axis = 0; axis < 3; ++axis)
      {
        point[axis] = corner >> axis & 1 ? tool.Bounds.Max[axis] : tool.Bounds.Min[axis];
      }
      moved.Bounds.Add(glm::dvec3(toIndex * point));
    }
    // Rounding must not cut off what touches the bounds.
    constexpr double margin = 1e-3; // voxels
    moved.Bounds.Min -= glm::dvec3(margin);
    moved.Bounds.Max += glm::dvec3(margin);
  }
  moved.Function = CallInWorld(tool.Function, volume);
  if (tool.Distance)
  {
    moved.Distance = CallInWorld(tool.Distance, volume);
  }
  return moved;
}

} // namespace deformvolume
