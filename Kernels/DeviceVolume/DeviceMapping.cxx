// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceMapping.h"

#include "HostMemory.h"

#include <algorithm>

namespace deformvolume
{

DeviceMapping::DeviceMapping(OpenCLContext& context, const cl::CommandQueue& queue,
  const std::array<int, 3>& size, std::uint64_t allocationLimit)
  : Context(context)
  , Queue(queue)
  , Size(size)
  , AllocationLimit(allocationLimit)
  , Records(context, queue, allocationLimit)
{
}

void DeviceMapping::SendLinks(VolumeChunk& chunk, const VertexLink* links)
{
  const std::int64_t plane = static_cast<std::int64_t>(this->Size[0]) * this->Size[1];
  const std::uint64_t bytes =
    static_cast<std::uint64_t>((chunk.PlanesEnd - chunk.PlanesBegin) * plane) * sizeof(VertexLink);
  CheckAllocation(bytes, this->AllocationLimit, "The links of the voxels to the deformation mesh",
    "Use a smaller volume");
  Reserve(this->Context, chunk.Links, bytes);
  Write(this->Queue, chunk.Links, 0, bytes, links + chunk.PlanesBegin * plane);
}

void DeviceMapping::SetLinks(std::vector<VolumeChunk>& chunks, const VertexLink* links)
{
  this->Forget(chunks); // there are no links until all are copied
  const std::int64_t voxels =
    static_cast<std::int64_t>(this->Size[0]) * this->Size[1] * this->Size[2];
  this->AllLinked = std::all_of(
    links, links + voxels, [](const VertexLink& link) { return link.Tetrahedron >= 0; });
  for (VolumeChunk& chunk : chunks)
  {
    this->SendLinks(chunk, links);
  }
  this->WithLinks = true;
}

void DeviceMapping::Forget(std::vector<VolumeChunk>& chunks)
{
  for (VolumeChunk& chunk : chunks)
  {
    chunk.Links = chunk.Runs = chunk.RowRanges = cl::Buffer();
  }
  this->Rows.clear();
  this->Records.Clear();
  this->RunBytes = 0;
  this->WithLinks = false;
}

void DeviceMapping::SetRuns(std::vector<VolumeChunk>& chunks, const VertexRuns& runs)
{
  static_assert(
    sizeof(VertexRun) == 8 && sizeof(TetrahedronRecord) == 64, "The kernels need these sizes.");
  this->Forget(chunks);
  this->AllLinked = std::all_of(
    runs.Runs.begin(), runs.Runs.end(), [](const VertexRun& run) { return run.Tetrahedron >= 0; });
  const std::int64_t rows = this->Size[1];
  for (VolumeChunk& chunk : chunks)
  {
    const auto first = runs.RowBegins.begin() + rows * chunk.PlanesBegin;
    const auto last = runs.RowBegins.begin() + rows * chunk.PlanesEnd;
    std::vector<std::uint32_t> ranges;
    for (auto begin = first; begin != last; ++begin)
    {
      ranges.push_back(begin[0] - *first);
      ranges.push_back(begin[1] - *first);
    }
    const std::uint64_t bytes[2] = { static_cast<std::uint64_t>(*last - *first) * sizeof(VertexRun),
      ranges.size() * sizeof(std::uint32_t) };
    CheckAllocation(std::max(bytes[0], bytes[1]), this->AllocationLimit, "The runs of voxels",
      "Use a smaller volume, a coarser deformation mesh");
    Reserve(this->Context, chunk.Runs, bytes[0]);
    Reserve(this->Context, chunk.RowRanges, bytes[1]);
    Write(this->Queue, chunk.Runs, 0, bytes[0], runs.Runs.data() + *first);
    Write(this->Queue, chunk.RowRanges, 0, bytes[1], ranges.data());
    this->Rows.push_back(std::move(ranges));
  }
  this->Records.Set(runs.Tetrahedra);
  this->RunBytes = GetBytes(runs);
}

BrickPoints DeviceMapping::MakeBrickPoints(const VolumeChunk& chunk, const BrickGrid& grid,
  const cl::Buffer& tetrahedra, std::size_t numberOfNodes,
  const std::vector<std::vector<std::int32_t>>& boundary) const
{
  const MappedBuffer<const Tetrahedron> offsets(this->Queue, tetrahedra, CL_MAP_READ);
  const auto numberOfTetrahedra =
    static_cast<std::size_t>(GetMemory(tetrahedra) / sizeof(Tetrahedron));
  if (!this->HasRuns())
  {
    const MappedBuffer<const VertexLink> links(this->Queue, chunk.Links, CL_MAP_READ);
    return BrickPoints::FromLinks(
      grid, links.Get(), { offsets.Get(), numberOfTetrahedra, numberOfNodes, boundary });
  }
  const MappedBuffer<const VertexRun> runs(this->Queue, chunk.Runs, CL_MAP_READ);
  const MappedBuffer<const std::int32_t> owners(
    this->Queue, this->Records.GetOwners(), CL_MAP_READ);
  BrickPoints points;
  this->Records.VisitRest(
    [&](const double* rest)
    {
      points =
        BrickPoints::FromRuns(grid, { runs.Get(), this->Rows.front().data(), rest, owners.Get() },
          { offsets.Get(), numberOfTetrahedra, numberOfNodes, boundary });
    });
  return points;
}

} // namespace deformvolume
