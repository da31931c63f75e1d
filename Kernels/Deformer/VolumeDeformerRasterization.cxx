// SPDX-License-Identifier: BSD-3-Clause
// What VolumeDeformer does with a mesh that is rasterised itself.
#include "VolumeDeformer.h"

#include "VolumeDeformerInternals.h"

namespace deformvolume
{

MeshRasterizer::Setting VolumeDeformer::Internals::GetRasterizerSetting()
{
  OpenCLContext& context = this->GetContext(); // which makes the queues
  return { context, this->Queue, this->ReadQueue, this->GetAllocationLimit(), this->WorkGroupSize };
}

void VolumeDeformer::Internals::CheckRasterization(const DeformRequest& request) const
{
  if (request.Method != Resampling::MeshRasterization)
  {
    throw Error("Cubic interpolation is there only with the resampler MeshRasterization.");
  }
  if (!this->Rasterizer.IsReady())
  {
    throw Error("The resampler MeshRasterization needs a deformation mesh with its rest positions: "
                "call SetRestMesh and SetNodeDisplacements, or SetInverseField, first. For a "
                "forward displacement field use the resampler Exact.");
  }
}

DeformReport VolumeDeformer::Internals::Rasterize(const DeformRequest& request, std::uint64_t spare)
{
  this->Update.Forget();
  DeformReport report = this->Rasterizer.Deform(
    this->GetRasterizerSetting(), *this->Mesh, this->Arrays, request, spare);
  report.TransferTime += this->SendingTime;
  this->SendingTime = 0.0;
  return report;
}

void VolumeDeformer::SetRestMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
  std::size_t numberOfNodes, const double* restNodes)
{
  if (!numberOfTetrahedra || !numberOfNodes || !tetrahedra || !restNodes)
  {
    throw Error("The deformation mesh is empty.");
  }
  CheckIndices(tetrahedra, numberOfTetrahedra, numberOfNodes);
  this->Impl->Send(
    [&]
    {
      this->Impl->GetMesh().ForgetMesh();
      this->Impl->ForgetNodes();
      this->Impl->ForgetField();
      this->Impl->Update.ForgetMapping();
      this->Impl->NumberOfTetrahedra = numberOfTetrahedra;
      this->Impl->NumberOfNodes = numberOfNodes;
      this->Impl->Rasterizer.SetMesh(this->Impl->GetRasterizerSetting(), tetrahedra,
        numberOfTetrahedra, restNodes, numberOfNodes);
    });
}

void VolumeDeformer::SetInverseField(const DisplacementField& field)
{
  const std::size_t points = CountPoints(field);
  this->Impl->Send(
    [&]
    {
      Internals::CheckVectors(field.Vectors, points, "point", nullptr);
      this->Impl->GetMesh().ForgetMesh();
      this->Impl->ForgetNodes();
      this->Impl->FieldVectors = cl::Buffer();
      this->Impl->Update.ForgetMapping();
      this->Impl->NumberOfNodes = points;
      this->Impl->Rasterizer.SetField(this->Impl->GetRasterizerSetting(), field);
    });
}

VolumeDeformer::DeviceMemory VolumeDeformer::CheckRasterizationDeviceMemory(
  const VoxelGrid& voxelGrid, const std::vector<VolumeArray>& arrays, const Extent& outputExtent,
  std::uint64_t outputBytesPerVoxel, std::size_t numberOfNodes,
  std::size_t numberOfTetrahedra) const
{
  return this->Impl->Guard(
    [&]
    {
      OpenCLContext& context = this->Impl->GetContext();
      std::uint64_t sent = 0;
      for (const VolumeArray& array : arrays)
      {
        sent += IsUsedInPlace(context, array) ? 0 : GetTupleSize(array);
      }
      std::uint64_t outputVoxels = 0;
      if (GetNumberOfPoints(outputExtent) > 0)
      {
        outputVoxels = static_cast<std::uint64_t>(GetNumberOfPoints(
          OutputSlab::Split(outputExtent, arrays, voxelGrid, this->Impl->GetAllocationLimit())
            .front()));
      }
      // Arrays and both masks.
      const std::uint64_t needed =
        static_cast<std::uint64_t>(GetNumberOfPoints(voxelGrid.VertexExtent)) * (sent + 2) +
        MeshRasterizer::GetMemoryNeeded(
          outputVoxels, outputBytesPerVoxel, numberOfNodes, numberOfTetrahedra);
      const std::uint64_t available = this->Impl->GetUsableMemory();
      CheckBytes(needed, available, "on the device");
      return DeviceMemory{ needed, available };
    });
}

void VolumeDeformer::CheckRasterizationMemory(const VoxelGrid& voxelGrid,
  const std::vector<VolumeArray>& arrays, const Extent& outputExtent, std::size_t numberOfNodes,
  std::size_t numberOfTetrahedra, std::uint64_t heldBytes) const
{
  this->CheckMemories(arrays, outputExtent, 0, heldBytes,
    [&](std::uint64_t outputBytesPerVoxel)
    {
      return this->CheckRasterizationDeviceMemory(
        voxelGrid, arrays, outputExtent, outputBytesPerVoxel, numberOfNodes, numberOfTetrahedra);
    });
}

} // namespace deformvolume
