// SPDX-License-Identifier: BSD-3-Clause
// How vtkDeformVolumeFilter works on a part of the volume, of the output or of the deformation
// mesh.
#include "vtkDeformVolumeFilterInternals.h"

#include "Device.h"
#include "InputUpdate.h"
#include "MaskArray.h"
#include "RankSettings.h"

#include "vtkInformation.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <memory>
#include <set>
#include <type_traits>

using deformvolume::DeformationSource;
using deformvolume::Error;
using deformvolume::Extent;
using deformvolume::ImageGeometry;
using deformvolume::Ranks;
using deformvolume::RestRegions;

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::CheckSettings(const Ranks& ranks) const
{
  if (!ranks.AreMany())
  {
    return;
  }
  const auto join = [](const std::set<std::string>& names)
  {
    std::string all;
    for (const std::string& name : names)
    {
      all += name + '\0';
    }
    return all;
  };
  // Device and MemoryLimit belong to a rank. Incremental and OutputOnDevice change no voxel.
  deformvolume::RankSettings settings;
  settings.AddConnection(this->Self, 1, "deformation");
  settings.AddConnection(this->Self, 2, "mesh at rest");
  settings.AddConnection(this->Self, ReferencePort, "reference image");
  settings.Add("DisplacementScale", this->Self->DisplacementScale);
  settings.Add("PointsAreDeformed", this->Self->PointsAreDeformed);
  settings.Add("FieldIsInverse", this->Self->FieldIsInverse);
  settings.Add("OutputBoundsMode", this->Self->OutputBoundsMode);
  settings.Add("CustomBounds", this->Self->CustomBounds);
  settings.Add("Padding", this->Self->Padding);
  settings.Add("BoundsGranularity", this->Self->BoundsGranularity);
  settings.Add("OutputSpacingMode", this->Self->OutputSpacingMode);
  settings.Add("CustomSpacing", this->Self->CustomSpacing);
  settings.Add("SamplingFactor", this->Self->SamplingFactor);
  settings.Add("BackgroundValue", this->Self->BackgroundValue);
  settings.Add("OutsideMode", this->Self->OutsideMode);
  settings.Add("FadeDistance", this->Self->FadeDistance);
  settings.Add("Resampler", this->Self->Resampler);
  settings.Add("Interpolation", this->Self->Interpolation);
  settings.Add("GenerateRestPositions", this->Self->GenerateRestPositions);
  settings.Add("GenerateJacobian", this->Self->GenerateJacobian);
  settings.Add("GenerateFoldCount", this->Self->GenerateFoldCount);
  settings.Add("OpenSplits", this->Self->OpenSplits);
  settings.Add("The list of categorical arrays", join(this->CategoricalArrays));
  settings.Add("The list of density arrays", join(this->DensityArrays));
  settings.Check(ranks);
}

//------------------------------------------------------------------------------
DeformationSource vtkDeformVolumeFilter::vtkInternals::ReadDeformation(
  const Ranks& ranks, const ImageGeometry& volume, vtkDataObject* shape, vtkDataObject* rest)
{
  DeformationSource source;
  ranks.Attempt(
    [&]
    {
      if (this->Self->GetNumberOfInputConnections(1) == 0)
      {
        source = this->MakeSourceAtRest(volume);
        return;
      }
      source = this->MakeSource(volume, shape, rest);
      source.ShapeIsMade = !deformvolume::IsInMemory(this->Self, 1);
      source.RestIsMade = !deformvolume::IsInMemory(this->Self, 2);
      this->Grids.Find(source);
    });
  // Copies of nodes at the borders of pieces are no splits.
  source = this->Gathering.Gather(ranks, source, this->Self->OpenSplits);
  ranks.Attempt(
    [&]
    {
      // The vectors are needed on the host for voxels that are kept, and for Jacobians.
      const std::string device = this->GetDeviceRequest();
      source.Device = !ranks.AreMany() && this->Self->OutsideMode != KEEP &&
          !this->GetExtraArrays().NeedsJacobian() &&
          deformvolume::GetDeviceAbilities(device).OwnMemory
        ? deformvolume::ResolveDevice(device)
        : "";
    });
  ranks.Attempt(
    [&]
    {
      this->State->Deformation.Read(source);
      this->CheckOutside();
    });
  return source;
}

//------------------------------------------------------------------------------
bool vtkDeformVolumeFilter::vtkInternals::WantsPart(vtkInformation* output) const
{
  Extent whole;
  output->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole.data());
  return this->Self->OutputBoundsMode == CUSTOM_BOUNDS || this->Reference ||
    deformvolume::GetRequestedPart(output) != whole;
}

//------------------------------------------------------------------------------
bool vtkDeformVolumeFilter::vtkInternals::CanTakePart(vtkInformation* volumeInfo) const
{
  // A smooth cut needs the whole volume: the motion of its two sides does not follow from a part.
  // Coarse volumes have no smooth cuts.
  const bool isCut =
    this->Self->SamplingFactor == 1 && (this->HadCut || deformvolume::IsCutAnnounced(volumeInfo));
  // Mesh rasterization needs the whole volume. So do voxels outside a mesh that follow the nearest
  // tetrahedron, which may be anywhere.
  const bool exact = this->Self->Resampler != MESH_RASTERIZATION;
  const bool local = this->State->Deformation.IsField() ? !this->State->Deformation.IsInverseField()
                                                        : this->Self->OutsideMode == DISCARD;
  // Voxels outside a mesh have the Jacobian of the nearest voxel inside, which may be anywhere.
  const bool isDerived = this->GetExtraArrays().NeedsJacobian();
  // A volume that is already in memory is used as a whole.
  return exact && local && !isDerived && !isCut && !deformvolume::IsInMemory(this->Self, 0) &&
    deformvolume::CanProduceParts(this->Self, 0);
}

//------------------------------------------------------------------------------
const RestRegions& vtkDeformVolumeFilter::vtkInternals::GetRegions(
  const ImageGeometry& volume, const DeformationSource& source)
{
  const deformvolume::OutsideVoxels outside = this->GetOutside();
  const deformvolume::ExecutionState::RegionsKey key{
    this->State->Deformation.GetRestMesh().GetShapeVersion(),
    this->State->Deformation.GetVectorsVersion(), volume, source.ToOutput, outside
  };
  if (!this->State->Regions || this->State->KeyOfRegions != key)
  {
    this->State->Deformation.BringToHost();
    const deformvolume::VoxelGrid voxelGrid{ volume.PointExtent, source.ToOutput, {} };
    this->State->Regions = this->State->Deformation.IsField()
      ? std::make_unique<RestRegions>(voxelGrid, this->State->Deformation.GetField(outside))
      : std::make_unique<RestRegions>(voxelGrid, this->State->Deformation.GetRestPoints(),
          this->State->Deformation.GetTetrahedra(),
          this->State->Deformation.GetNodeDisplacements());
    this->State->KeyOfRegions = key;
  }
  return *this->State->Regions;
}

//------------------------------------------------------------------------------
Extent vtkDeformVolumeFilter::vtkInternals::KeepNeeded(
  const Extent& needed, const ImageGeometry& volume, vtkInformation* output)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  Extent asked;
  Extent whole;
  output->Get(Pipeline::UPDATE_EXTENT(), asked.data());
  output->Get(Pipeline::WHOLE_EXTENT(), whole.data());
  // Other custom bounds or another reference image need other voxels, and no longer the previous
  // ones.
  if (asked == whole && this->Self->OutputBoundsMode != CUSTOM_BOUNDS && !this->Reference)
  {
    asked = deformvolume::EmptyExtent;
  }
  const deformvolume::ExecutionState::OutputPart part{ asked,
    output->Get(Pipeline::UPDATE_PIECE_NUMBER()), output->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()),
    volume };
  Extent kept = needed;
  if (part == this->State->LastPart)
  {
    deformvolume::Include(kept, this->State->LastNeeded);
  }
  this->State->LastPart = part;
  this->State->LastNeeded = kept;
  return kept;
}

//------------------------------------------------------------------------------
Extent vtkDeformVolumeFilter::vtkInternals::GetNeededExtent(
  const Ranks& ranks, vtkInformation* volumeInfo, vtkInformation* output)
{
  const ImageGeometry fine = this->VolumeGeometry.Find(this->Self, 0, output, ranks);
  Extent needed = fine.PointExtent;
  if (!ranks.IsAny(this->WantsPart(output)))
  {
    return needed;
  }
  const ImageGeometry volume = this->GetCoarseGeometry(fine);
  vtkDataObject* shape = deformvolume::UpdateInput(this->Self, 1, output, nullptr, ranks);
  vtkDataObject* rest = deformvolume::UpdateInput(this->Self, 2, output, nullptr, ranks);
  const DeformationSource source = this->ReadDeformation(ranks, volume, shape, rest);
  ranks.Attempt(
    [&]
    {
      if (!this->CanTakePart(volumeInfo))
      {
        return;
      }
      const RestRegions& regions = this->GetRegions(volume, source);
      if (!regions.HasVoxels())
      {
        return; // RequestData() reports what is wrong
      }
      needed = deformvolume::RefineExtent(
        this->KeepNeeded(regions.Find(deformvolume::GetRequestedPart(output)), volume, output),
        this->Self->SamplingFactor);
    });
  return needed;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::AddUpCounts(const Ranks& ranks)
{
  if (!ranks.AreMany())
  {
    return;
  }
  const auto addUp = [&ranks](auto& count)
  {
    count =
      static_cast<std::decay_t<decltype(count)>>(ranks.GetSum(static_cast<std::uint64_t>(count)));
  };
  addUp(this->Self->NumberOfInvertedTetrahedra);
  addUp(this->Self->NumberOfCoveredVoxels);
  addUp(this->Self->NumberOfHiddenVoxels);
  addUp(this->Report.NumberOfBricks);
  addUp(this->Report.NumberOfResampledBricks);
  // Each rank with work has counted the flat tetrahedra of the whole mesh.
  this->Self->NumberOfFlatTetrahedra = static_cast<vtkIdType>(
    ranks.GetMost(static_cast<std::uint64_t>(this->Self->NumberOfFlatTetrahedra)));
}
