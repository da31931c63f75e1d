// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeDeformer.h"

#include "CompilationWatch.h"
#include "VertexRuns.h"
#include "VolumeDeformerInternals.h"

#include <algorithm>
#include <cmath>

namespace deformvolume
{
namespace
{

void CheckLinks(const VertexLink* links, std::int64_t count, std::size_t numberOfTetrahedra)
{
  for (std::int64_t i = 0; i < count; ++i)
  {
    if (links[i].Tetrahedron >= 0 &&
      static_cast<std::size_t>(links[i].Tetrahedron) >= numberOfTetrahedra)
    {
      throw Error("Voxel " + std::to_string(i) + " is linked to the tetrahedron " +
        std::to_string(links[i].Tetrahedron) + ", but there are " +
        std::to_string(numberOfTetrahedra) + ".");
    }
  }
}

/// Bytes of the static mapping; see CheckMemory.
std::uint64_t GetMappingBytes(const VoxelGrid& voxelGrid, bool field, std::uint64_t runBytes)
{
  return field ? 0
    : runBytes
    ? runBytes
    : static_cast<std::uint64_t>(GetNumberOfPoints(voxelGrid.VertexExtent)) * sizeof(VertexLink);
}

} // namespace

void CheckIndices(const Tetrahedron* tetrahedra, std::size_t count, std::size_t numberOfNodes)
{
  for (std::size_t t = 0; t < count; ++t)
  {
    for (const std::int32_t node : tetrahedra[t])
    {
      if (node < 0 || static_cast<std::size_t>(node) >= numberOfNodes)
      {
        throw Error("Tetrahedron " + std::to_string(t) + " of the deformation mesh has the node " +
          std::to_string(node) + ", but there are " + std::to_string(numberOfNodes) + ".");
      }
    }
  }
}

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
      this->Impl->ForgetSystemMemory();
      this->Impl->SelectDevice(request);
      return this->Impl->Context->GetDevice().Name;
    });
}

void VolumeDeformer::SetMemoryLimit(std::uint64_t bytes)
{
  this->Impl->MemoryLimit = bytes;
}

void VolumeDeformer::SetAllocationLimit(std::uint64_t bytes)
{
  this->Impl->AllocationLimit = bytes;
}

void VolumeDeformer::SetWorkGroupSize(std::size_t size)
{
  this->Impl->WorkGroupSize = size;
}

VolumeDeformer::DeviceMemory VolumeDeformer::CheckDeviceMemory(const VoxelGrid& voxelGrid,
  const std::vector<VolumeArray>& arrays, const Extent& outputExtent,
  std::uint64_t outputBytesPerVoxel, std::size_t numberOfNodes, std::size_t numberOfTetrahedra,
  std::uint64_t mappingBytes) const
{
  this->Impl->Guard([&] { this->Impl->GetContext(); });
  const OpenCLContext& context = *this->Impl->Context;
  std::uint64_t tuple = 0;
  for (const VolumeArray& array : arrays)
  {
    tuple += IsUsedInPlace(context, array) ? 0 : GetTupleSize(array);
  }
  const auto voxels = static_cast<std::uint64_t>(GetNumberOfPoints(voxelGrid.VertexExtent));
  // The output is worked on in slabs, one after the other in the same buffers.
  const std::uint64_t outputVoxels = this->Impl->Guard(
    [&]() -> std::uint64_t
    {
      if (GetNumberOfPoints(outputExtent) == 0)
      {
        return 0;
      }
      const std::vector<Extent> slabs =
        OutputSlab::Split(outputExtent, arrays, voxelGrid, this->Impl->GetAllocationLimit());
      return static_cast<std::uint64_t>(GetNumberOfPoints(slabs.front()));
    });
  // Arrays, state, active tetrahedra and blanking; links or runs of a mesh; arrays and
  // coverage of the output; the deformation itself. Winners of the output are counted when a
  // deformation turns out to fold the volume (CheckWinners).
  const std::uint64_t needed = voxels * (tuple + 3) + mappingBytes +
    outputVoxels * outputBytesPerVoxel + (numberOfNodes + numberOfTetrahedra) * 16;
  const std::uint64_t available = this->Impl->GetUsableMemory();
  CheckBytes(needed, available, "on the device");
  return { needed, available };
}

void VolumeDeformer::CheckMemory(const VoxelGrid& voxelGrid, const std::vector<VolumeArray>& arrays,
  const Extent& outputExtent, std::size_t numberOfNodes, std::size_t numberOfTetrahedra, bool field,
  std::uint64_t runBytes, std::uint64_t heldBytes) const
{
  const std::uint64_t mappingBytes = GetMappingBytes(voxelGrid, field, runBytes);
  this->CheckMemories(arrays, outputExtent, mappingBytes, heldBytes,
    [&](std::uint64_t outputBytesPerVoxel)
    {
      return this->CheckDeviceMemory(voxelGrid, arrays, outputExtent, outputBytesPerVoxel,
        numberOfNodes, numberOfTetrahedra, mappingBytes);
    });
}

void VolumeDeformer::CheckMemories(const std::vector<VolumeArray>& arrays,
  const Extent& outputExtent, std::uint64_t mappingBytes, std::uint64_t heldBytes,
  const std::function<DeviceMemory(std::uint64_t)>& checkDevice) const
{
  const bool shared =
    this->Impl->Guard([&] { return this->Impl->GetContext().GetDevice().IsProcessor; });
  std::uint64_t tuple = 0;
  for (const VolumeArray& array : arrays)
  {
    tuple += GetTupleSize(array);
  }
  // A processor works in the memory of the output.
  const std::uint64_t needed = checkDevice(shared ? 0 : tuple + 1).Needed;
  // What the caller holds, in the memory of the system, which a processor shares with its device.
  const std::uint64_t system = this->Impl->Guard([&] { return this->Impl->GetSystemMemory(); });
  if (system > 0)
  {
    const std::uint64_t host =
      mappingBytes + static_cast<std::uint64_t>(GetNumberOfPoints(outputExtent)) * (tuple + 1);
    CheckBytes(host + (shared ? needed : 0), system + heldBytes, "in the system");
  }
}

void VolumeDeformer::SetVoxelGrid(
  const VoxelGrid& voxelGrid, std::size_t bytesPerVoxel, bool withLinks)
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
  this->Impl->Guard(
    [&]
    {
      OpenCLContext& context = this->Impl->GetContext();
      this->Impl->Forget();
      this->Impl->Mesh = std::make_unique<DeviceVolume>(context, this->Impl->Queue, voxelGrid,
        bytesPerVoxel, this->Impl->GetAllocationLimit(), withLinks);
    });
}

void VolumeDeformer::SetArrays(const std::vector<VolumeArray>& arrays)
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
  this->Impl->Send(
    [&]
    {
      this->Impl->Update.Forget();
      DeviceVolume& mesh = this->Impl->GetMesh();
      this->Impl->Arrays.clear(); // there are none if this fails
      mesh.SetArrays(arrays, this->Impl->GetFieldInPlace());
      this->Impl->Arrays = arrays;
      for (std::size_t i = 0; i < arrays.size(); ++i)
      {
        if (!mesh.IsInPlace(i))
        {
          this->Impl->Arrays[i].Owner.reset(); // the data were copied
        }
      }
    });
}

void VolumeDeformer::SetArrayOptions(const std::vector<VolumeArray>& arrays)
{
  std::vector<VolumeArray>& set = this->Impl->Arrays;
  const bool alike = std::equal(arrays.begin(), arrays.end(), set.begin(), set.end(),
    [](const VolumeArray& a, const VolumeArray& b)
    { return a.Type == b.Type && a.Components == b.Components; });
  if (!alike)
  {
    throw Error("The options are those of other arrays than are set: call SetArrays first.");
  }
  for (std::size_t i = 0; i < set.size(); ++i)
  {
    // Not-a-number never counts as the same.
    if (set[i].Categorical != arrays[i].Categorical || !(set[i].Background == arrays[i].Background))
    {
      this->Impl->Update.Forget();
    }
    set[i].Categorical = arrays[i].Categorical;
    set[i].Background = arrays[i].Background;
  }
}

void VolumeDeformer::SetBlanked(const unsigned char* blanked)
{
  this->Impl->Send(
    [&]
    {
      this->Impl->TellMask(blanked, false);
      this->Impl->GetMesh().SetBlanked(blanked);
    });
}

void VolumeDeformer::SetActiveTetrahedra(const unsigned char* active)
{
  this->Impl->Send(
    [&]
    {
      this->Impl->TellMask(active, true);
      this->Impl->GetMesh().SetActive(active);
    });
}

void VolumeDeformer::SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  std::size_t numberOfNodes, const VertexLink* links)
{
  static_assert(sizeof(Tetrahedron) == 16 && sizeof(VertexLink) == 16, "as the kernels read them");
  if (!numberOfTetrahedra || !numberOfNodes || !tetrahedra || !links)
  {
    throw Error("The deformation mesh is empty.");
  }
  CheckIndices(tetrahedra, numberOfTetrahedra, numberOfNodes);
  this->Impl->Send(
    [&]
    {
      CheckLinks(links, GetNumberOfPoints(this->Impl->GetMesh().GetVoxelGrid().VertexExtent),
        numberOfTetrahedra);
      DeviceVolume& mesh = this->Impl->GetMesh();
      MeshOrder order =
        FindOrder(mesh.GetBricks(), links, tetrahedra, numberOfTetrahedra, numberOfNodes);
      mesh.SetLinks(links, order);
      this->Impl->SendTetrahedra(tetrahedra, numberOfTetrahedra, numberOfNodes, std::move(order));
    });
}

void VolumeDeformer::SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  std::size_t numberOfNodes, const VertexRuns& runs)
{
  if (!numberOfTetrahedra || !numberOfNodes || !tetrahedra)
  {
    throw Error("The deformation mesh is empty.");
  }
  CheckIndices(tetrahedra, numberOfTetrahedra, numberOfNodes);
  this->Impl->Send(
    [&]
    {
      CheckRuns(runs, this->Impl->GetMesh().GetVoxelGrid(), numberOfTetrahedra);
      MeshOrder order = FindOrder(runs, tetrahedra, numberOfTetrahedra, numberOfNodes);
      this->Impl->GetMesh().SetRuns(runs, order);
      this->Impl->SendTetrahedra(tetrahedra, numberOfTetrahedra, numberOfNodes, std::move(order));
    });
}

void VolumeDeformer::SetNodeDisplacements(const float* displacements, const PointRanges* changes)
{
  this->Impl->Send(
    [&]
    {
      if (!this->Impl->GetMesh().HasMesh() && !this->Impl->Rasterizer.HasMesh())
      {
        throw Error("No deformation mesh is set: call SetMesh first.");
      }
      const bool rasterized = this->Impl->Rasterizer.HasMesh();
      const PointRanges* news =
        this->Impl->NodesSet && this->Impl->LastVectorsSent && !rasterized ? changes : nullptr;
      this->Impl->LastVectorsSent = false;
      Internals::CheckVectors(displacements, this->Impl->NumberOfNodes, "node", news);
      if (rasterized)
      {
        this->Impl->Rasterizer.SetDisplacements(this->Impl->GetRasterizerSetting(), displacements,
          this->Impl->GetMesh().GetVoxelGrid().Scale);
        return;
      }
      this->Impl->SendVectors(
        displacements, this->Impl->NumberOfNodes, this->Impl->NodeNumbers, this->Impl->Nodes, news);
      this->Impl->NodesSet = true;
      this->Impl->LastVectorsSent = true;
      this->Impl->GetMesh().ForgetRecords();
    });
}

DeformReport VolumeDeformer::Deform(const DeformRequest& request)
{
  this->Impl->CheckRequest(request);
  const Internals::SystemMemoryGuard guard(*this->Impl);
  const CompilationWatch compilation(request.Compiling);
  DeformReport report = this->Execute(request);
  report.CompilationTime = compilation.GetSeconds();
  return report;
}

DeformReport VolumeDeformer::Execute(const DeformRequest& request)
{
  const DeviceVolume& mesh = this->Impl->GetMesh();
  this->Impl->Guard(
    [&]
    {
      mesh.ReadArraysAgain();
      TellOfWrites(*this->Impl->Context, this->Impl->Queue, this->Impl->GetFieldInPlace());
    });
  if (request.Method == Resampling::MeshRasterization)
  {
    const DeviceMemory memory = this->CheckRasterizationDeviceMemory(mesh.GetVoxelGrid(),
      this->Impl->Arrays, request.OutputExtent,
      OutputSlab::GetBytesPerVoxel(*this->Impl->Context, this->Impl->Arrays, request),
      this->Impl->NumberOfNodes, this->Impl->NumberOfTetrahedra);
    return this->Impl->Guard(
      [&] { return this->Impl->Rasterize(request, memory.Available - memory.Needed); });
  }
  const DeviceMemory memory =
    this->CheckDeviceMemory(mesh.GetVoxelGrid(), this->Impl->Arrays, request.OutputExtent,
      OutputSlab::GetBytesPerVoxel(*this->Impl->Context, this->Impl->Arrays, request),
      this->Impl->NumberOfNodes, this->Impl->NumberOfTetrahedra,
      GetMappingBytes(mesh.GetVoxelGrid(), !mesh.HasMesh(), mesh.GetRunBytes()));
  return this->Impl->Guard(
    [&] { return this->Impl->Deform(request, memory.Available - memory.Needed); });
}

std::uint64_t VolumeDeformer::GetDeviceMemory() const
{
  return this->Impl->GetHeldMemory();
}

void VolumeDeformer::ReleaseMemory()
{
  this->Impl->ForgetSystemMemory();
  this->Impl->Forget();
}

} // namespace deformvolume
