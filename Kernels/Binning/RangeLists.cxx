// SPDX-License-Identifier: BSD-3-Clause
#include "RangeLists.h"

#include "BinningProgram.h"
#include "HostMemory.h"
#include "KernelMaking.h"
#include "WorkDevice.h"

#include <algorithm>
#include <vector>

namespace deformvolume
{
namespace
{

// More ranges keep more work-items busy, but each range needs two counters per tile.
std::size_t CountRanges(WorkDevice& device, std::size_t numberOfTetrahedra, std::uint64_t tiles)
{
  const std::uint64_t most = std::max<std::uint64_t>(
    1, (std::uint64_t{ 64 } << 20) / (8 * std::max<std::uint64_t>(1, tiles)));
  const std::uint64_t units = device.GetContext().GetNumberOfUnits();
  return static_cast<std::size_t>(std::min<std::uint64_t>(
    { most, 4 * units, 128, static_cast<std::uint64_t>(numberOfTetrahedra) }));
}

std::uint64_t CountBeginBytes(std::size_t ranges, std::uint64_t tiles)
{
  return 2 * ranges * tiles * sizeof(cl_uint);
}

} // namespace

std::uint64_t RangeLists::Count(WorkDevice& device, const cl::Buffer& tetrahedra,
  const cl::Buffer& positions, const RasterParameters& p, ListBuffers& buffers)
{
  const std::uint64_t tiles = CountTiles(p);
  const std::size_t ranges = CountRanges(device, static_cast<std::size_t>(p.Tetrahedra), tiles);
  ReserveLists(device, this->RangeBegins, CountBeginBytes(ranges, tiles));
  ReserveLists(device, buffers.Begins, (tiles + 1) * sizeof(cl_uint));
  const cl::Kernel count = MakeKernel(GetRangeListsProgram(device.GetContext()), "CountTetrahedra",
    tetrahedra, positions, buffers.Boxes, buffers.Counters, this->RangeBegins, p);
  device.GetContext().Launch(device.GetQueue(), count, cl::NDRange(ranges), cl::NDRange(1));
  return this->FindRangeBegins(device, ranges, static_cast<std::size_t>(tiles), buffers);
}

std::uint64_t RangeLists::FindRangeBegins(
  WorkDevice& device, std::size_t ranges, std::size_t tiles, const ListBuffers& buffers)
{
  // Compute prefix sums over the ranges, for one tile after another.
  const std::size_t lists = 2 * ranges;
  std::vector<cl_uint> begins(tiles + 1);
  const cl::CommandQueue& queue = device.GetQueue();
  cl_uint* rangeBegins = static_cast<cl_uint*>(queue.enqueueMapBuffer(
    this->RangeBegins, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, CountBeginBytes(ranges, tiles)));
  std::uint64_t next = 0;
  for (std::size_t tile = 0; tile < tiles; ++tile)
  {
    begins[tile] = static_cast<cl_uint>(next);
    for (std::size_t list = 0; list < lists; ++list)
    {
      cl_uint& entry = rangeBegins[list * tiles + tile];
      const cl_uint number = entry;
      entry = static_cast<cl_uint>(next);
      next += number;
    }
  }
  begins[tiles] = static_cast<cl_uint>(next);
  queue.enqueueUnmapMemObject(this->RangeBegins, rangeBegins);
  queue.enqueueWriteBuffer(
    buffers.Begins, CL_TRUE, 0, begins.size() * sizeof(cl_uint), begins.data());
  return next;
}

void RangeLists::Fill(WorkDevice& device, const RasterParameters& p, const ListBuffers& buffers)
{
  const cl::Kernel list = MakeKernel(GetRangeListsProgram(device.GetContext()), "ListTetrahedra",
    buffers.Boxes, this->RangeBegins, buffers.Lists, p);
  const std::size_t ranges =
    CountRanges(device, static_cast<std::size_t>(p.Tetrahedra), CountTiles(p));
  device.GetContext().Launch(device.GetQueue(), list, cl::NDRange(ranges), cl::NDRange(1));
}

std::uint64_t RangeLists::GetMemory() const
{
  return deformvolume::GetMemory(this->RangeBegins);
}

std::uint64_t RangeLists::GetMemoryNeeded(
  WorkDevice& device, std::size_t numberOfTetrahedra, std::uint64_t tiles)
{
  return CountBeginBytes(CountRanges(device, numberOfTetrahedra, tiles), tiles);
}

} // namespace deformvolume
