// SPDX-License-Identifier: BSD-3-Clause
// What an execution of vtkCarveVolume does.
#include "vtkCarveVolumeInternals.h"

#include "Error.h"
#include "PipelineGeometry.h"
#include "SurfaceInterior.h"
#include "WorldTool.h"

#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformationVector.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cmath>
#include <utility>

using deformvolume::Error;
using deformvolume::SmoothCarving;

namespace
{

bool HasLabel(vtkDataArray* labels, double label)
{
  const auto values = vtk::DataArrayValueRange<1>(labels);
  return std::any_of(
    values.begin(), values.end(), [label](double value) { return value == label; });
}

} // namespace

//------------------------------------------------------------------------------
void vtkCarveVolume::vtkInternals::Check() const
{
  if (!std::isfinite(this->Self->ToolRadius) || this->Self->ToolRadius <= 0.0)
  {
    throw Error("ToolRadius is " + std::to_string(this->Self->ToolRadius) +
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
  vtkDataArray* labels = volume->GetPointData()->GetArray(name.c_str());
  if (!labels || labels->GetNumberOfComponents() != 1 ||
    labels->GetNumberOfTuples() != volume->GetNumberOfPoints())
  {
    throw Error("The volume on input port 0 has no point array \"" + name +
      "\" of numbers, one for each of its " + std::to_string(volume->GetNumberOfPoints()) +
      " voxels. Set LabelArrayName to one, or to \"\" to carve no label.");
  }
  return labels;
}

//------------------------------------------------------------------------------
SmoothCarving vtkCarveVolume::vtkInternals::CarveLabel(vtkDataArray* labels) const
{
  const auto values = vtk::DataArrayValueRange<1>(labels);
  const double label = this->Self->Label;
  const deformvolume::Extent& all = this->Self->Edits->Editor.GetGeometry().PointExtent;
  const auto find = [&](const deformvolume::Extent& vertices, double* found)
  {
    for (int z = vertices[4]; z <= vertices[5]; ++z)
    {
      for (int y = vertices[2]; y <= vertices[3]; ++y)
      {
        vtkIdType voxel = ((z - all[4]) * deformvolume::GetSize(all, 1) + y - all[2]) *
            deformvolume::GetSize(all, 0) +
          vertices[0] - all[0];
        for (int x = vertices[0]; x <= vertices[1]; ++x, ++voxel)
        {
          *found++ = static_cast<double>(values[voxel]) == label ? -1.0 : 1.0;
        }
      }
    }
  };
  const deformvolume::VolumeEditor& editor = this->Self->Edits->Editor;
  if (this->Self->SmoothBoundary)
  {
    // The same for all voxels: the surface lies halfway between them.
    const glm::dvec3& spacing = editor.GetGeometry().Spacing;
    const double half =
      0.5 * std::min({ std::abs(spacing.x), std::abs(spacing.y), std::abs(spacing.z) });
    return deformvolume::FindSmoothCarving(
      editor.GetBricks(), find, half, editor.GetFarDistance(), this->Self->Edits->Progress);
  }
  return { deformvolume::FindCarvedTetrahedra(
             editor.GetBricks(), find, this->GetRule(), this->Self->Edits->Progress),
    {} };
}

//------------------------------------------------------------------------------
SmoothCarving vtkCarveVolume::vtkInternals::Carve(
  vtkInformationVector** input, const deformvolume::CarvingTool& tool) const
{
  vtkEdits& edits = *this->Self->Edits;
  const deformvolume::VertexPositions& vertices = edits.GetVertices(input);
  if (this->Self->SmoothBoundary)
  {
    return deformvolume::FindSmoothCarving(
      vertices, tool, edits.Editor.GetFarDistance(), edits.Progress);
  }
  return { deformvolume::FindCarvedTetrahedra(vertices, tool, this->GetRule(), edits.Progress),
    {} };
}

//------------------------------------------------------------------------------
void vtkCarveVolume::vtkInternals::Find(Body& body, Body::Key&& next,
  const std::function<SmoothCarving()>& carve, std::vector<Change>& changes)
{
  if (next == body.Carved)
  {
    return;
  }
  const bool isThere = next != Body::Key();
  changes.push_back({ &body, std::move(next), isThere ? carve() : SmoothCarving() });
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
    vtkPolyData::GetData(input[1]), glm::dvec3(0.0), "surface on input port 1");
  const deformvolume::ImageGeometry& geometry = edits.Editor.GetGeometry();
  const double sheetVersion = this->SheetVersion + (sheet == this->Sheet ? 0.0 : 1.0);
  constexpr double smooth = -1.0; // in place of a rule
  const double rule = this->Self->SmoothBoundary ? smooth : this->Self->Rule;

  std::vector<Change> changes;
  vtkImplicitFunction* function = this->Self->ImplicitFunction;
  this->Find(
    this->Function,
    function ? Body::Key{ { { function, function->GetMTime() } }, { rule } } : Body::Key(),
    [&]
    {
      return this->Carve(
        input, deformvolume::GetInIndices(deformvolume::MakeWorldTool(function), geometry));
    },
    changes);
  this->Find(
    this->Surface, sheet.IsEmpty() ? Body::Key() : Body::Key{ {}, { rule, sheetVersion } },
    [&]
    {
      deformvolume::CarvingTool tool = deformvolume::MakeSurfaceInterior(
        sheet.GetSheet(geometry), edits.GetVertices(input).GetBox());
      if (this->Self->SmoothBoundary)
      {
        tool.Distance = deformvolume::MakeDistance(sheet, geometry);
      }
      return this->Carve(input, tool);
    },
    changes);
  const std::size_t beforeLabel = changes.size();
  this->Find(
    this->Label,
    labels ? Body::Key{ { { labels, labels->GetMTime() } }, { rule, this->Self->Label } }
           : Body::Key(),
    [&] { return this->CarveLabel(labels); }, changes);
  std::vector<glm::dvec3> stroke;
  for (const deformvolume::ToolPath::Position& position : edits.Tool.GetStroke())
  {
    stroke.push_back(position[0]);
  }
  SmoothCarving byTool;
  if (!stroke.empty())
  {
    byTool = this->Carve(input,
      deformvolume::GetInIndices(
        deformvolume::MakeSweptSphere(stroke, glm::dvec3(this->Self->ToolRadius)), geometry));
  }

  if (labels && changes.size() > beforeLabel && !HasLabel(labels, this->Self->Label))
  {
    vtkWarningWithObjectMacro(this->Self,
      << "No voxel has the label " << this->Self->Label << " in \"" << this->Self->LabelArrayName
      << "\", so nothing of it is carved out. Set Label to a value that occurs.");
  }
  for (Change& change : changes)
  {
    Body& body = *change.Changed;
    if (change.Next != Body::Key())
    {
      edits.Editor.Put(body.Edit, std::move(change.Carved), this->Self->Accumulate);
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
