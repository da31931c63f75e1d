// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeDeformer.h"

#include "CompilationWatch.h"
#include "FieldParameters.h"
#include "MemoryNeeds.h"
#include "MeshChecks.h"
#include "VolumeDeformerInternals.h"

#include <cmath>

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
    if (!(voxelGrid.Scale[axis] > 0.0) || !std::isfinite(voxelGrid.Scale[axis]))
    {
      throw Error("The ratio of the spacings must be greater than 0.");
    }
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

} // namespace

VolumeDeformer::VolumeDeformer()
  : Impl(new Internals)
{
}

VolumeDeformer::~VolumeDeformer() = default;

std::string VolumeDeformer::SetDevice(const std::string& request)
{
  return this->Impl->Guard(
    [&]
    {
      this->Impl->GetBudget().ForgetSystemMemory();
      this->Impl->SelectDevice(request);
      return this->Impl->GetDevice().GetDevice().Name;
    });
}

void VolumeDeformer::SetMemoryLimit(std::uint64_t bytes)
{
  this->Impl->GetBudget().SetLimit(bytes);
}

void VolumeDeformer::SetAllocationLimit(std::uint64_t bytes)
{
  this->Impl->GetDevice().SetAllocationLimit(bytes);
}

void VolumeDeformer::SetWorkGroupSize(std::size_t size)
{
  this->Impl->GetDevice().SetWorkGroupSize(size);
}

void VolumeDeformer::CheckMemory(const VoxelGrid& voxelGrid, const std::vector<VolumeArray>& arrays,
  const Extent& outputExtent, std::size_t numberOfNodes, std::size_t numberOfTetrahedra, bool field,
  std::uint64_t runBytes, std::uint64_t heldBytes) const
{
  const DeformationSize size{ voxelGrid, arrays, outputExtent, numberOfNodes, numberOfTetrahedra,
    GetMappingBytes(voxelGrid, field, runBytes), false };
  this->Impl->Guard(
    [&] {
      deformvolume::CheckMemory(this->Impl->GetDevice(), this->Impl->GetBudget(), size, heldBytes);
    });
}

void VolumeDeformer::CheckRasterizationMemory(const VoxelGrid& voxelGrid,
  const std::vector<VolumeArray>& arrays, const Extent& outputExtent, std::size_t numberOfNodes,
  std::size_t numberOfTetrahedra, std::uint64_t heldBytes) const
{
  const DeformationSize size{ voxelGrid, arrays, outputExtent, numberOfNodes, numberOfTetrahedra, 0,
    true };
  this->Impl->Guard(
    [&] {
      deformvolume::CheckMemory(this->Impl->GetDevice(), this->Impl->GetBudget(), size, heldBytes);
    });
}

void VolumeDeformer::SetVoxelGrid(
  const VoxelGrid& voxelGrid, std::size_t bytesPerVoxel, bool withLinks)
{
  CheckGrid(voxelGrid);
  this->Impl->Guard([&] { this->Impl->SetVolume(voxelGrid, bytesPerVoxel, withLinks); });
}

void VolumeDeformer::SetArrays(const std::vector<VolumeArray>& arrays)
{
  CheckArrays(arrays);
  this->Impl->Send([&](VolumeDeformation& volume) { volume.SetArrays(arrays); });
}

void VolumeDeformer::SetArrayOptions(const std::vector<VolumeArray>& arrays)
{
  this->Impl->GetVolume().SetArrayOptions(arrays);
}

void VolumeDeformer::SetBlanked(
  const unsigned char* blanked, unsigned char bits, const PointRanges* written)
{
  this->Impl->Send([&](VolumeDeformation& volume) { volume.SetBlanked(blanked, bits, written); });
}

void VolumeDeformer::SetActiveTetrahedra(const unsigned char* active, const PointRanges* written)
{
  this->Impl->Send([&](VolumeDeformation& volume) { volume.SetActiveTetrahedra(active, written); });
}

void VolumeDeformer::SetBoundaryDistances(const float* distances, const PointRanges* written)
{
  this->Impl->Send(
    [&](VolumeDeformation& volume) { volume.SetBoundaryDistances(distances, written); });
}

void VolumeDeformer::SetCut(const unsigned char* crossed, const float* distances)
{
  if ((crossed != nullptr) != (distances != nullptr))
  {
    throw Error("A cut needs both the crossed tetrahedra and the distances of the voxels.");
  }
  this->Impl->Send([&](VolumeDeformation& volume) { volume.SetCut(crossed, distances); });
}

void VolumeDeformer::SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  std::size_t numberOfNodes, const VertexLink* links, const MeshBoundary* boundary)
{
  CheckMesh(links ? tetrahedra : nullptr, numberOfTetrahedra, numberOfNodes);
  this->Impl->Send([&](VolumeDeformation& volume)
    { volume.SetMesh(tetrahedra, numberOfTetrahedra, numberOfNodes, links, boundary); });
}

void VolumeDeformer::SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  std::size_t numberOfNodes, const VertexRuns& runs, const MeshBoundary* boundary)
{
  CheckMesh(tetrahedra, numberOfTetrahedra, numberOfNodes);
  this->Impl->Send([&](VolumeDeformation& volume)
    { volume.SetMesh(tetrahedra, numberOfTetrahedra, numberOfNodes, runs, boundary); });
}

void VolumeDeformer::ChangeConnectivity(const Tetrahedron* tetrahedra,
  std::size_t numberOfTetrahedra, std::size_t numberOfNodes,
  const std::vector<TetrahedronChange>* changes)
{
  this->Impl->Send([&](VolumeDeformation& volume)
    { volume.ChangeConnectivity(tetrahedra, numberOfTetrahedra, numberOfNodes, changes); });
}

void VolumeDeformer::SetNodePlaces(const std::int32_t* places)
{
  this->Impl->Send([&](VolumeDeformation& volume) { volume.SetNodePlaces(places); });
}

void VolumeDeformer::SetRestMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  std::size_t numberOfNodes, const double* restNodes)
{
  CheckMesh(restNodes ? tetrahedra : nullptr, numberOfTetrahedra, numberOfNodes);
  this->Impl->Send([&](VolumeDeformation& volume)
    { volume.SetRestMesh(tetrahedra, numberOfTetrahedra, numberOfNodes, restNodes); });
}

void VolumeDeformer::SetInverseField(const DisplacementField& field)
{
  CountPoints(field); // throws where there are none
  this->Impl->Send([&](VolumeDeformation& volume) { volume.SetInverseField(field); });
}

void VolumeDeformer::SetNodeDisplacements(
  const float* displacements, const PointRanges* changes, bool areChecked)
{
  this->Impl->Send([&](VolumeDeformation& volume)
    { volume.SetNodeDisplacements(displacements, changes, areChecked); });
}

void VolumeDeformer::SetDisplacementField(
  const DisplacementField& field, const PointRanges* changes)
{
  CountPoints(field); // throws where there are none
  this->Impl->Send([&](VolumeDeformation& volume) { volume.SetDisplacementField(field, changes); });
}

void VolumeDeformer::SetNodeDisplacements(
  const std::shared_ptr<DeviceVectors>& vectors, const std::array<double, 9>& toDisplacement)
{
  this->Impl->Send(
    [&](VolumeDeformation& volume) { volume.SetNodeDisplacements(vectors, toDisplacement); });
}

void VolumeDeformer::SetDisplacementField(
  const DisplacementField& field, const std::shared_ptr<DeviceVectors>& vectors)
{
  this->Impl->Send([&](VolumeDeformation& volume) { volume.SetDisplacementField(field, vectors); });
}

DeformReport VolumeDeformer::Deform(const DeformRequest& request)
{
  if (GetNumberOfPoints(request.OutputExtent) == 0)
  {
    throw Error("The extent of the output is empty.");
  }
  VolumeDeformation& volume = this->Impl->GetVolume();
  volume.CheckRequest(request);
  const MemoryBudget::UpdateGuard guard(this->Impl->GetBudget());
  const CompilationWatch compilation(request.Compiling);
  DeformReport report = this->Impl->Guard([&] { return volume.Deform(request); });
  report.TransferTime += this->Impl->TakeSendingTime();
  report.CompilationTime = compilation.GetSeconds();
  return report;
}

std::uint64_t VolumeDeformer::GetDeviceMemory() const
{
  return this->Impl->GetMemory();
}

void VolumeDeformer::ReleaseMemory()
{
  this->Impl->GetBudget().ForgetSystemMemory();
  this->Impl->Forget();
}

} // namespace deformvolume
