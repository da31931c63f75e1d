// SPDX-License-Identifier: BSD-3-Clause
#include "PublishedPass.h"

#include "DeviceVolume.h"
#include "DisplacementSource.h"
#include "HostMemory.h"
#include "Launches.h"
#include "OutputSlab.h"
#include "ResamplingProgram.h"
#include "WorkDevice.h"

namespace deformvolume
{

PublishedPass::PublishedPass(
  WorkDevice& device, DeviceVolume& volume, const DisplacementSource& source, Launches& launches)
  : Device(device)
  , Volume(volume)
  , Source(source)
  , Launched(launches)
{
}

void PublishedPass::Map(const VolumeChunk& chunk, const KernelParameters& p)
{
  OpenCLContext& context = this->Device.GetContext();
  const std::uint64_t bytes = static_cast<std::uint64_t>(p.Size[0]) * p.Size[1] * 3 *
    sizeof(cl_int) * static_cast<std::uint64_t>(p.PlanesEnd - p.PlanesBegin);
  if (deformvolume::GetMemory(this->Positions) < bytes)
  {
    this->Positions = cl::Buffer(context.GetContext(), CL_MEM_READ_WRITE, bytes);
  }
  cl::Kernel kernel(GetMappingProgram(context, this->Source.GetMappingForm()), "MapPositions");
  cl_uint i = this->Source.SetMappingArguments(kernel, chunk);
  kernel.setArg(i++, this->Volume.GetState(chunk));
  kernel.setArg(i++, this->Positions);
  kernel.setArg(i++, p);
  this->Launched.GetMappingEvents().push_back(context.Launch(this->Device.GetQueue(), kernel,
    this->Volume.GetVertexRange(p.PlanesEnd - p.PlanesBegin), this->Volume.GetVertexGroup()));
}

void PublishedPass::Run(const DeformRequest& request, const OutputSlab& output)
{
  cl::Kernel kernel(GetPublishedProgram(this->Device.GetContext(), this->Volume.GetVolumeArrays()),
    "ResamplePublished");
  const std::size_t group = this->Device.GetGroupSize(kernel);
  for (const VolumeChunk& chunk : this->Volume.GetChunks())
  {
    KernelParameters p = this->Volume.GetParameters(chunk);
    p.PlanesBegin = p.LayersBegin;
    p.PlanesEnd = p.LayersEnd + 1;
    p.SlabFirst = p.PlanesBegin;
    output.SetParameters(p);
    this->Map(chunk, p);
    cl_uint i = 0;
    kernel.setArg(i++, this->Positions);
    kernel.setArg(i++, this->Volume.GetActive(chunk));
    kernel.setArg(i++, output.GetCoverage());
    kernel.setArg(i++, p);
    const std::vector<cl::Buffer>& arrays = this->Volume.GetArrays(chunk);
    for (std::size_t a = 0; a < arrays.size(); ++a)
    {
      kernel.setArg(i++, arrays[a]);
      kernel.setArg(i++, output.GetArray(a));
    }
    const std::size_t cells = static_cast<std::size_t>(p.Size[0] - 1);
    this->Launched.Run(request, kernel,
      cl::NDRange((cells + group - 1) / group * group, static_cast<std::size_t>(p.Size[1] - 1),
        static_cast<std::size_t>(p.LayersEnd - p.LayersBegin)),
      cl::NDRange(group, 1, 1));
  }
}

std::uint64_t PublishedPass::GetMemory() const
{
  return deformvolume::GetMemory(this->Positions);
}

} // namespace deformvolume
