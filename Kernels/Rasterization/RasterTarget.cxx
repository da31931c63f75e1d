// SPDX-License-Identifier: BSD-3-Clause
#include "RasterTarget.h"

#include "DeviceOutputInternals.h"

#include <cstring>

namespace deformvolume
{

RasterTarget::RasterTarget(OpenCLContext& context, const std::vector<VolumeArray>& arrays,
  const DeformRequest& request, const Extent& slab)
  : SlabExtent(slab)
{
  const std::uint64_t plane = static_cast<std::uint64_t>(GetSize(slab, 0) * GetSize(slab, 1));
  this->FirstVoxel =
    plane * static_cast<std::uint64_t>(std::int64_t{ slab[4] } - request.OutputExtent[4]);
  this->NumberOfVoxels = static_cast<std::uint64_t>(GetNumberOfPoints(slab));
  std::vector<cl_ulong> backgrounds(arrays.size());
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    const ElementBytes background = GetBackground(arrays[i]);
    std::memcpy(&backgrounds[i], background.Bytes.data(), background.Size);
    this->AddMemory(context, request.Outputs[i], GetTupleSize(arrays[i]), background);
  }
  this->AddMemory(context, request.Coverage, 1, ElementBytes::Of(cl_uchar{ 0 }));
  this->Backgrounds = cl::Buffer(context.GetContext(), CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
    backgrounds.size() * sizeof(cl_ulong), backgrounds.data());
}

void RasterTarget::AddMemory(
  OpenCLContext& context, void* output, std::uint64_t tuple, const ElementBytes& background)
{
  Memory memory;
  memory.Background = background;
  memory.Host = static_cast<char*>(output) + this->FirstVoxel * tuple;
  memory.Tuple = tuple;
  Bind(context, memory.Buffer, memory.Host, background.Size, this->NumberOfVoxels * tuple);
  this->Memories.push_back(memory);
}

void RasterTarget::Read(const cl::CommandQueue& queue)
{
  for (const Memory& memory : this->Memories)
  {
    this->Reads.Add(
      BeginToRead(queue, memory.Buffer, this->NumberOfVoxels * memory.Tuple, memory.Host));
  }
  queue.flush();
}

std::vector<std::shared_ptr<DeviceOutput>> RasterTarget::KeepOnDevice(
  const cl::CommandQueue& queue) const
{
  std::vector<std::shared_ptr<DeviceOutput>> outputs;
  for (const Memory& memory : this->Memories)
  {
    const DeviceOutput::Internals::Voxels voxels{ this->SlabExtent, this->SlabExtent,
      memory.Tuple };
    outputs.push_back(std::make_shared<DeviceOutput>(std::make_shared<DeviceOutput::Internals>(
      queue, memory.Buffer, voxels, memory.Host, memory.Background)));
  }
  return outputs;
}

} // namespace deformvolume
