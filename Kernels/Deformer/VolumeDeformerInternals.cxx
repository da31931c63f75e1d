// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeDeformerInternals.h"

#include "FieldParameters.h"
#include "HostMemory.h"
#include "SlabSizes.h"

#include <algorithm>

namespace deformvolume
{

namespace
{

// Makes the whole output of a request, in slabs that the device can allocate. Copies them to the
// memory of the request, unless the output may stay on the device and has a single slab. spare:
// device memory, in bytes, that may be used in addition to one slab.
void MakeSlabs(SlabResampler& resampler, WorkDevice& device, const DeviceVolume& volume,
  const DeformRequest& request, std::uint64_t spare, DeformReport& report)
{
  const std::vector<VolumeArray>& arrays = volume.GetArrays().Get();
  SlabPlan plan;
  plan.Slabs = SplitIntoSlabs(
    request.OutputExtent, arrays, volume.GetVoxelGrid(), device.GetAllocationLimit());
  const std::uint64_t bytes = GetOutputBytesPerVoxel(device.GetContext(), arrays, request) *
    static_cast<std::uint64_t>(GetNumberOfPoints(plan.Slabs.front()));
  const bool stays =
    request.MayStayOnDevice && !device.GetDevice().IsProcessor && plan.Slabs.size() == 1;
  // Staged copies are finished by the host, so they cannot overlap with the next slab.
  plan.Overlapped =
    bytes > 0 && plan.Slabs.size() > 1 && spare >= bytes && !device.GetContext().GetStagedCopies();
  // Also after an exception, nothing may write to the memory of the request any more.
  const SlabResampler::FinishGuard finish(resampler);
  const QueueGuard reads(device.GetReadQueue());
  resampler.Begin(request, plan, report);
  for (std::size_t slab = 0; slab < plan.Slabs.size(); ++slab)
  {
    resampler.Make(request, plan, slab, report);
    OutputMemory& target = resampler.GetTarget(plan.GetTarget(slab));
    if (stays)
    {
      report.DeviceOutputs = target.KeepOnDevice(device.GetReadQueue());
      continue;
    }
    const Stopwatch watch;
    target.Read(device.GetReadQueue(), target.GetExtent());
    if (!plan.Overlapped || slab + 1 == plan.Slabs.size())
    {
      resampler.FinishReading();
    }
    report.TransferTime += watch.GetSeconds();
  }
}

} // namespace

VolumeDeformer::Internals::Parts::Parts(WorkDevice& device, MemoryBudget& budget,
  const VoxelGrid& voxelGrid, std::size_t bytesPerVoxel, bool withLinks)
  : Device(device)
  , Budget(budget)
  , Volume(device.GetContext(), device.GetQueue(), voxelGrid, bytesPerVoxel,
      device.GetAllocationLimit(), withLinks)
  , Incremental(device, this->Volume)
  , Source(device, this->Volume, this->Incremental.GetTracker())
  , Exact(device, budget, this->Volume, this->Source)
  , Rasterizer(device, budget, this->Volume)
{
}

void VolumeDeformer::Internals::Parts::SetBoundary(
  const MeshBoundary& boundary, const Tetrahedron* tetrahedra)
{
  this->BoundaryField = DisplacementField();
  try
  {
    this->Exact.GetBoundary().Set(boundary, tetrahedra);
    this->Volume.SetBoundary(boundary, tetrahedra == nullptr);
  }
  catch (...)
  {
    this->Exact.GetBoundary().Clear();
    this->Source.Forget(); // without a boundary the outermost layer would be missing
    throw;
  }
}

void VolumeDeformer::Internals::Parts::UpdateFieldBoundary(const DisplacementField& field)
{
  DisplacementField& last = this->BoundaryField;
  if (field.Dimensions == last.Dimensions && field.IndexToField == last.IndexToField &&
    field.Extrapolate == last.Extrapolate)
  {
    return;
  }
  const VoxelGrid& grid = this->Volume.GetVoxelGrid();
  MeshBoundary boundary;
  if (!field.Extrapolate)
  {
    boundary = FindFieldBoundary(grid.VertexExtent, GetWholeExtent(grid), field);
  }
  this->SetBoundary(boundary, nullptr);
  // The new boundary has other points, so bricks at the boundary change.
  this->Incremental.GetTracker().InvalidateMapping();
  last.Dimensions = field.Dimensions;
  last.IndexToField = field.IndexToField;
  last.Extrapolate = field.Extrapolate;
}

void VolumeDeformer::Internals::Parts::CheckMesh() const
{
  if (!this->Source.HasMesh())
  {
    throw Error("No deformation mesh is set: call SetMesh first.");
  }
}

void VolumeDeformer::Internals::Parts::SetNodeDisplacements(
  const float* displacements, const PointRanges* changes, bool areChecked)
{
  if (this->Rasterizer.HasMesh())
  {
    if (!areChecked)
    {
      CheckDisplacements(displacements, this->Rasterizer.GetNumberOfNodes(), "node", nullptr);
    }
    this->Rasterizer.SetDisplacements(displacements);
    return;
  }
  this->CheckMesh();
  this->Source.SetNodeDisplacements(displacements, changes, areChecked);
}

void VolumeDeformer::Internals::Parts::CheckRequest(const DeformRequest& request) const
{
  const std::vector<VolumeArray>& arrays = this->Volume.GetArrays().Get();
  const bool rasterized = request.Method == Resampling::MeshRasterization;
  if (arrays.empty())
  {
    throw Error("No arrays are set: call SetArrays first.");
  }
  if (rasterized && this->Volume.GetMasks().HasCut())
  {
    throw Error("The resampler MeshRasterization does not support smooth cuts. Use the resampler "
                "Exact, or call SetCut with null.");
  }
  if (rasterized && !this->Rasterizer.IsReady())
  {
    throw Error("The resampler MeshRasterization needs a deformation mesh with its rest positions: "
                "call SetRestMesh and SetNodeDisplacements, or SetInverseField, first. For a "
                "forward displacement field use the resampler Exact.");
  }
  if (!rasterized && !this->Source.IsReady())
  {
    throw Error("No deformation is set: call SetMesh and SetNodeDisplacements, or "
                "SetDisplacementField, first.");
  }
  if (!request.HeldRevisions.empty() && request.HeldRevisions.size() != arrays.size() + 1)
  {
    throw Error("HeldRevisions has " + std::to_string(request.HeldRevisions.size()) +
      " values, but must have " + std::to_string(arrays.size() + 1) +
      ": one for each array and one for the coverage, or none.");
  }
  if (request.Outputs.size() != arrays.size() || !request.Coverage ||
    std::count(request.Outputs.begin(), request.Outputs.end(), nullptr))
  {
    throw Error(
      "Outputs must have a pointer for each array of the volume, and Coverage a pointer.");
  }
}

DeformationSize VolumeDeformer::Internals::Parts::GetSize(const DeformRequest& request) const
{
  const VoxelGrid& grid = this->Volume.GetVoxelGrid();
  const std::vector<VolumeArray>& arrays = this->Volume.GetArrays().Get();
  const std::uint64_t boundary = this->Exact.GetBoundary().GetMemory() +
    (this->Volume.GetMasks().HasBoundary()
        ? 2 * static_cast<std::uint64_t>(GetNumberOfCells(grid.VertexExtent))
        : 0);
  if (request.Method == Resampling::MeshRasterization)
  {
    return { grid, arrays, request.OutputExtent, this->Rasterizer.GetNumberOfNodes(),
      this->Rasterizer.GetNumberOfTetrahedra(), 0, true, this->Volume.GetMasks().HasDistances() };
  }
  return { grid, arrays, request.OutputExtent, this->Source.GetNumberOfNodes(),
    this->Source.GetNumberOfTetrahedra(),
    boundary + GetMappingBytes(grid, !this->Volume.HasMesh(), this->Volume.GetRunBytes()), false,
    this->Volume.GetMasks().HasDistances() };
}

DeformReport VolumeDeformer::Internals::Parts::Deform(const DeformRequest& request)
{
  this->BringOutput(); // the next output uses the same memory
  this->Volume.GetArrays().Reread();
  this->Source.RereadField();
  const std::uint64_t spare = CheckDeviceMemory(this->Device, this->Budget, this->GetSize(request),
    GetOutputBytesPerVoxel(this->Device.GetContext(), this->Volume.GetArrays().Get(), request));
  const bool isRasterized = request.Method == Resampling::MeshRasterization;
  DeformReport report =
    isRasterized ? this->Rasterize(request, spare) : this->Resample(request, spare);
  this->Unread.Set(report.DeviceOutputs, isRasterized);
  return report;
}

DeformReport VolumeDeformer::Internals::Parts::Resample(
  const DeformRequest& request, std::uint64_t spare)
{
  this->Exact.Start();
  // Update the resampled mask before planning, which depends on all masks.
  this->Incremental.ChangeMask(this->Source.UpdateResampledMask(), true);
  DeformReport report;
  report.NumberOfBricks = static_cast<std::int64_t>(this->Volume.GetBricks().GetNumberOfBricks());
  if (!this->Incremental.Update(request, this->Source, this->Exact, report))
  {
    MakeSlabs(this->Exact, this->Device, this->Volume, request, spare, report);
    report.NumberOfResampledBricks = report.NumberOfBricks;
    report.ChangedExtent = request.OutputExtent;
    if (request.Incremental && this->Exact.CanUpdateOutput())
    {
      this->Incremental.Start(request, this->Source, report);
    }
  }
  this->Exact.AddTimes(report);
  return report;
}

DeformReport VolumeDeformer::Internals::Parts::Rasterize(
  const DeformRequest& request, std::uint64_t spare)
{
  this->Incremental.Invalidate();
  DeformReport report;
  // Keep half of the spare memory for lists of tetrahedra that become longer than estimated.
  MakeSlabs(this->Rasterizer, this->Device, this->Volume, request, spare / 2, report);
  report.ChangedExtent = request.OutputExtent;
  return report;
}

std::uint64_t VolumeDeformer::Internals::Parts::GetMemory() const
{
  return this->Volume.GetMemory() + this->Source.GetMemory() + this->Rasterizer.GetMemory() +
    this->Exact.GetMemory() + this->Unread.GetMemory();
}

} // namespace deformvolume
