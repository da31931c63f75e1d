// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeDeformer.h"

#include "CompilationWatch.h"
#include "FieldParameters.h"
#include "MemoryNeeds.h"
#include "MeshChecks.h"
#include "ParallelFor.h"
#include "VectorConverter.h"
#include "VolumeDeformerInternals.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace deformvolume
{
namespace
{

void CheckGrid(const VoxelGrid& voxelGrid)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    if (GetSize(voxelGrid.VertexExtent, axis) < 2)
    {
      throw Error("A volume needs at least two voxels on each axis.");
    }
  }
  const OutputMap& map = voxelGrid.ToOutput;
  const auto isFinite = [](double element) { return std::isfinite(element); };
  const double determinant = map.GetDeterminant();
  if (!std::all_of(map.Matrix.begin(), map.Matrix.end(), isFinite) ||
    !std::all_of(map.Shift.begin(), map.Shift.end(), isFinite) || !isFinite(determinant) ||
    determinant == 0.0)
  {
    throw Error("The matrix from the volume to the output must be finite and invertible.");
  }
}

void CheckArrays(const std::vector<VolumeArray>& arrays)
{
  if (arrays.empty())
  {
    throw Error("The volume has no array to deform.");
  }
  for (const VolumeArray& array : arrays)
  {
    if (!array.Data || array.Components < 1)
    {
      throw Error("An array of the volume has no data.");
    }
  }
}

// Undefined points have not-a-number on all axes. Other vectors must be finite and not too large.
void CheckInverseVectors(const DisplacementField& field)
{
  CheckHasPoints(field);
  const auto count = static_cast<std::size_t>(GetNumberOfPoints(field));
  const std::size_t bad = FindFirst(count, 16384,
    [&](std::size_t point)
    {
      const float* v = field.Vectors + 3 * point;
      const auto isGood = [](float component)
      { return std::abs(component) <= LargestDisplacement; };
      const bool isUndefined = std::isnan(v[0]) && std::isnan(v[1]) && std::isnan(v[2]);
      return !isUndefined && !std::all_of(v, v + 3, isGood);
    });
  if (bad < count)
  {
    ThrowBadDisplacement("point", bad);
  }
}

} // namespace

VolumeDeformer::VolumeDeformer()
  : Impl(new Internals)
{
}

VolumeDeformer::~VolumeDeformer() = default;

std::string VolumeDeformer::SetDevice(const std::string& request)
{
  Internals& impl = *this->Impl;
  return impl.Guard(
    [&]
    {
      impl.Budget.ForgetSystemMemory();
      return impl.Device.Choose(request, [&] { impl.Forget(); });
    });
}

void VolumeDeformer::SetMemoryLimit(std::uint64_t bytes)
{
  this->Impl->Budget.SetLimit(bytes);
}

void VolumeDeformer::SetAllocationLimit(std::uint64_t bytes)
{
  this->Impl->Device.SetAllocationLimit(bytes);
}

void VolumeDeformer::SetWorkGroupSize(std::size_t size)
{
  this->Impl->Device.SetWorkGroupSize(size);
}

void VolumeDeformer::CheckMemory(const DeformationSize& size, std::uint64_t heldBytes) const
{
  this->Impl->Guard(
    [&] { deformvolume::CheckMemory(this->Impl->Device, this->Impl->Budget, size, heldBytes); });
}

bool VolumeDeformer::HasVoxelGrid() const
{
  return this->Impl->All != nullptr;
}

void VolumeDeformer::SetVoxelGrid(
  const VoxelGrid& voxelGrid, std::size_t bytesPerVoxel, bool withLinks)
{
  CheckGrid(voxelGrid);
  Internals& impl = *this->Impl;
  impl.Guard(
    [&]
    {
      impl.Forget(); // frees the memory of the previous grid first
      impl.All = std::make_unique<Internals::Parts>(
        impl.Device, impl.Budget, voxelGrid, bytesPerVoxel, withLinks);
    });
}

void VolumeDeformer::SetArrays(const std::vector<VolumeArray>& arrays)
{
  CheckArrays(arrays);
  this->Impl->Send(
    [&](Internals::Parts& parts)
    {
      parts.Incremental.Invalidate();
      parts.Volume.GetArrays().Set(arrays, parts.Source.GetFieldInPlace());
    });
}

void VolumeDeformer::SetArrayOptions(const std::vector<VolumeArray>& arrays)
{
  Internals::Parts& parts = this->Impl->GetParts();
  if (parts.Volume.GetArrays().SetOptions(arrays))
  {
    parts.Incremental.Invalidate();
  }
}

void VolumeDeformer::SetBlanked(
  const unsigned char* blanked, unsigned char bits, const PointRanges* written)
{
  this->Impl->Send(
    [&](Internals::Parts& parts)
    {
      parts.Incremental.ChangeMask(
        parts.Volume.GetMasks().SetBlanked(blanked, bits, written), false);
    });
}

void VolumeDeformer::SetActiveTetrahedra(const unsigned char* active, const PointRanges* written)
{
  this->Impl->Send([&](Internals::Parts& parts)
    { parts.Incremental.ChangeMask(parts.Volume.GetMasks().SetActive(active, written), true); });
}

void VolumeDeformer::SetBoundaryDistances(const float* distances, const PointRanges* written)
{
  this->Impl->Send(
    [&](Internals::Parts& parts)
    {
      parts.Incremental.ChangeMask(
        parts.Volume.GetMasks().SetBoundaryDistances(distances, written), false);
    });
}

void VolumeDeformer::SetCut(const unsigned char* crossed, const float* distances)
{
  if ((crossed != nullptr) != (distances != nullptr))
  {
    throw Error("A cut needs both the crossed tetrahedra and the distances of the voxels.");
  }
  this->Impl->Send(
    [&](Internals::Parts& parts)
    {
      const int halo = parts.Volume.GetBricks().Halo;
      const std::vector<Extent> changes = parts.Volume.SetCut(crossed, distances);
      if (halo != parts.Volume.GetBricks().Halo)
      {
        parts.Source.ChangeHalo();
      }
      parts.Incremental.ChangeCut(changes);
    });
}

void VolumeDeformer::SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  std::size_t numberOfNodes, const VertexLink* links, const MeshBoundary* boundary)
{
  CheckMesh(links ? tetrahedra : nullptr, numberOfTetrahedra, numberOfNodes);
  this->Impl->Send(
    [&](Internals::Parts& parts)
    {
      CheckLinks(
        links, GetNumberOfPoints(parts.Volume.GetVoxelGrid().VertexExtent), numberOfTetrahedra);
      parts.SetMesh(tetrahedra, numberOfTetrahedra, numberOfNodes, links, boundary);
    });
}

void VolumeDeformer::SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  std::size_t numberOfNodes, const VertexRuns& runs, const MeshBoundary* boundary)
{
  CheckMesh(tetrahedra, numberOfTetrahedra, numberOfNodes);
  this->Impl->Send(
    [&](Internals::Parts& parts)
    {
      CheckRuns(runs, parts.Volume.GetVoxelGrid(), numberOfTetrahedra);
      parts.SetMesh(tetrahedra, numberOfTetrahedra, numberOfNodes, runs, boundary);
    });
}

void VolumeDeformer::ChangeConnectivity(const Tetrahedron* tetrahedra,
  std::size_t numberOfTetrahedra, std::size_t numberOfNodes,
  const std::vector<TetrahedronChange>* changes)
{
  this->Impl->Send(
    [&](Internals::Parts& parts)
    {
      if (!tetrahedra && !parts.Exact.GetBoundary().IsEmpty())
      {
        throw Error("ChangeConnectivity needs all tetrahedra if the boundary of the mesh is set.");
      }
      parts.Source.ChangeConnectivity(tetrahedra, numberOfTetrahedra, numberOfNodes, changes);
      parts.Exact.GetBoundary().SetCorners(tetrahedra);
    });
}

void VolumeDeformer::SetCoincidentNodes(const std::int32_t* numbers)
{
  this->Impl->Send(
    [&](Internals::Parts& parts)
    {
      const bool wasOn = parts.Volume.GetMasks().GetResampledMask().HasCoincidentNodes();
      parts.Source.SetCoincidentNodes(numbers);
      if (wasOn != parts.Volume.GetMasks().GetResampledMask().HasCoincidentNodes())
      {
        parts.Incremental.Invalidate();
      }
    });
}

void VolumeDeformer::SetRestMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  std::size_t numberOfNodes, const double* restNodes)
{
  CheckMesh(restNodes ? tetrahedra : nullptr, numberOfTetrahedra, numberOfNodes);
  this->Impl->Send(
    [&](Internals::Parts& parts)
    {
      parts.SetBoundary({}, nullptr);
      parts.Source.Forget();
      parts.Rasterizer.SetMesh(tetrahedra, numberOfTetrahedra, restNodes, numberOfNodes);
    });
}

void VolumeDeformer::SetInverseField(const DisplacementField& field)
{
  CheckHasPoints(field);
  this->Impl->Send(
    [&](Internals::Parts& parts)
    {
      CheckInverseVectors(field);
      parts.SetBoundary({}, nullptr);
      parts.Source.Forget();
      parts.Rasterizer.SetField(field);
    });
}

void VolumeDeformer::SetNodeDisplacements(
  const float* displacements, const PointRanges* changes, bool areChecked)
{
  this->Impl->Send([&](Internals::Parts& parts)
    { parts.SetNodeDisplacements(displacements, changes, areChecked); });
}

void VolumeDeformer::SetDisplacementField(
  const DisplacementField& field, const PointRanges* changes)
{
  CheckHasPoints(field);
  this->Impl->Send(
    [&](Internals::Parts& parts)
    {
      parts.Rasterizer.Clear();
      parts.Source.SetField(field, changes);
      parts.UpdateFieldBoundary(field);
    });
}

void VolumeDeformer::SetNodeDisplacements(
  const std::shared_ptr<DeviceVectors>& vectors, const std::array<double, 9>& toDisplacement)
{
  this->Impl->Send(
    [&](Internals::Parts& parts)
    {
      if (!parts.Rasterizer.HasMesh())
      {
        parts.CheckMesh();
        parts.Source.SetNodeDisplacements(vectors, toDisplacement);
        return;
      }
      // Mesh rasterization takes its nodes from the host.
      DisplacementField field;
      field.ToDisplacement = toDisplacement;
      VectorConverter reading(this->Impl->Device);
      reading.Begin(vectors, field, parts.Rasterizer.GetNumberOfNodes());
      parts.SetNodeDisplacements(reading.GetDisplacements({}), nullptr, false);
    });
}

void VolumeDeformer::SetDisplacementField(
  const DisplacementField& field, const std::shared_ptr<DeviceVectors>& vectors)
{
  this->Impl->Send(
    [&](Internals::Parts& parts)
    {
      parts.Source.SetField(field, vectors);
      parts.UpdateFieldBoundary(field);
      parts.Rasterizer.Clear();
    });
}

DeformReport VolumeDeformer::Deform(const DeformRequest& request)
{
  if (GetNumberOfPoints(request.OutputExtent) == 0)
  {
    throw Error("The extent of the output is empty.");
  }
  Internals::Parts& parts = this->Impl->GetParts();
  parts.CheckRequest(request);
  const MemoryBudget::UpdateGuard guard(this->Impl->Budget);
  const CompilationWatch compilation(request.Compiling);
  DeformReport report = this->Impl->Guard([&] { return parts.Deform(request); });
  report.TransferTime += std::exchange(this->Impl->SendingTime, 0.0);
  report.CompilationTime = compilation.GetSeconds();
  return report;
}

std::uint64_t VolumeDeformer::GetDeviceMemory() const
{
  return this->Impl->GetMemory();
}

void VolumeDeformer::ReleaseMemory()
{
  this->Impl->Budget.ForgetSystemMemory();
  this->Impl->Forget();
}

} // namespace deformvolume
