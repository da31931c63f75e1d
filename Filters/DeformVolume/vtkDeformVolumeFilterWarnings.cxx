// SPDX-License-Identifier: BSD-3-Clause
// Warnings of vtkDeformVolumeFilter after an update.
#include "vtkDeformVolumeFilterInternals.h"

#include "Deformation.h"
#include "DeformationMesh.h"
#include "Densities.h"
#include "Fading.h"
#include "IndexBounds.h"
#include "MaskArray.h"
#include "NewWarnings.h"
#include "PipelineGeometry.h"
#include "VolumeArrays.h"
#include "WorldBoxes.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <glm/common.hpp>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace
{

// Whether a part of a mesh has points in single precision.
bool HasFloats(const deformvolume::MeshParts& parts)
{
  return std::any_of(parts.begin(), parts.end(),
    [](vtkUnstructuredGrid* part)
    { return part->GetPoints() && part->GetPoints()->GetDataType() == VTK_FLOAT; });
}

} // namespace

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfInputs(vtkImageData* volume,
  const std::vector<std::string>& leftOut, const deformvolume::MappedVolume& mapped,
  const deformvolume::DeformationSource& source)
{
  const deformvolume::Deformation& deformation = this->State->Deformation;
  const auto list = [](const std::vector<std::string>& names)
  {
    std::string text;
    for (const std::string& name : names)
    {
      text += (text.empty() ? "" : ", ") + name;
    }
    return text;
  };
  std::set<std::string> warnings;
  const std::string cellArrays = list(deformvolume::GetUnusedCellArrays(volume));
  if (!cellArrays.empty())
  {
    warnings.insert("Cell arrays of the volume are not resampled: " + cellArrays +
      ". Convert them to point arrays to resample them.");
  }
  if (!leftOut.empty())
  {
    warnings.insert(
      "These point arrays of the volume are left out, because their types cannot be resampled: " +
      list(leftOut) + ".");
  }
  std::vector<std::string> unknown;
  std::copy_if(this->CategoricalArrays.begin(), this->CategoricalArrays.end(),
    std::back_inserter(unknown),
    [&](const std::string& name) { return !volume->GetPointData()->HasArray(name.c_str()); });
  if (!unknown.empty())
  {
    warnings.insert(
      "The volume has no point arrays with these names of categorical arrays: " + list(unknown) +
      ". Labels in other arrays are interpolated like intensities. Correct the names with "
      "AddCategoricalArray() and RemoveCategoricalArray().");
  }
  if (auto* const field = vtkImageData::SafeDownCast(source.Shape))
  {
    warnings.insert(
      deformvolume::GetSizeWarning(deformvolume::GetGeometry(field), mapped.Whole, mapped.Outside,
        [&]
        {
          this->State->Deformation.BringToHost();
          return deformation.GetField(mapped.Outside);
        }));
  }
  else if (!mapped.Outside.AreExtrapolated())
  {
    warnings.insert(deformvolume::GetSizeWarning(deformation.GetMeshAtRest(), mapped.Whole));
    if (HasFloats(source.GetRestParts()))
    {
      warnings.insert(deformvolume::GetRoundingWarning(deformation.GetMeshAtRest(), mapped.Whole));
    }
  }
  warnings.insert(deformvolume::DescribeIgnored(source.ShapeParts));
  warnings.erase(""); // the functions above return "" if there is nothing to warn of
  using Attributes = vtkDataSetAttributes;
  for (const auto& [role, kind] : { std::pair(Attributes::VECTORS, "vectors"),
         std::pair(Attributes::NORMALS, "normals"), std::pair(Attributes::TENSORS, "tensors") })
  {
    if (vtkDataArray* array = volume->GetPointData()->GetAttribute(role))
    {
      warnings.insert(std::string("The active ") + kind + " \"" +
        (array->GetName() ? array->GetName() : "") +
        "\" of the volume are interpolated component by component, and not rotated with the "
        "deformation. If their directions matter, rotate them afterwards.");
    }
  }
  if (!deformation.IsField())
  {
    deformvolume::AddCellWarnings(deformation.GetRestMesh(), this->Gathering, warnings);
  }
  const std::string news = deformvolume::ReplaceWarnings(this->WarnedOf, std::move(warnings));
  if (!news.empty())
  {
    vtkWarningWithObjectMacro(this->Self, << news);
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfLoss(const deformvolume::ExtraArrays::Loss& loss)
{
  const std::string text =
    deformvolume::DescribeLoss(this->DensityArrays.empty() ? 0 : this->Report.NumberOfHiddenSamples,
      this->Report.NumberOfCoveredVoxels, loss.NumberOfVoxels, "0");
  if (!text.empty() && text != this->WarnedOfLoss)
  {
    vtkWarningWithObjectMacro(this->Self, << text);
  }
  this->WarnedOfLoss = text;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfSplits(vtkImageData* volume)
{
  const deformvolume::Deformation& mesh = this->State->Deformation;
  const std::uint64_t shape = mesh.GetRestMesh().GetShapeVersion();
  if (mesh.IsField() || mesh.GetDeviceVectors() || this->Self->OpenSplits ||
    this->Self->ResamplerInUse == MESH_RASTERIZATION || deformvolume::HasCut(volume) ||
    volume->GetCellData()->HasArray(deformvolume::ActiveTetrahedraName))
  {
    this->State->WarnedOfSplitsOf = 0;
    return;
  }
  if (this->State->WarnedOfSplitsOf == shape)
  {
    return;
  }
  deformvolume::Extent voxels;
  volume->GetExtent(voxels.data());
  this->State->Splits.Update(mesh.GetMeshAtRest(), this->Self->OutsideMode == DISCARD);
  const std::string text = this->State->Splits.Describe(mesh.GetNodeDisplacements(), voxels);
  // The search for hidden voxels takes long.
  const bool warns = !text.empty() && !volume->HasAnyBlankPoints() && !volume->HasAnyBlankCells();
  this->State->WarnedOfSplitsOf = warns ? shape : 0;
  if (warns)
  {
    vtkWarningWithObjectMacro(this->Self,
      << text
      << " Cut the volume along the split, or let the filter open splits (deform-volume: "
         "--open-splits).");
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfOverlap(const deformvolume::MappedVolume& mapped)
{
  const deformvolume::Deformation& mesh = this->State->Deformation;
  if (mesh.IsField() || this->Self->ResamplerInUse == MESH_RASTERIZATION ||
    !this->State->Mapping.IsCurrent(mesh.GetMeshAtRest(), mapped))
  {
    return;
  }
  const std::string text = deformvolume::DescribeOverlap(this->State->Mapping.GetMapping());
  const std::uint64_t shape = mesh.GetRestMesh().GetShapeVersion();
  if (!text.empty() && this->State->WarnedOfOverlapOf != shape)
  {
    this->State->WarnedOfOverlapOf = shape;
    vtkWarningWithObjectMacro(this->Self, << text);
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfFading(vtkImageData* volume,
  const deformvolume::MappedVolume& mapped, const deformvolume::Extent& output)
{
  const deformvolume::Deformation& mesh = this->State->Deformation;
  if (mesh.IsField())
  {
    if (mapped.Outside.AreKept())
    {
      this->WarnOfFadingField(mapped, output);
    }
    return;
  }
  const deformvolume::FadedLinks& links = this->State->Mapping.GetMapping().Faded;
  if (links.IsEmpty() || !this->State->Mapping.IsCurrent(mesh.GetMeshAtRest(), mapped))
  {
    return;
  }
  const std::pair<std::uint64_t, std::uint64_t> versions(
    this->State->Mapping.GetVersion(), mesh.GetVectorsVersion());
  if (this->State->VersionsOfFading == versions)
  {
    return;
  }
  const deformvolume::VolumeMasks read = deformvolume::ReadMasks(volume, {});
  const deformvolume::WorldMasks masks{ read.Blanked, read.Active, read.Distances.Values,
    read.Cut.Crossed, read.Cut.Distances.Values, read.BlankedBits };
  const std::string text =
    deformvolume::GetFadingWarning(links, mesh.GetTetrahedra(), mesh.GetNodeDisplacements(),
      this->GetOutputGeometry(mapped.Whole).Spacing, mapped.Outside.FadeDistance, masks);
  if (!text.empty())
  {
    this->State->VersionsOfFading = versions; // otherwise another mask may call for a warning
    vtkWarningWithObjectMacro(this->Self, << text);
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfFadingField(
  const deformvolume::MappedVolume& mapped, const deformvolume::Extent& output)
{
  const deformvolume::Deformation& deformation = this->State->Deformation;
  const deformvolume::Extent& moved =
    deformation.IsInverseField() ? output : mapped.Whole.PointExtent;
  const std::string fault = deformvolume::GetFadingWarning(deformation.GetField(mapped.Outside),
    deformvolume::GetBox({ moved, {}, {} }),
    glm::abs(this->GetOutputGeometry(mapped.Whole).Spacing), mapped.Outside.FadeDistance);
  if (!fault.empty() && fault != this->State->FadingWarning)
  {
    vtkWarningWithObjectMacro(this->Self, << fault);
  }
  this->State->FadingWarning = fault;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfNothing() const
{
  std::string text;
  if (this->Self->GetNumberOfInputConnections(1) > 0 && this->State->Deformation.IsInverseField())
  {
    text = "The inverse displacement field leads from no voxel of the output into the volume, so "
           "the whole output is background. Check that the field holds points of ";
    text += this->Reference ? "the reference image" : "the output";
    text += ", that its vectors lead from there to the volume, and that all are in the same world "
            "coordinates.";
  }
  else
  {
    text = "The deformed volume covers no voxel of the output, so the whole output is background. "
           "Check ";
    text += this->Reference
      ? "that the reference image overlaps the deformed volume, in the same world coordinates"
      : "the output bounds and the output spacing";
    text += this->Self->GetNumberOfInputConnections(1) == 0 ? "."
      : this->State->Deformation.IsField()
      ? ", and that the displacement field holds neighboring voxels of the volume on each axis. A "
        "field of one slice does not."
      : ", and that the deformation mesh holds neighboring voxels of the volume.";
  }
  vtkWarningWithObjectMacro(this->Self, << text);
}
