// SPDX-License-Identifier: BSD-3-Clause
#include "WorldTool.h"

#include "vtkBox.h"
#include "vtkImplicitFunction.h"
#include "vtkSmartPointer.h"
#include "vtkSphere.h"

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
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
  return tool;
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
  moved.Function = [tool, toWorld = volume.GetIndexToWorld()](
                     const glm::dvec3* points, std::size_t count, double* values)
  {
    std::vector<glm::dvec3> world(count);
    for (std::size_t i = 0; i < count; ++i)
    {
      world[i] = glm::dvec3(toWorld * glm::dvec4(points[i], 1.0));
    }
    tool.Function(world.data(), count, values);
  };
  return moved;
}

} // namespace deformvolume
