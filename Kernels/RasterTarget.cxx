// SPDX-License-Identifier: BSD-3-Clause
#include "RasterTarget.h"

#include "Background.h"

#include <cstring>

namespace deformvolume
{

RasterTarget::RasterTarget(OpenCLContext& context, const cl::CommandQueue& queue,
  const std::vector<VolumeArray>& arrays, const DeformRequest& request, const Extent& slab)
  : Queue(queue)
  , IsShared(context.GetDevice().IsProcessor)
{
  const std::uint64_t plane = static_cast<std::uint64_t>(GetSize(slab, 0) * GetSize(slab, 1));
  this->FirstVoxel =
    plane * static_cast<std::uint64_t>(std::int64_t{ slab[4] } - request.OutputExtent[4]);
  this->NumberOfVoxels = static_cast<std::uint64_t>(GetNumberOfPoints(slab));
  std::vector<cl_ulong> backgrounds(arrays.size());
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    this->AddPart(context, request.Outputs[i], GetTupleSize(arrays[i]));
    switch (arrays[i].Type)
    {
#define DEFORMVOLUME_CASE(name, ctype, cl)                                                         \
  case ElementType::name:                                                                          \
  {                                                                                                \
    const ctype background = ClampTo<ctype>(arrays[i].Background);                                 \
    std::memcpy(&backgrounds[i], &background, sizeof(ctype));                                      \
    break;                                                                                         \
  }
      DEFORMVOLUME_ELEMENT_TYPES(DEFORMVOLUME_CASE)
#undef DEFORMVOLUME_CASE
    }
  }
  this->AddPart(context, request.Coverage, 1);
  this->Backgrounds = cl::Buffer(context.GetContext(), CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
    backgrounds.size() * sizeof(cl_ulong), backgrounds.data());
}

void RasterTarget::AddPart(OpenCLContext& context, void* memory, std::uint64_t tuple)
{
  Part part;
  part.Memory = static_cast<char*>(memory) + this->FirstVoxel * tuple;
  part.Bytes = static_cast<std::size_t>(this->NumberOfVoxels * tuple);
  part.Buffer =
    cl::Buffer(context.GetContext(), CL_MEM_WRITE_ONLY | (this->IsShared ? CL_MEM_USE_HOST_PTR : 0),
      part.Bytes, this->IsShared ? part.Memory : nullptr);
  this->Parts.push_back(part);
}

void RasterTarget::Read()
{
  for (Part& part : this->Parts)
  {
    if (this->IsShared)
    {
      // Brings the memory up to date, where the device did not write to it directly.
      void* mapped = this->Queue.enqueueMapBuffer(part.Buffer, CL_TRUE, CL_MAP_READ, 0, part.Bytes);
      this->Queue.enqueueUnmapMemObject(part.Buffer, mapped);
    }
    else
    {
      this->Queue.enqueueReadBuffer(part.Buffer, CL_FALSE, 0, part.Bytes, part.Memory);
    }
  }
  this->Queue.finish();
}

} // namespace deformvolume
