// SPDX-License-Identifier: BSD-3-Clause
#include "VertexStates.h"

#include "DeviceCut.h"
#include "HostMemory.h"
#include "KernelMaking.h"
#include "VertexCuboids.h"

#include <algorithm>
#include <cstdint>

namespace deformvolume
{

void VertexStates::Release(std::vector<VolumeChunk>& chunks)
{
  for (VolumeChunk& chunk : chunks)
  {
    chunk.State = cl::Buffer();
  }
  this->Finish();
  this->Known = false;
}

void VertexStates::Update(OpenCLContext& context, const cl::CommandQueue& queue,
  const KernelParameters& p, VolumeChunk& chunk, const Inputs& inputs)
{
  const std::uint64_t bytes = static_cast<std::uint64_t>(p.Size[0]) *
    static_cast<std::uint64_t>(p.Size[1]) * static_cast<std::uint64_t>(p.PlanesEnd - p.PlanesBegin);
  const bool all = !this->Known || GetMemory(chunk.State) != bytes;
  Reserve(context, chunk.State, bytes);
  const VertexCuboids cuboids(p);
  const std::vector<cl_uint> sources = all ? cuboids.GetAll() : cuboids.Find(this->Vertices, 0);
  // The state of a vertex depends on the cells around it and on their vertices. A cell has the
  // index of its first vertex.
  const std::vector<cl_uint> vertices =
    all ? sources : JoinLists(cuboids.Find(this->Vertices, 1), cuboids.Find(this->Cells, 1));
  if (vertices.empty())
  {
    return;
  }
  const std::size_t atOnce = std::min(VertexCuboids::AtOnce, vertices.size());
  const cl::Buffer list(context.GetContext(), CL_MEM_READ_ONLY, atOnce * sizeof(cl_uint));
  const cl::Buffer marked(
    context.GetContext(), CL_MEM_READ_WRITE, atOnce * VertexCuboids::NumberOfVertices);
  const QueueGuard guard(queue);
  cl::Kernel mark(inputs.Mapping, "MarkSources");
  SetArguments(mark, inputs.SetMapping(mark, chunk), chunk.Blanked,
    cl_int{ chunk.Blanked() != nullptr }, chunk.Distances, chunk.State, list, p);
  VertexCuboids::ForAll(context, queue, sources, list,
    [&](const VertexCuboids::Launch& launch, std::size_t, std::size_t) { launch(mark); });
  const cl::Kernel find = MakeKernel(inputs.Mapping, "MarkVertices", chunk.State, inputs.Active,
    inputs.Cut.GetRows(), inputs.Cut.GetVertices(), marked, list, p);
  const cl::Kernel store = MakeKernel(inputs.Mapping, "StoreStates", marked, chunk.State, list, p);
  VertexCuboids::ForAll(context, queue, vertices, list,
    [&](const VertexCuboids::Launch& launch, std::size_t, std::size_t)
    {
      launch(find);
      launch(store);
    });
}

} // namespace deformvolume
