// SPDX-License-Identifier: BSD-3-Clause
// The execution of vtkCarveVolume.
#include "vtkCarveVolumeInternals.h"

#include "Error.h"
#include "InputUpdate.h"
#include "PipelineGeometry.h"
#include "ShapedArray.h"
#include "WorldTool.h"

#include "vtkBox.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformationVector.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkSphere.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

using deformvolume::Error;
using deformvolume::VolumeEdit;

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

deformvolume::IndexBounds FindBounds(vtkImplicitFunction* function)
{
  deformvolume::IndexBounds bounds = deformvolume::GetUnlimitedBounds();
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

// Makes a tool that carves where a function of world coordinates is negative. The tool holds a
// reference to the function. Unless the class of the function is known to be thread-safe, only one
// thread evaluates it at a time. Spheres and boxes without a transform have bounds. The distance
// from the boundary is a first-order approximation.
deformvolume::CarvingTool MakeImplicitTool(vtkImplicitFunction* function)
{
  deformvolume::CarvingTool tool;
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
  tool.Distance = deformvolume::MakeFirstOrderDistance(tool.Function,
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

deformvolume::LabelReader MakeLabelReader(vtkDataArray* labels)
{
  return [labels](std::int64_t voxel, std::int64_t count, double* read)
  {
    const auto values = vtk::DataArrayValueRange<1>(labels, voxel, voxel + count);
    std::copy(values.begin(), values.end(), read);
  };
}

} // namespace

//------------------------------------------------------------------------------
void vtkCarveVolume::vtkInternals::Check() const
{
  if (!std::isfinite(this->Self->ToolRadius) || this->Self->ToolRadius <= 0.0)
  {
    throw Error("ToolRadius is " + deformvolume::FormatNumber(this->Self->ToolRadius) +
      ". Set a finite radius greater than 0.");
  }
}

//------------------------------------------------------------------------------
deformvolume::CarvingRule vtkCarveVolume::vtkInternals::GetRule() const
{
  switch (this->Self->Rule)
  {
    case CONSERVATIVE:
      return deformvolume::CarvingRule::Conservative;
    case MINIMAL:
      return deformvolume::CarvingRule::Minimal;
    default:
      return deformvolume::CarvingRule::Centroid;
  }
}

//------------------------------------------------------------------------------
vtkDataArray* vtkCarveVolume::vtkInternals::FindLabels(vtkImageData* volume) const
{
  const std::string& name = this->Self->LabelArrayName;
  if (name.empty())
  {
    return nullptr;
  }
  vtkDataArray* labels = deformvolume::FindShapedArray(volume->GetPointData(), name.c_str(), 1,
    volume->GetNumberOfPoints(), "point array", "the volume");
  if (!labels)
  {
    throw Error("The volume on input port 0 has no point array \"" + name +
      "\". Set LabelArrayName to an array of it, or to \"\" to carve no label.");
  }
  return labels;
}

//------------------------------------------------------------------------------
void vtkCarveVolume::vtkInternals::AddChange(Body& body, Body::Key&& next,
  const std::function<VolumeEdit()>& carve, std::vector<Change>& changes)
{
  if (next == body.Carved)
  {
    return;
  }
  const bool isThere = next != Body::Key();
  changes.push_back({ &body, std::move(next), isThere ? carve() : VolumeEdit() });
}

//------------------------------------------------------------------------------
void vtkCarveVolume::vtkInternals::Execute(vtkInformationVector** input)
{
  this->Check();
  vtkEdits& edits = *this->Self->Edits;
  if (edits.SetVolume(input))
  {
    this->Function = this->Surface = this->Label = Body();
  }
  vtkDataArray* labels = this->FindLabels(vtkImageData::GetData(input[0]));
  deformvolume::WorldSheet sheet = deformvolume::ReadSheet(
    vtkPolyData::GetData(input[1]), std::nullopt, "surface on input port 1");
  deformvolume::EditFinder finder = edits.MakeFinder(input);
  finder.IsSmooth = this->Self->SmoothBoundary;
  finder.Rule = this->GetRule();
  const double sheetVersion = this->SheetVersion + (sheet == this->Sheet ? 0.0 : 1.0);
  constexpr double smooth = -1.0; // in place of a rule
  const double rule = this->Self->SmoothBoundary ? smooth : this->Self->Rule;

  std::vector<Change> changes;
  vtkImplicitFunction* function = this->Self->ImplicitFunction;
  this->AddChange(
    this->Function,
    function ? Body::Key{ { { function, function->GetMTime() } }, { rule } } : Body::Key(),
    [&] { return finder.Carve(MakeImplicitTool(function)); }, changes);
  this->AddChange(
    this->Surface, sheet.IsEmpty() ? Body::Key() : Body::Key{ {}, { rule, sheetVersion } },
    [&] { return finder.CarveSurface(sheet); }, changes);
  const std::size_t beforeLabel = changes.size();
  const deformvolume::LabelReader readLabels = MakeLabelReader(labels);
  deformvolume::Stamp labelStamp{ deformvolume::GetWrittenStamp(this->Self, 0) };
  deformvolume::AddArray(labelStamp, labels);
  this->AddChange(
    this->Label, labels ? Body::Key{ labelStamp, { rule, this->Self->Label } } : Body::Key(),
    [&] { return finder.CarveLabel(readLabels, this->Self->Label); }, changes);
  std::vector<glm::dvec3> stroke;
  for (const deformvolume::ToolPath::Position& position : edits.Tool.GetStroke())
  {
    stroke.push_back(position[0]);
  }
  VolumeEdit byTool;
  if (!stroke.empty())
  {
    byTool = finder.CarveSweptSphere(stroke, this->Self->ToolRadius);
  }

  // Other ranks may have voxels with a label that this part of the volume lacks.
  const bool isWhole = finder.Volume.PointExtent ==
    deformvolume::GetGeometry(input[0]->GetInformationObject(0)).PointExtent;
  if (labels && isWhole && changes.size() > beforeLabel &&
    !deformvolume::HasLabel(finder.Volume.PointExtent, readLabels, this->Self->Label))
  {
    vtkWarningWithObjectMacro(this->Self,
      << "No voxel has the label " << this->Self->Label << " in \"" << this->Self->LabelArrayName
      << "\", so this label carves nothing. Set Label to a value that occurs.");
  }
  for (Change& change : changes)
  {
    Body& body = *change.Changed;
    if (change.Next != Body::Key())
    {
      edits.Editor.Put(body.Edit, std::move(change.Edit), this->Self->Accumulate);
    }
    else if (!this->Self->Accumulate)
    {
      edits.Editor.Drop(body.Edit);
    }
    body.Carved = std::move(change.Next);
  }
  this->Sheet = std::move(sheet);
  this->SheetVersion = sheetVersion;
  if (!stroke.empty())
  {
    std::uint64_t edit = 0;
    edits.Editor.Put(edit, std::move(byTool), true);
  }
}
