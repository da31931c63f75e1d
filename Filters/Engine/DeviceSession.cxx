// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceSession.h"

#include "CoincidentPoints.h"
#include "Device.h"
#include "MemoryNeeds.h"

#include "vtkImageData.h"

#include <algorithm>
#include <optional>

namespace deformvolume
{

namespace
{

std::string Translate(const std::string& request)
{
  return request == BEST_DEVICE ? "" : request;
}

} // namespace

void DeviceSession::CheckDevice(const std::string& request)
{
  ResolveDevice(Translate(request));
}

std::string DeviceSession::FindOwnMemory(const std::string& request)
{
  const std::string wanted = Translate(request);
  return GetDeviceAbilities(wanted).OwnMemory ? ResolveDevice(wanted) : "";
}

std::string DeviceSession::SetDevice(const std::string& request, std::uint64_t memoryLimit)
{
  this->Deformer.SetMemoryLimit(memoryLimit);
  const std::string device = this->Deformer.SetDevice(Translate(request));
  if (device != this->Device)
  {
    this->Known = false;
    this->Device = device;
  }
  return device;
}

void DeviceSession::CheckMemory(const VoxelGrid& voxelGrid, const std::vector<VolumeArray>& arrays,
  const Extent& outputExtent, std::uint64_t heldBytes, const Deformation& deformation,
  std::uint64_t runBytes, Resampling method) const
{
  const bool field = deformation.IsField();
  std::size_t numberOfNodes = deformation.GetRestPoints().size();
  if (field)
  {
    numberOfNodes = 1;
    for (int size : deformation.GetField(false).Dimensions)
    {
      numberOfNodes *= static_cast<std::size_t>(size);
    }
  }
  const bool isRasterized = method == Resampling::MeshRasterization;
  this->Deformer.CheckMemory(
    { voxelGrid, arrays, outputExtent, numberOfNodes,
      field ? 0 : deformation.GetTetrahedra().size(),
      isRasterized ? 0 : GetMappingBytes(voxelGrid, field, runBytes), isRasterized },
    heldBytes);
}

void DeviceSession::SetVolume(const VoxelGrid& voxelGrid, vtkImageData* volume,
  const std::vector<SourceArray>& arrays, double background, const Deformation& deformation,
  const OutsideVoxels& outside, Resampling method)
{
  if (!this->Known)
  {
    this->Forget();
  }
  this->Known = false;
  const bool links = method != Resampling::MeshRasterization;
  std::size_t widest = 0;
  const std::vector<VolumeArray> described = MakeVolumeArrays(arrays, background);
  for (const VolumeArray& array : described)
  {
    widest = std::max(widest, GetTupleSize(array));
  }
  if (this->SentGrid.VertexExtent != voxelGrid.VertexExtent ||
    this->SentGrid.WholeExtent != voxelGrid.WholeExtent ||
    this->SentGrid.ToOutput != voxelGrid.ToOutput || this->SentWidth < widest ||
    this->SentForLinks != links)
  {
    this->Forget();
    this->Deformer.SetVoxelGrid(voxelGrid, widest, links);
    this->SentGrid = voxelGrid;
    this->SentWidth = widest;
    this->SentForLinks = links;
  }

  const Stamp stamp = GetStamp(arrays);
  if (this->SentArrays != stamp)
  {
    std::vector<VolumeArray> sent = described;
    for (std::size_t i = 0; i < arrays.size(); ++i)
    {
      if (!sent[i].Data)
      {
        CopyToAOS(arrays[i].Array, sent[i]);
      }
    }
    this->Deformer.SetArrays(sent);
    this->SentArrays = stamp;
    ++this->NumberOfVolumeUploads;
  }
  this->Deformer.SetArrayOptions(described);

  const Stamp masksStamp = GetMasksStamp(volume);
  const std::pair<std::uint64_t, OutsideVoxels> undefined(
    deformation.GetUndefinedVersion(), outside);
  const bool isDefined = undefined.first == 0 && this->SentUndefined.first == 0;
  if (!this->MasksAreSet || this->SentMasks != masksStamp ||
    (!isDefined && !(this->SentUndefined == undefined)))
  {
    VolumeMasks masks = ReadMasks(volume, this->MasksAreSet ? this->SentMasks : Stamp());
    const auto written = [](const std::optional<PointRanges>& ranges)
    { return ranges ? &*ranges : nullptr; };
    std::vector<unsigned char> blanked;
    if (undefined.first != 0)
    {
      blanked = deformation.FindUndefinedVoxels(voxelGrid.VertexExtent, outside);
      for (std::size_t i = 0; i < blanked.size() && masks.Blanked; ++i)
      {
        blanked[i] |= (masks.Blanked[i] & masks.BlankedBits) != 0 ? 1 : 0;
      }
      masks.Blanked = blanked.data();
      masks.BlankedBits = 1;
    }
    this->Deformer.SetBlanked(
      masks.Blanked, masks.BlankedBits, isDefined ? written(masks.WrittenBlanked) : nullptr);
    this->SentUndefined = undefined;
    this->Deformer.SetActiveTetrahedra(masks.Active, written(masks.WrittenActive));
    this->Deformer.SetBoundaryDistances(masks.Distances.Values, written(masks.WrittenDistances));
    this->Deformer.SetCut(masks.Cut.Crossed, masks.Cut.Distances.Values);
    this->SentMasks = masksStamp;
    this->MasksAreSet = true;
  }
  this->Known = true;
}

void DeviceSession::SetDeformation(const Deformation& deformation, MappingCache& mapping,
  const MappedVolume& volume, bool openSplits, const std::function<bool(double)>& progress)
{
  const std::uint64_t vectors = deformation.GetVectorsVersion();
  if (deformation.IsField())
  {
    if (this->Sent != Contents::Field || this->SentVectors != vectors ||
      !(this->SentOutside == volume.Outside))
    {
      const PointRanges changes = deformation.GetChanges(this->SentVectors);
      this->Known = false;
      DisplacementField field = deformation.GetField(volume.Outside);
      if (deformation.GetDeviceVectors())
      {
        field.ToDisplacement = deformation.GetDeviceMatrix();
        this->Deformer.SetDisplacementField(field, deformation.GetDeviceVectors());
      }
      else
      {
        this->Deformer.SetDisplacementField(
          field, this->Sent == Contents::Field ? &changes : nullptr);
      }
      this->Known = true;
    }
    this->Sent = Contents::Field;
  }
  else
  {
    this->SetMesh(deformation, mapping, volume, openSplits, progress);
    this->Sent = Contents::Mesh;
  }
  this->SentVectors = vectors;
  this->SentOutside = volume.Outside;
}

void DeviceSession::SetNodes(const Deformation& deformation, const PointRanges* changes)
{
  if (deformation.GetDeviceVectors())
  {
    this->Deformer.SetNodeDisplacements(
      deformation.GetDeviceVectors(), deformation.GetDeviceMatrix());
  }
  else if (this->HasFadedMesh)
  {
    this->Faded.Move(
      deformation.GetNodeDisplacements(), deformation.GetRestPoints().size(), changes);
    this->Deformer.SetNodeDisplacements(this->Faded.GetDisplacements().data(), changes, true);
  }
  else
  {
    this->Deformer.SetNodeDisplacements(deformation.GetNodeDisplacements(), changes, true);
  }
}

void DeviceSession::SendMesh(const RestMesh& mesh, const StaticMapping& mapping, bool byRuns)
{
  const std::vector<Tetrahedron>* tetrahedra = &mesh.GetTetrahedra();
  std::size_t nodes = mesh.GetPoints().size();
  this->HasFadedMesh = !mapping.Faded.IsEmpty();
  if (this->HasFadedMesh)
  {
    this->Faded.Set(mapping.Faded, *tetrahedra, nodes);
    tetrahedra = &this->Faded.GetTetrahedra();
    nodes = this->Faded.GetNumberOfNodes();
  }
  if (byRuns)
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

void DeviceSession::SendConnectivity(const RestMesh& mesh, const StaticMapping& mapping)
{
  const std::vector<Tetrahedron>& tetrahedra = mesh.GetTetrahedra();
  const std::size_t nodes = mesh.GetPoints().size();
  const auto changes = mesh.GetChanges(this->SentConnectivity);
  if (!this->HasFadedMesh)
  {
    this->Deformer.ChangeConnectivity(
      tetrahedra.data(), tetrahedra.size(), nodes, changes ? &*changes : nullptr);
    return;
  }
  const std::vector<TetrahedronChange> allChanges = this->Faded.Change(mapping.Faded, *changes);
  const std::vector<Tetrahedron>& all = this->Faded.GetTetrahedra();
  this->Deformer.ChangeConnectivity(
    all.data(), all.size(), this->Faded.GetNumberOfNodes(), &allChanges);
}

bool DeviceSession::CanFollow(const RestMesh& mesh) const
{
  return !this->HasFadedMesh ||
    (this->Faded.HasRoom(mesh.GetPoints().size()) &&
      (this->SentConnectivity == mesh.GetConnectivityVersion() ||
        mesh.GetChanges(this->SentConnectivity)));
}

void DeviceSession::SetMesh(const Deformation& deformation, MappingCache& mapping,
  const MappedVolume& volume, bool openSplits, const std::function<bool(double)>& progress)
{
  const RestMesh& mesh = deformation.GetRestMesh();
  const std::uint64_t connectivity = mesh.GetConnectivityVersion();
  const bool isCurrent = this->Sent == Contents::Mesh &&
    this->SentMapping == mapping.GetVersion() &&
    mapping.IsCurrent(deformation.GetMeshAtRest(), volume) && this->CanFollow(mesh);
  const bool hasSplit = isCurrent && this->SentConnectivity != connectivity;
  if (!isCurrent)
  {
    mapping.Update(deformation.GetMeshAtRest(), volume, progress);
    this->Known = false;
    this->SendMesh(mesh, mapping.GetMapping(), mapping.IsByRuns());
    this->Known = true;
    this->SentMapping = mapping.GetVersion();
    this->CoincidentNodesAreSent = false;
  }
  else if (hasSplit)
  {
    this->Known = false;
    this->SendConnectivity(mesh, mapping.GetMapping());
    this->Known = true;
  }
  this->SentConnectivity = connectivity;
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
      coincident = FindCoincidentPoints(mesh.GetPoints());
      for (std::size_t node = 0; node < coincident.size() && !isSplit; ++node)
      {
        isSplit = static_cast<std::size_t>(coincident[node]) != node;
      }
    }
    this->Known = false;
    this->Deformer.SetCoincidentNodes(isSplit ? coincident.data() : nullptr);
    this->Known = true;
    this->CoincidentNodesAreSent = openSplits;
  }
  if (!isCurrent || this->SentVectors != deformation.GetVectorsVersion())
  {
    const PointRanges changes = deformation.GetChanges(this->SentVectors);
    this->Known = false;
    this->SetNodes(deformation, isCurrent ? &changes : nullptr);
    this->Known = true;
  }
}

void DeviceSession::SetRestMesh(const Deformation& deformation, const OutsideVoxels& outside)
{
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(double), "as the deformer reads it");
  if (deformation.IsInverseField())
  {
    const std::uint64_t version = deformation.GetVectorsVersion();
    if (this->Sent != Contents::InverseField || this->SentVectors != version ||
      !(this->SentOutside == outside))
    {
      this->Known = false;
      this->Deformer.SetInverseField(deformation.GetField(outside));
      this->Known = true;
    }
    this->Sent = Contents::InverseField;
    this->SentVectors = version;
    this->SentOutside = outside;
    return;
  }
  // The version of the connectivity changes with the shape, too.
  const std::uint64_t connectivity = deformation.GetRestMesh().GetConnectivityVersion();
  const bool meshIsSent =
    this->Sent == Contents::RestMesh && this->SentConnectivity == connectivity;
  const std::uint64_t vectors = deformation.GetVectorsVersion();
  this->Known = false;
  if (!meshIsSent)
  {
    const std::vector<Tetrahedron>& tetrahedra = deformation.GetTetrahedra();
    this->Deformer.SetRestMesh(tetrahedra.data(), tetrahedra.size(),
      deformation.GetRestPoints().size(), &deformation.GetRestPoints().front().x);
  }
  if (!meshIsSent || this->SentVectors != vectors)
  {
    this->SetNodes(deformation, nullptr);
  }
  this->Known = true;
  this->Sent = Contents::RestMesh;
  this->SentConnectivity = connectivity;
  this->SentVectors = vectors;
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
  this->MasksAreSet = false;
}

void DeviceSession::Forget()
{
  this->SentGrid = VoxelGrid();
  this->SentWidth = 0;
  this->ForgetValues();
  this->Sent = Contents::None;
}

} // namespace deformvolume
