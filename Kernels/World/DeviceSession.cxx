// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceSession.h"

#include "CoincidentPoints.h"
#include "MemoryNeeds.h"
#include "WorldBoxes.h"

#include <algorithm>
#include <memory>

namespace deformvolume
{

std::string DeviceSession::SetDevice(const std::string& request, std::uint64_t memoryLimit)
{
  this->Deformer.SetMemoryLimit(memoryLimit);
  const std::string device = this->Deformer.SetDevice(request);
  if (device != this->Device)
  {
    this->Known = false;
    this->Device = device;
  }
  return device;
}

void DeviceSession::CheckMemory(const VoxelGrid& voxelGrid, const std::vector<VolumeArray>& arrays,
  const Extent& outputExtent, std::uint64_t heldBytes, const IndexDeformation& deformation,
  MappingCache& mapping, const MappedVolume& volume, Resampling method) const
{
  const MeshAtRest mesh = deformation.GetMeshAtRest();
  const bool isField = deformation.IsField();
  const bool isRasterized = method == Resampling::MeshRasterization;
  const std::size_t nodes = isField
    ? static_cast<std::size_t>(GetNumberOfPoints(deformation.GetFieldShape({})))
    : mesh.Points.size();
  const std::uint64_t runBytes = isField || isRasterized ? 0 : mapping.GetRunBytes(mesh, volume);
  this->Deformer.CheckMemory(
    { voxelGrid, arrays, outputExtent, nodes, isField ? 0 : mesh.Tetrahedra.size(),
      isRasterized ? 0 : GetMappingBytes(voxelGrid, isField, runBytes), isRasterized },
    heldBytes);
}

void DeviceSession::Send(const std::function<void()>& send)
{
  this->Known = false;
  send();
  this->Known = true;
}

void DeviceSession::SetVoxelGrid(
  const VoxelGrid& voxelGrid, const std::vector<VolumeArray>& arrays, Resampling method)
{
  if (!this->Known || !this->Deformer.HasVoxelGrid())
  {
    this->Forget();
  }
  const bool links = method != Resampling::MeshRasterization;
  std::size_t widest = 0;
  for (const VolumeArray& array : arrays)
  {
    widest = std::max(widest, GetTupleSize(array));
  }
  if (this->SentGrid.VertexExtent != voxelGrid.VertexExtent ||
    this->SentGrid.WholeExtent != voxelGrid.WholeExtent ||
    this->SentGrid.ToOutput != voxelGrid.ToOutput || this->SentWidth < widest ||
    this->SentForLinks != links)
  {
    this->Forget();
    this->Send([&] { this->Deformer.SetVoxelGrid(voxelGrid, widest, links); });
    this->SentGrid = voxelGrid;
    this->SentWidth = widest;
    this->SentForLinks = links;
  }
}

void DeviceSession::SetArrays(const std::vector<VolumeArray>& arrays, const Stamp& stamp)
{
  if (this->SentArrays != stamp)
  {
    this->Send([&] { this->Deformer.SetArrays(arrays); });
    this->SentArrays = stamp;
    ++this->NumberOfVolumeUploads;
  }
  this->Deformer.SetArrayOptions(arrays);
}

void DeviceSession::SetMasks(const WorldMasks& masks, const Stamp& stamp)
{
  if (this->SentMasks == stamp)
  {
    return;
  }
  this->Send(
    [&]
    {
      this->Deformer.SetBlanked(masks.Blanked, masks.BlankedBits, masks.WrittenBlanked);
      this->Deformer.SetActiveTetrahedra(masks.ActiveTetrahedra, masks.WrittenActive);
      this->Deformer.SetBoundaryDistances(masks.BoundaryDistances, masks.WrittenDistances);
      if (!masks.HasSameCut || this->SentMasks.empty())
      {
        this->Deformer.SetCut(masks.CutTetrahedra, masks.CutDistances);
      }
    });
  this->SentMasks = stamp;
}

void DeviceSession::SetDeformation(const IndexDeformation& deformation, MappingCache& mapping,
  const MappedVolume& volume, Resampling method, bool openSplits,
  const std::function<bool(double)>& progress)
{
  if (deformation.IsField())
  {
    this->SetField(deformation, volume.Outside);
  }
  else if (method == Resampling::MeshRasterization)
  {
    this->SetRestMesh(deformation, volume.Whole);
  }
  else
  {
    this->SetMesh(deformation, mapping, volume, openSplits, progress);
  }
  this->SentVectors = deformation.GetVectorsVersion();
  this->SentOutside = volume.Outside;
}

void DeviceSession::SetField(const IndexDeformation& deformation, const OutsideVoxels& outside)
{
  const Contents contents = deformation.IsInverseField() ? Contents::InverseField : Contents::Field;
  if (this->Sent == contents && this->SentVectors == deformation.GetVectorsVersion() &&
    this->SentOutside == outside)
  {
    return;
  }
  const std::shared_ptr<DeviceVectors>& vectors = deformation.GetDeviceVectors();
  this->Send(
    [&]
    {
      if (contents == Contents::InverseField)
      {
        this->Deformer.SetInverseField(deformation.GetField(outside));
      }
      else if (vectors && vectors->GetDevice() == this->Device)
      {
        this->Deformer.SetDisplacementField(deformation.GetFieldShape(outside), vectors);
      }
      else
      {
        const PointRanges changes = deformation.GetChanges(this->SentVectors);
        this->Deformer.SetDisplacementField(deformation.GetField(outside),
          this->Sent == Contents::Field && !vectors ? &changes : nullptr);
      }
    });
  this->Sent = contents;
}

void DeviceSession::SetNodes(const IndexDeformation& deformation, const PointRanges* changes)
{
  if (deformation.GetDeviceVectors())
  {
    this->Deformer.SetNodeDisplacements(
      deformation.GetDeviceVectors(), deformation.GetDeviceMatrix());
    return;
  }
  const float* displacements = deformation.GetNodeDisplacements();
  if (this->HasFadedMesh)
  {
    this->Faded.Move(displacements, deformation.GetMeshAtRest().Points.size(), changes);
    displacements = this->Faded.GetDisplacements().data();
  }
  this->Deformer.SetNodeDisplacements(displacements, changes, true);
}

void DeviceSession::SendMesh(const MeshAtRest& mesh, const StaticMapping& mapping)
{
  const std::vector<Tetrahedron>* tetrahedra = &mesh.Tetrahedra;
  std::size_t nodes = mesh.Points.size();
  this->HasFadedMesh = !mapping.Faded.IsEmpty();
  if (this->HasFadedMesh)
  {
    this->Faded.Set(mapping.Faded, *tetrahedra, nodes);
    tetrahedra = &this->Faded.GetTetrahedra();
    nodes = this->Faded.GetNumberOfNodes();
  }
  if (mapping.Links.empty())
  {
    this->Deformer.SetMesh(
      tetrahedra->data(), tetrahedra->size(), nodes, mapping.Runs, &mapping.Boundary);
  }
  else
  {
    this->Deformer.SetMesh(
      tetrahedra->data(), tetrahedra->size(), nodes, mapping.Links.data(), &mapping.Boundary);
  }
}

void DeviceSession::SendConnectivity(
  const IndexDeformation& deformation, const StaticMapping& mapping)
{
  const MeshAtRest mesh = deformation.GetMeshAtRest();
  const auto changes = deformation.GetConnectivityChanges(this->SentConnectivity);
  if (!this->HasFadedMesh)
  {
    this->Deformer.ChangeConnectivity(mesh.Tetrahedra.data(), mesh.Tetrahedra.size(),
      mesh.Points.size(), changes ? &*changes : nullptr);
    return;
  }
  const std::vector<TetrahedronChange> allChanges = this->Faded.Change(mapping.Faded, *changes);
  const std::vector<Tetrahedron>& all = this->Faded.GetTetrahedra();
  this->Deformer.ChangeConnectivity(
    all.data(), all.size(), this->Faded.GetNumberOfNodes(), &allChanges);
}

bool DeviceSession::CanFollow(const IndexDeformation& deformation) const
{
  const MeshAtRest mesh = deformation.GetMeshAtRest();
  return !this->HasFadedMesh ||
    (this->Faded.HasRoom(mesh.Points.size()) &&
      (this->SentConnectivity == mesh.ConnectivityVersion ||
        deformation.GetConnectivityChanges(this->SentConnectivity)));
}

void DeviceSession::SetMesh(const IndexDeformation& deformation, MappingCache& mapping,
  const MappedVolume& volume, bool openSplits, const std::function<bool(double)>& progress)
{
  const MeshAtRest mesh = deformation.GetMeshAtRest();
  const bool isCurrent = this->Sent == Contents::Mesh &&
    this->SentMapping == mapping.GetVersion() && mapping.IsCurrent(mesh, volume) &&
    this->CanFollow(deformation);
  const bool hasSplit = isCurrent && this->SentConnectivity != mesh.ConnectivityVersion;
  if (!isCurrent)
  {
    mapping.Update(mesh, volume, progress);
    this->Send([&] { this->SendMesh(mesh, mapping.GetMapping()); });
    this->SentMapping = mapping.GetVersion();
    this->CoincidentNodesAreSent = false;
  }
  else if (hasSplit)
  {
    this->Send([&] { this->SendConnectivity(deformation, mapping.GetMapping()); });
  }
  this->Sent = Contents::None; // until the nodes are sent
  this->SentConnectivity = mesh.ConnectivityVersion;
  if (!volume.Outside.AreExtrapolated())
  {
    // Only the bounds of an extrapolated deformation need the voxels of the mapping again.
    mapping.ReleaseVoxels();
  }
  if (openSplits != this->CoincidentNodesAreSent || (openSplits && hasSplit))
  {
    std::vector<std::int32_t> coincident;
    bool isSplit = false;
    if (openSplits)
    {
      coincident = FindCoincidentPoints(mesh.Points);
      for (std::size_t node = 0; node < coincident.size() && !isSplit; ++node)
      {
        isSplit = static_cast<std::size_t>(coincident[node]) != node;
      }
    }
    this->Send([&] { this->Deformer.SetCoincidentNodes(isSplit ? coincident.data() : nullptr); });
    this->CoincidentNodesAreSent = openSplits;
  }
  if (!isCurrent || this->SentVectors != deformation.GetVectorsVersion())
  {
    const PointRanges changes = deformation.GetChanges(this->SentVectors);
    this->Send([&] { this->SetNodes(deformation, isCurrent ? &changes : nullptr); });
  }
  this->Sent = Contents::Mesh;
}

void DeviceSession::SetRestMesh(const IndexDeformation& deformation, const ImageGeometry& volume)
{
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(double), "as the deformer reads it");
  const MeshAtRest mesh = deformation.GetMeshAtRest();
  CheckBoxes(mesh, volume);
  // The version of the connectivity changes with the shape, too.
  const bool meshIsSent =
    this->Sent == Contents::RestMesh && this->SentConnectivity == mesh.ConnectivityVersion;
  this->Send(
    [&]
    {
      if (!meshIsSent)
      {
        this->Deformer.SetRestMesh(mesh.Tetrahedra.data(), mesh.Tetrahedra.size(),
          mesh.Points.size(), &mesh.Points.front().x);
        this->HasFadedMesh = false;
        this->Faded = FadedMesh(); // frees its memory
      }
      if (!meshIsSent || this->SentVectors != deformation.GetVectorsVersion())
      {
        this->SetNodes(deformation, nullptr);
      }
    });
  this->SentConnectivity = mesh.ConnectivityVersion;
  this->Sent = Contents::RestMesh;
}

DeformReport DeviceSession::Deform(const DeformRequest& request)
{
  try
  {
    return this->Deformer.Deform(request);
  }
  catch (const Aborted&)
  {
    throw;
  }
  catch (...)
  {
    this->Known = false;
    throw;
  }
}

void DeviceSession::ReleaseMemory()
{
  this->Deformer.ReleaseMemory();
  this->Known = false;
}

void DeviceSession::ForgetValues()
{
  this->SentArrays.clear();
  this->SentMasks.clear();
}

void DeviceSession::Forget()
{
  this->SentGrid = VoxelGrid();
  this->SentWidth = 0;
  this->ForgetValues();
  this->Sent = Contents::None;
}

} // namespace deformvolume
