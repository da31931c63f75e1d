// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeDeformation.h"

#include "Error.h"
#include "FieldParameters.h"
#include "MemoryBudget.h"
#include "ParallelFor.h"
#include "SlabLoop.h"
#include "WorkDevice.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace deformvolume
{

VolumeDeformation::VolumeDeformation(WorkDevice& device, MemoryBudget& budget,
  const VoxelGrid& voxelGrid, std::size_t bytesPerVoxel, bool withLinks)
  : Device(device)
  , Budget(budget)
  , Volume(device.GetContext(), device.GetQueue(), voxelGrid, bytesPerVoxel,
      device.GetAllocationLimit(), withLinks)
  , Incremental(device, this->Volume)
  , Source(device, this->Volume, this->Incremental.GetObserver())
  , Exact(device, budget, this->Volume, this->Source)
  , Rasterizer(device, this->Volume)
{
}

void VolumeDeformation::SetArrays(const std::vector<VolumeArray>& arrays)
{
  this->Incremental.Forget();
  this->Volume.SetArrays(arrays, this->Source.GetFieldInPlace());
}

void VolumeDeformation::SetArrayOptions(const std::vector<VolumeArray>& arrays)
{
  if (this->Volume.SetArrayOptions(arrays))
  {
    this->Incremental.Forget();
  }
}

void VolumeDeformation::SetBlanked(
  const unsigned char* blanked, unsigned char bits, const PointRanges* written)
{
  this->Incremental.ChangeMask(this->Volume.SetBlanked(blanked, bits, written), false);
}

void VolumeDeformation::SetActiveTetrahedra(const unsigned char* active, const PointRanges* written)
{
  this->Incremental.ChangeMask(this->Volume.SetActive(active, written), true);
}

void VolumeDeformation::SetBoundaryDistances(const float* distances, const PointRanges* written)
{
  this->Incremental.ChangeMask(this->Volume.SetBoundaryDistances(distances, written), false);
}

void VolumeDeformation::SetCut(const unsigned char* crossed, const float* distances)
{
  const int reach = this->Volume.GetBricks().Reach;
  const std::vector<Extent> changes = this->Volume.SetCut(crossed, distances);
  if (reach != this->Volume.GetBricks().Reach)
  {
    this->Source.ChangeReach();
  }
  this->Incremental.ChangeCut(changes);
}

void VolumeDeformation::SetNodePlaces(const std::int32_t* places)
{
  const bool wasOn = this->Volume.LeavesOutBridges();
  this->Source.SetNodePlaces(places);
  if (wasOn != this->Volume.LeavesOutBridges())
  {
    this->Incremental.Forget();
  }
}

void VolumeDeformation::SetRestMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  std::size_t numberOfNodes, const double* restNodes)
{
  this->SetBoundary({}, {}, nullptr);
  this->Source.Forget();
  this->Rasterizer.SetMesh(tetrahedra, numberOfTetrahedra, restNodes, numberOfNodes);
}

namespace
{

// Vectors of undefined points are not-a-number on all axes, others finite and not too large.
void CheckInverseVectors(const DisplacementField& field)
{
  const auto count = static_cast<std::size_t>(CountPoints(field));
  std::atomic<std::size_t> bad{ count };
  constexpr std::size_t step = 16384;
  ParallelForParts(count, step,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t point = begin; point < end; ++point)
      {
        const float* v = field.Vectors + 3 * point;
        const auto isGood = [](float component)
        { return std::abs(component) <= LargestDisplacement; };
        const bool isUndefined = std::isnan(v[0]) && std::isnan(v[1]) && std::isnan(v[2]);
        if (!isUndefined && !std::all_of(v, v + 3, isGood))
        {
          Lower(bad, point);
          return;
        }
      }
    });
  if (bad < count)
  {
    ThrowBadDisplacement("point", bad);
  }
}

} // namespace

void VolumeDeformation::SetInverseField(const DisplacementField& field)
{
  CheckInverseVectors(field);
  this->SetBoundary({}, {}, nullptr);
  this->Source.Forget();
  this->Rasterizer.SetField(field);
}

void VolumeDeformation::SetNodeDisplacements(
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

void VolumeDeformation::SetNodeDisplacements(
  const std::shared_ptr<DeviceVectors>& vectors, const std::array<double, 9>& toDisplacement)
{
  if (this->Rasterizer.HasMesh())
  {
    // Its nodes come from the host.
    DisplacementField field;
    field.ToDisplacement = toDisplacement;
    VectorReading reading(this->Device);
    reading.Begin(vectors, field, this->Rasterizer.GetNumberOfNodes());
    this->SetNodeDisplacements(reading.GetDisplacements({}), nullptr, false);
    return;
  }
  this->CheckMesh();
  this->Source.SetNodeDisplacements(vectors, toDisplacement);
}

void VolumeDeformation::CheckMesh() const
{
  if (!this->Source.HasMesh())
  {
    throw Error("No deformation mesh is set: call SetMesh first.");
  }
}

void VolumeDeformation::SetDisplacementField(
  const DisplacementField& field, const std::shared_ptr<DeviceVectors>& vectors)
{
  this->Source.SetField(field, vectors);
  this->UpdateFieldBoundary(field);
  this->Rasterizer.Clear();
}

void VolumeDeformation::SetDisplacementField(
  const DisplacementField& field, const PointRanges* changes)
{
  this->Rasterizer.Clear();
  this->Source.SetField(field, changes);
  this->UpdateFieldBoundary(field);
}

void VolumeDeformation::SetBoundary(const MeshBoundary& boundary,
  const std::vector<std::int32_t>& numbers, const Tetrahedron* tetrahedra)
{
  this->BoundaryField = DisplacementField();
  try
  {
    this->Exact.GetBoundary().Set(boundary, numbers, tetrahedra);
    this->Volume.SetBoundary(boundary, numbers);
  }
  catch (...)
  {
    this->Exact.GetBoundary().Clear();
    this->Source.Forget(); // without its boundary the deformation would lack a layer
    throw;
  }
}

void VolumeDeformation::UpdateFieldBoundary(const DisplacementField& field)
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
  this->SetBoundary(boundary, {}, nullptr);
  // Other points move the bricks at the boundary.
  this->Incremental.GetObserver().ForgetMapping();
  last.Dimensions = field.Dimensions;
  last.IndexToField = field.IndexToField;
  last.Extrapolate = field.Extrapolate;
}

void VolumeDeformation::CheckRequest(const DeformRequest& request) const
{
  const std::vector<VolumeArray>& arrays = this->Volume.GetVolumeArrays();
  const bool rasterized = request.Method == Resampling::MeshRasterization;
  if (arrays.empty())
  {
    throw Error("No arrays are set: call SetArrays first.");
  }
  if (request.Method == Resampling::Published && this->Volume.HasDistances())
  {
    throw Error("The published resampler knows no boundary distances. Use the resampler Exact or "
                "MeshRasterization, or call SetBoundaryDistances with null.");
  }
  if (request.Method == Resampling::Published && this->Volume.HasCut())
  {
    throw Error("The published resampler knows no smooth cuts. Use the resampler Exact, or call "
                "SetCut with null.");
  }
  if (rasterized && this->Volume.HasCut())
  {
    throw Error("The resampler MeshRasterization knows no smooth cuts, since it looks at the "
                "deformation mesh only. Use the resampler Exact, or call SetCut with null.");
  }
  if (!rasterized && request.Interpolation != Interpolation::Linear)
  {
    throw Error("Cubic interpolation is there only with the resampler MeshRasterization.");
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
    throw Error("The request must tell the held revision of each array and of the coverage, or of "
                "none.");
  }
  if (request.Outputs.size() != arrays.size() || !request.Coverage ||
    std::count(request.Outputs.begin(), request.Outputs.end(), nullptr))
  {
    throw Error("The request must have room for each array of the volume and for the coverage.");
  }
}

DeformationSize VolumeDeformation::GetSize(const DeformRequest& request) const
{
  const VoxelGrid& grid = this->Volume.GetVoxelGrid();
  const std::vector<VolumeArray>& arrays = this->Volume.GetVolumeArrays();
  const std::uint64_t boundary = this->Exact.GetBoundary().GetMemory() +
    (this->Volume.HasBoundary()
        ? 2 * static_cast<std::uint64_t>(GetNumberOfCells(grid.VertexExtent))
        : 0);
  if (request.Method == Resampling::MeshRasterization)
  {
    return { grid, arrays, request.OutputExtent, this->Rasterizer.GetNumberOfNodes(),
      this->Rasterizer.GetNumberOfTetrahedra(), 0, true, this->Volume.HasDistances() };
  }
  return { grid, arrays, request.OutputExtent, this->Source.GetNumberOfNodes(),
    this->Source.GetNumberOfTetrahedra(),
    boundary + GetMappingBytes(grid, !this->Volume.HasMesh(), this->Volume.GetRunBytes()), false,
    this->Volume.HasDistances() };
}

DeformReport VolumeDeformation::Deform(const DeformRequest& request)
{
  this->BringOutput(); // its memory is that of the next one
  this->Volume.ReadArraysAgain();
  this->Source.ReadFieldAgain();
  const std::uint64_t spare = CheckDeviceMemory(this->Device, this->Budget, this->GetSize(request),
    OutputSlab::GetBytesPerVoxel(
      this->Device.GetContext(), this->Volume.GetVolumeArrays(), request));
  const bool isRasterized = request.Method == Resampling::MeshRasterization;
  DeformReport report =
    isRasterized ? this->Rasterize(request, spare) : this->Resample(request, spare);
  this->Unread.Set(report.DeviceOutputs, isRasterized);
  return report;
}

DeformReport VolumeDeformation::Resample(const DeformRequest& request, std::uint64_t spare)
{
  this->Exact.Start();
  // Before anything is planned that depends on masks.
  this->Incremental.ChangeMask(this->Source.UpdateBridges(), true);
  DeformReport report;
  report.NumberOfBricks = static_cast<std::int64_t>(this->Volume.GetBricks().GetNumberOfBricks());
  if (!this->Incremental.Update(request, this->Source, this->Exact, report))
  {
    MakeSlabs(this->Exact, this->Device, this->Volume, request, spare, report);
    report.NumberOfResampledBricks = report.NumberOfBricks;
    report.ChangedExtent = request.OutputExtent;
    if (request.Incremental && this->Exact.CanMakeAgain())
    {
      this->Incremental.Start(request, this->Source, report);
    }
  }
  this->Exact.AddTimes(report);
  return report;
}

DeformReport VolumeDeformation::Rasterize(const DeformRequest& request, std::uint64_t spare)
{
  this->Incremental.Forget();
  DeformReport report;
  // As much again for lists of tetrahedra that are longer than was foreseen.
  MakeSlabs(this->Rasterizer, this->Device, this->Volume, request, spare / 2, report);
  report.ChangedExtent = request.OutputExtent;
  return report;
}

std::uint64_t VolumeDeformation::GetMemory() const
{
  return this->Volume.GetMemory() + this->Source.GetMemory() + this->Rasterizer.GetMemory() +
    this->Exact.GetMemory() + this->Unread.GetMemory();
}

} // namespace deformvolume
