// SPDX-License-Identifier: BSD-3-Clause
#include "ResampledMask.h"

#include "DeviceCut.h"
#include "FiveTetrahedra.h"
#include "HostMemory.h"
#include "KernelMaking.h"
#include "VertexCuboids.h"

#include <algorithm>

namespace deformvolume
{

void ResampledMask::SetCoincidentNodes(
  OpenCLContext& context, const cl::CommandQueue& queue, const std::vector<std::int32_t>& numbers)
{
  const bool had = this->HasCoincidentNodes();
  if (numbers.empty())
  {
    this->CoincidentNodes = cl::Buffer();
    if (had)
    {
      this->Invalidate();
    }
    return;
  }
  const std::size_t bytes = numbers.size() * sizeof(std::int32_t);
  if (GetMemory(this->CoincidentNodes) < bytes)
  {
    // Reserve room, since more nodes may follow soon.
    this->CoincidentNodes = cl::Buffer(context.GetContext(), CL_MEM_READ_ONLY, bytes + bytes / 8);
  }
  queue.enqueueWriteBuffer(this->CoincidentNodes, CL_TRUE, 0, bytes, numbers.data());
  if (!had)
  {
    this->Invalidate();
  }
}

void ResampledMask::SetBoundary(bool has)
{
  this->WithBoundary = has;
  this->Invalidate();
}

void ResampledMask::Update(OpenCLContext& context, const cl::CommandQueue& queue,
  const KernelParameters& p, VolumeChunk& chunk, const Inputs& inputs, std::vector<Extent>& changes)
{
  const std::uint64_t bytes = static_cast<std::uint64_t>(p.Size[0] - 1) *
    static_cast<std::uint64_t>(p.Size[1] - 1) *
    static_cast<std::uint64_t>(p.PlanesEnd - p.PlanesBegin - 1);
  const bool all = !this->Known || GetMemory(chunk.ResampledTetrahedra) != bytes;
  const VertexCuboids chunkCuboids(p);
  // The cells around a vertex begin at the vertex and one voxel before it.
  const std::vector<cl_uint> cuboids = all
    ? chunkCuboids.GetAll()
    : JoinLists(chunkCuboids.Find(this->Vertices, 1), chunkCuboids.Find(this->Cells, 0));
  if (all)
  {
    Reserve(context, chunk.ResampledTetrahedra, bytes);
    queue.enqueueFillBuffer(
      chunk.ResampledTetrahedra, cl_uchar{ DEFORMVOLUME_ALL_TETRAHEDRA }, 0, bytes);
  }
  if (cuboids.empty())
  {
    return;
  }
  const std::size_t atOnce = std::min(VertexCuboids::AtOnce, cuboids.size());
  const cl::Buffer list(context.GetContext(), CL_MEM_READ_ONLY, atOnce * sizeof(cl_uint));
  const cl::Buffer changed(context.GetContext(), CL_MEM_READ_WRITE, atOnce * sizeof(cl_uint));
  const QueueGuard guard(queue);
  cl::Kernel kernel(inputs.Program, "UpdateResampledMask");
  SetArguments(kernel, inputs.SetMapping(kernel, chunk), inputs.Owners, inputs.Tetrahedra,
    this->CoincidentNodes, cl_int{ this->HasCoincidentNodes() }, chunk.Boundary,
    cl_int{ this->WithBoundary }, chunk.Active, cl_int{ chunk.Active() != nullptr },
    inputs.Cut.GetRows(), inputs.Cut.GetVertices(), chunk.ResampledTetrahedra, changed, list, p);
  std::vector<cl_uint> flags;
  VertexCuboids::ForAll(context, queue, cuboids, list,
    [&](const VertexCuboids::Launch& launch, std::size_t begin, std::size_t count)
    {
      queue.enqueueFillBuffer(changed, cl_uint{ 0 }, 0, count * sizeof(cl_uint));
      launch(kernel);
      flags.resize(count);
      queue.enqueueReadBuffer(changed, CL_TRUE, 0, count * sizeof(cl_uint), flags.data());
      for (std::size_t k = 0; k < count; ++k)
      {
        const Extent cells = chunkCuboids.GetCells(cuboids[begin + k]);
        if (flags[k] && GetNumberOfPoints(cells) > 0)
        {
          changes.push_back(cells);
        }
      }
    });
}

} // namespace deformvolume
