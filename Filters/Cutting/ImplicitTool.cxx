// SPDX-License-Identifier: BSD-3-Clause
#include "ImplicitTool.h"

#include "WorldTool.h"

#include "vtkBox.h"
#include "vtkImplicitFunction.h"
#include "vtkSmartPointer.h"
#include "vtkSphere.h"

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

// Whether several threads may evaluate the function at the same time. Functions of other classes
// may cache results, such as the last cell.
bool IsThreadSafe(vtkImplicitFunction* function)
{
  const char* const classes[] = { "vtkBox", "vtkCone", "vtkCylinder", "vtkPlane", "vtkQuadric",
    "vtkSphere", "vtkSuperquadric" };
  return std::any_of(std::begin(classes), std::end(classes),
    [&](const char* name) { return function->IsA(name) != 0; });
}

// Only the planes of VTK and of ParaView: other subclasses of vtkPlane may be nonlinear.
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
    const glm::dvec3 radius(std::abs(sphere->GetRadius()));
    bounds.Min = center - radius;
    bounds.Max = center + radius;
  }
  else if (name == "vtkBox")
  {
    vtkBox::SafeDownCast(function)->GetXMin(&bounds.Min.x);
    vtkBox::SafeDownCast(function)->GetXMax(&bounds.Max.x);
  }
  return bounds;
}

} // namespace

CarvingTool MakeImplicitTool(vtkImplicitFunction* function)
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
  tool.Distance = MakeFirstOrderDistance(tool.Function,
    [held, mutex](const glm::dvec3* points, std::size_t count, glm::dvec3* gradients)
    {
      const auto lock =
        mutex ? std::unique_lock<std::mutex>(*mutex) : std::unique_lock<std::mutex>();
      for (std::size_t i = 0; i < count; ++i)
      {
        glm::dvec3 point = points[i];
        held->FunctionGradient(&point.x, &gradients[i].x);
      }
    });
  return tool;
}

} // namespace deformvolume
