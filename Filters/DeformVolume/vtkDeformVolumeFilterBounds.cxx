// SPDX-License-Identifier: BSD-3-Clause
// How vtkDeformVolumeFilter computes the extent of the deformed volume, and enlarges it over time.
#include "vtkDeformVolumeFilterInternals.h"

#include "DeformedBounds.h"
#include "InputUpdate.h"
#include "LookupBounds.h"
#include "OutputExtent.h"
#include "PipelineGeometry.h"
#include "VectorBounds.h"
#include "WorldBoxes.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleKey.h"
#include "vtkInformationDoubleVectorKey.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationKeyLookup.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cstring>

using deformvolume::DeformationSource;
using deformvolume::Error;
using deformvolume::ImageGeometry;
using deformvolume::IndexBounds;

//------------------------------------------------------------------------------
IndexBounds vtkDeformVolumeFilter::vtkInternals::ReadBounds(const deformvolume::Ranks& ranks,
  const ImageGeometry& volume, vtkInformation* output, const double* time)
{
  vtkDataObject* shape = deformvolume::UpdateInput(this->Self, 1, output, time, ranks);
  const vtkMTimeType made = shape ? shape->GetMTime() : 0;
  const auto copy = vtk::TakeSmartPointer(shape ? shape->NewInstance() : nullptr);
  if (shape)
  {
    copy->ShallowCopy(shape);
  }
  vtkDataObject* rest = deformvolume::UpdateInput(this->Self, 2, output, time, ranks);
  if (shape && shape->GetMTime() != made)
  {
    shape = copy; // the same source is upstream of both ports, and was asked for another time
  }
  const DeformationSource source = this->ReadDeformation(ranks, volume, shape, rest);
  IndexBounds bounds;
  ranks.Attempt([&] { bounds = this->ComputeBounds(volume, source); });
  this->State->VersionsInBounds = this->GetVersions();
  return bounds;
}

//------------------------------------------------------------------------------
std::pair<std::uint64_t, std::uint64_t> vtkDeformVolumeFilter::vtkInternals::GetVersions() const
{
  return { this->State->Deformation.GetRestMesh().GetShapeVersion(),
    this->State->Deformation.GetVectorsVersion() };
}

//------------------------------------------------------------------------------
IndexBounds vtkDeformVolumeFilter::vtkInternals::ComputeBounds(
  const ImageGeometry& volume, const DeformationSource& source)
{
  const deformvolume::VoxelGrid voxelGrid{ volume.PointExtent, source.ToOutput, {} };
  const deformvolume::OutsideVoxels outside = this->GetOutside();
  if (this->State->Deformation.IsField() && this->State->Deformation.GetDeviceVectors())
  {
    const std::optional<IndexBounds> bounds =
      deformvolume::FindDeformedBounds(voxelGrid, this->State->Deformation.GetFieldShape(outside),
        *this->State->Deformation.GetDeviceVectors());
    if (bounds)
    {
      return *bounds;
    }
  }
  this->State->Deformation.BringToHost();
  if (this->State->Deformation.IsField())
  {
    const deformvolume::DisplacementField field = this->State->Deformation.GetField(outside);
    const IndexBounds* known = this->State->Deformation.GetFieldBounds();
    const IndexBounds bounds = known ? *known
      : this->State->Deformation.IsInverseField()
      ? deformvolume::ComputeLookupBounds(voxelGrid, field)
      : deformvolume::ComputeDeformedBounds(voxelGrid, field);
    if (bounds.IsEmpty())
    {
      throw Error("The displacement field holds no voxel of the volume. " +
        deformvolume::DescribeBoxes(
          deformvolume::GetGeometry(vtkImageData::SafeDownCast(source.Shape)), volume));
    }
    return bounds;
  }
  if (outside.AreExtrapolated())
  {
    this->MakeLinks(voxelGrid, { volume, volume.PointExtent, outside });
    return deformvolume::ComputeDeformedBounds(voxelGrid, this->State->Mapping.GetLinks(),
      this->State->Deformation.GetTetrahedra(), this->State->Deformation.GetNodeDisplacements());
  }
  const deformvolume::Deformation& mesh = this->State->Deformation;
  const deformvolume::MappedVolume mapped{ volume, volume.PointExtent, outside };
  if (mapped.Outside.AreKept() && !this->State->Mapping.IsCurrent(mesh.GetMeshAtRest(), mapped))
  {
    this->MakeLinks(voxelGrid, mapped);
  }
  this->UpdateBoundsOfMesh(voxelGrid);
  const deformvolume::PointRanges changes = mesh.GetChanges(this->State->BoundsVectorsVersion);
  IndexBounds bounds = this->State->BoundsOfMesh.Compute(
    mesh.GetRestPoints(), mesh.GetTetrahedra(), mesh.GetNodeDisplacements(), &changes);
  this->State->BoundsVectorsVersion = mesh.GetVectorsVersion();
  if (mapped.Outside.AreKept())
  {
    bounds.Add(this->State->Mapping.GetMapping().Faded.ComputeBounds(
      voxelGrid, mesh.GetTetrahedra(), mesh.GetNodeDisplacements()));
  }
  if (bounds.IsEmpty())
  {
    // Throws an Error that says what is wrong with the mesh.
    this->State->Mapping.Update(mesh.GetMeshAtRest(), mapped, {});
    throw Error("The deformed volume has no bounds. Check the deformation mesh.");
  }
  return bounds;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::MakeLinks(
  const deformvolume::VoxelGrid& voxelGrid, const deformvolume::MappedVolume& mapped)
{
  // Bounds are computed before the output is requested, so that RequestData() has not yet checked
  // the memory for the mapping.
  const deformvolume::Deformation& mesh = this->State->Deformation;
  this->SelectDevice();
  this->CheckWithRoom(
    [&]
    {
      this->State->Device.CheckMemory(voxelGrid, {}, deformvolume::EmptyExtent, 0, mesh,
        this->State->Mapping, mapped, deformvolume::Resampling::Exact);
    });
  this->State->Mapping.Update(mesh.GetMeshAtRest(), mapped, {});
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::UpdateBoundsOfMesh(
  const deformvolume::VoxelGrid& voxelGrid)
{
  const deformvolume::RestMesh& mesh = this->State->Deformation.GetRestMesh();
  std::optional<std::vector<deformvolume::TetrahedronChange>> changes;
  const bool isSameGrid = this->State->BoundsGrid.VertexExtent == voxelGrid.VertexExtent &&
    this->State->BoundsGrid.ToOutput == voxelGrid.ToOutput;
  if (isSameGrid && this->State->BoundsShapeVersion == mesh.GetShapeVersion())
  {
    if (this->State->BoundsConnectivityVersion == mesh.GetConnectivityVersion())
    {
      return;
    }
    changes = mesh.GetChanges(this->State->BoundsConnectivityVersion);
  }
  this->State->BoundsShapeVersion = 0; // not valid if a call below throws
  if (changes)
  {
    this->State->BoundsOfMesh.ChangeConnectivity(mesh.GetPoints(), *changes);
  }
  else
  {
    this->State->BoundsOfMesh.SetMesh(voxelGrid, mesh.GetPoints(), mesh.GetTetrahedra());
  }
  this->State->BoundsShapeVersion = mesh.GetShapeVersion();
  this->State->BoundsConnectivityVersion = mesh.GetConnectivityVersion();
  this->State->BoundsGrid = voxelGrid;
}

//------------------------------------------------------------------------------
bool vtkDeformVolumeFilter::vtkInternals::DeformationHasTimes() const
{
  bool has = false;
  for (int port = 1; port < 3; ++port)
  {
    has = has ||
      (this->Self->GetNumberOfInputConnections(port) > 0 &&
        !deformvolume::GetTimes(this->Self->GetInputInformation(port, 0)).empty());
  }
  return has;
}

//------------------------------------------------------------------------------
std::optional<double> vtkDeformVolumeFilter::vtkInternals::FindTimeOfData() const
{
  auto* previous = vtkInformationDoubleKey::SafeDownCast(
    vtkInformationKeyLookup::Find("PREVIOUS_UPDATE_TIME_STEP", "vtkStreamingDemandDrivenPipeline"));
  std::optional<double> time;
  bool isOne = true;
  for (int port = 1; port < 3; ++port)
  {
    if (this->Self->GetNumberOfInputConnections(port) == 0 ||
      deformvolume::GetTimes(this->Self->GetInputInformation(port, 0)).empty())
    {
      continue;
    }
    vtkDataObject* data = this->Self->GetInputDataObject(port, 0);
    if (!data || !data->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()))
    {
      return std::nullopt;
    }
    const double now = data->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP());
    isOne = isOne && (!time || *time == now);
    time = now;
    vtkInformation* input = this->Self->GetInputInformation(port, 0);
    if (previous && !input->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP()))
    {
      input->Set(previous, now); // a request of this time need not read the step again
    }
  }
  return isOne ? time : std::nullopt;
}

//------------------------------------------------------------------------------
IndexBounds vtkDeformVolumeFilter::vtkInternals::GetDeformedBounds(
  const deformvolume::Ranks& ranks, const ImageGeometry& volume, vtkInformation* output)
{
  const DeformationSource source = this->MakeSource(volume, nullptr, nullptr);
  const deformvolume::ExecutionState::BoundsKey key{ { deformvolume::GetInputStamp(this->Self, 1),
                                                       deformvolume::GetInputStamp(this->Self, 2) },
    { volume, source.ToOutput, source.DisplacementScale, source.Choice, this->Self->OutsideMode,
      this->GetOutside().FadeDistance } };
  if (!ranks.IsAny(key != this->State->KeyOfBounds))
  {
    return this->State->Bounds;
  }
  // The bounds at one time are enough here. IncludeRequestedTimeInBounds() and
  // IncludeDataInBounds() add those at other times.
  const std::optional<double> time = deformvolume::FindTime(this->Self, 1, ReferencePort, output);
  std::uint64_t bits = 0;
  if (time)
  {
    std::memcpy(&bits, &*time, sizeof(bits));
  }
  if (!ranks.AreEqual(time ? 1 : 0) || !ranks.AreEqual(bits))
  {
    throw Error("The deformation has different time steps on different ranks. Connect a source "
                "that announces the same on all.");
  }
  const IndexBounds bounds = this->ReadBounds(ranks, volume, output, time ? &*time : nullptr);
  this->State->KeyOfBounds = key;
  this->State->Bounds = bounds;
  this->State->TimesInBounds.clear();
  if (const std::optional<double> inBounds = time ? time : this->FindTimeOfData())
  {
    this->State->TimesInBounds.insert(*inBounds);
  }
  return bounds;
}

//------------------------------------------------------------------------------
deformvolume::Extent vtkDeformVolumeFilter::vtkInternals::FindExtent(
  const IndexBounds& bounds) const
{
  const deformvolume::Extent needed =
    deformvolume::GetPadded(deformvolume::GetExtentInside(bounds), this->Self->Padding);
  return this->Self->BoundsGranularity > 1
    ? deformvolume::GetStableExtent(this->State->LastExtent, needed, this->Self->BoundsGranularity)
    : needed;
}

//------------------------------------------------------------------------------
deformvolume::Extent vtkDeformVolumeFilter::vtkInternals::GetDeformedExtent(
  const deformvolume::Ranks& ranks, const ImageGeometry& volume, vtkInformation* output)
{
  const IndexBounds bounds = this->GetDeformedBounds(ranks, volume, output);
  if (this->Self->BoundsGranularity <= 1)
  {
    this->ForgetDeformedExtent();
    return this->FindExtent(bounds);
  }
  const deformvolume::ExecutionState::ExtentKey key{ this->State->KeyOfBounds.second,
    this->Self->Padding, this->Self->BoundsGranularity };
  // The last extent is kept only if all ranks have the same one.
  bool keep = !ranks.IsAny(key != this->State->KeyOfExtent);
  for (const int end : this->State->LastExtent)
  {
    keep = ranks.AreEqual(static_cast<std::uint32_t>(end)) && keep;
  }
  if (!keep)
  {
    this->State->LastExtent = deformvolume::EmptyExtent;
  }
  deformvolume::Extent extent;
  ranks.Attempt([&] { extent = this->FindExtent(bounds); });
  this->State->KeyOfExtent = key;
  this->State->LastExtent = extent;
  return extent;
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::IncludeRequestedTimeInBounds(vtkInformation* output)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  const deformvolume::Ranks ranks;
  const bool isNew = !this->InformationFailure && this->EndsWithVolume() &&
    output->Has(Pipeline::UPDATE_TIME_STEP()) &&
    this->State->TimesInBounds.count(output->Get(Pipeline::UPDATE_TIME_STEP())) == 0 &&
    this->DeformationHasTimes();
  if (!ranks.IsAny(isNew))
  {
    return;
  }
  const double time = output->Get(Pipeline::UPDATE_TIME_STEP());
  const ImageGeometry volume =
    this->GetCoarseGeometry(this->VolumeGeometry.Find(this->Self, 0, output, ranks));
  const IndexBounds bounds = this->ReadBounds(ranks, volume, output, &time);
  this->State->TimesInBounds.insert(time);
  const deformvolume::Extent before = this->FindExtent(this->State->Bounds);
  this->State->Bounds.Add(bounds);
  const deformvolume::Extent after = this->FindExtent(this->State->Bounds);
  if (before == after)
  {
    return;
  }
  this->BoundsHaveGrown = true;
  this->DataRequest = nullptr; // the filter that requests this time may have the first step already
  if (this->Self->BoundsGranularity > 1)
  {
    this->State->LastExtent = after;
  }
  deformvolume::Extent asked;
  output->Get(Pipeline::UPDATE_EXTENT(), asked.data());
  output->Set(Pipeline::WHOLE_EXTENT(), after.data(), 6);
  if (asked == before)
  {
    output->Set(Pipeline::UPDATE_EXTENT(), after.data(), 6);
    this->ExtentBeforeGrowth = before;
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::MarkModifiedIfBoundsHaveGrown()
{
  // A filter that takes several time steps for one output sets CONTINUE_EXECUTING in the request of
  // data after each step but the last, and updates its input again. If this filter is modified in
  // between, vtkMultiTimeStepAlgorithm drops the time steps that it has collected, and then never
  // ends. It gets the new extent in its next update.
  if (this->BoundsHaveGrown && this->DataRequest &&
    !this->DataRequest->Get(vtkStreamingDemandDrivenPipeline::CONTINUE_EXECUTING()))
  {
    this->BoundsHaveGrown = false;
    this->ExtentBeforeGrowth.reset();
    this->Self->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfTooSmallExtent(vtkInformation* output)
{
  deformvolume::Extent asked;
  output->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), asked.data());
  if (this->ExtentBeforeGrowth && asked == *this->ExtentBeforeGrowth)
  {
    this->WarnOfGrowth();
  }
  this->ExtentBeforeGrowth.reset();
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::WarnOfGrowth()
{
  vtkWarningWithObjectMacro(this->Self,
    "The deformed volume extends beyond the extent of the output, and is cut off there. The extent "
    "was computed from the times of earlier updates. The next update has a larger extent. If the "
    "extent must hold the deformed volume at all times from the first update on, set "
    "OutputBoundsMode to VOLUME_BOUNDS or CUSTOM_BOUNDS, or set Padding.");
}

//------------------------------------------------------------------------------
void vtkDeformVolumeFilter::vtkInternals::IncludeDataInBounds(const deformvolume::Ranks& ranks,
  const ImageGeometry& volume, const DeformationSource& source, vtkInformation* output)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  if (!this->EndsWithVolume())
  {
    return;
  }
  const bool hasTime = output->Has(Pipeline::UPDATE_TIME_STEP()) != 0;
  const double time = hasTime ? output->Get(Pipeline::UPDATE_TIME_STEP()) : 0.0;
  const bool isKnown = hasTime && this->State->TimesInBounds.count(time) > 0;
  if (!ranks.IsAny(!isKnown && this->State->VersionsInBounds != this->GetVersions()))
  {
    return;
  }
  const deformvolume::Extent before = this->FindExtent(this->State->Bounds);
  ranks.Attempt([&] { this->State->Bounds.Add(this->ComputeBounds(volume, source)); });
  this->State->VersionsInBounds = this->GetVersions();
  if (hasTime)
  {
    this->State->TimesInBounds.insert(time);
  }
  if (this->FindExtent(this->State->Bounds) != before)
  {
    this->BoundsHaveGrown = true;
    this->WarnOfGrowth();
  }
}
