// SPDX-License-Identifier: BSD-3-Clause
#include "TetrahedronLists.h"

#include "Error.h"
#include "HostMemory.h"
#include "RasterizationProgram.h"
#include "WorkDevice.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

namespace deformvolume
{
namespace
{

void ReserveLists(WorkDevice& device, cl::Buffer& buffer, std::uint64_t bytes)
{
  const std::uint64_t limit = device.GetAllocationLimit();
  if (bytes > limit)
  {
    throw Error("The lists of the tetrahedra in each part of the output need " +
      std::to_string(bytes) + " bytes in one piece, and the device gives no more than " +
      std::to_string(limit) +
      ". Use a coarser deformation mesh, the resampler Exact, or another device.");
  }
  if (GetMemory(buffer) < bytes)
  {
    buffer = cl::Buffer();
    buffer = cl::Buffer(device.GetContext().GetContext(), CL_MEM_READ_WRITE, bytes);
  }
}

std::uint64_t CountTiles(const RasterParameters& p)
{
  return static_cast<std::uint64_t>(p.TileCount[0]) * p.TileCount[1] * p.TileCount[2];
}

} // namespace

std::int64_t TetrahedronLists::Make(WorkDevice& device, const cl::Buffer& tetrahedra,
  const cl::Buffer& positions, RasterParameters& p)
{
  const std::uint64_t tiles = CountTiles(p);
  // More ranges keep more work-items busy, and cost two counters a tile each.
  const std::uint64_t most = std::max<std::uint64_t>(1, (std::uint64_t{ 64 } << 20) / (8 * tiles));
  const std::uint64_t units = device.GetDevice().Device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  p.Ranges = static_cast<int>(
    std::min<std::uint64_t>({ most, 4 * units, 128, static_cast<std::uint64_t>(p.Tetrahedra) }));
  const std::uint64_t ranges = static_cast<std::uint64_t>(p.Ranges);
  ReserveLists(device, this->Places, 2 * ranges * tiles * sizeof(cl_uint));
  ReserveLists(device, this->Begins, (tiles + 1) * sizeof(cl_uint));
  const std::int64_t inverted = this->Count(device, tetrahedra, positions, p);
  const std::uint64_t length = this->FindPlaces(device, p);
  ReserveLists(device, this->Lists, std::max<std::uint64_t>(length, 1) * sizeof(cl_int));
  cl::Kernel list(GetBinningProgram(device.GetContext()), "ListTetrahedra");
  list.setArg(0, tetrahedra);
  list.setArg(1, positions);
  list.setArg(2, this->Places);
  list.setArg(3, this->Lists);
  list.setArg(4, p);
  device.GetContext().Launch(
    device.GetQueue(), list, cl::NDRange(static_cast<std::size_t>(ranges)), cl::NDRange(1));
  device.GetQueue().finish();
  return inverted;
}

std::int64_t TetrahedronLists::Count(WorkDevice& device, const cl::Buffer& tetrahedra,
  const cl::Buffer& positions, const RasterParameters& p)
{
  const auto ranges = static_cast<std::size_t>(p.Ranges);
  std::vector<cl_uint> counts(ranges * DEFORMVOLUME_BINNED_COUNTERS);
  const cl::Buffer counters(
    device.GetContext().GetContext(), CL_MEM_WRITE_ONLY, counts.size() * sizeof(cl_uint));
  cl::Kernel count(GetBinningProgram(device.GetContext()), "CountTetrahedra");
  count.setArg(0, tetrahedra);
  count.setArg(1, positions);
  count.setArg(2, this->Places);
  count.setArg(3, counters);
  count.setArg(4, p);
  device.GetContext().Launch(device.GetQueue(), count, cl::NDRange(ranges), cl::NDRange(1));
  device.GetQueue().enqueueReadBuffer(
    counters, CL_TRUE, 0, counts.size() * sizeof(cl_uint), counts.data());
  std::int64_t inverted = 0;
  std::uint64_t overstretched = 0;
  for (std::size_t range = 0; range < ranges; ++range)
  {
    const cl_uint* counter = counts.data() + range * DEFORMVOLUME_BINNED_COUNTERS;
    inverted += counter[DEFORMVOLUME_BINNED_INVERTED];
    overstretched += counter[DEFORMVOLUME_BINNED_OVERSTRETCHED];
  }
  if (overstretched > 0)
  {
    throw Error(std::to_string(overstretched) +
      " tetrahedra of the deformation mesh span more than 5,000 output voxels, which the resampler "
      "MeshRasterization cannot rasterise. Use the resampler Exact, a finer mesh or a greater "
      "output spacing.");
  }
  return inverted;
}

std::uint64_t TetrahedronLists::FindPlaces(WorkDevice& device, const RasterParameters& p)
{
  // Sums over the ranges, tile by tile.
  const auto tiles = static_cast<std::size_t>(CountTiles(p));
  const std::size_t lists = 2 * static_cast<std::size_t>(p.Ranges);
  std::vector<cl_uint> begins(tiles + 1);
  const cl::CommandQueue& queue = device.GetQueue();
  cl_uint* places = static_cast<cl_uint*>(queue.enqueueMapBuffer(
    this->Places, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, lists * tiles * sizeof(cl_uint)));
  std::uint64_t place = 0;
  for (std::size_t tile = 0; tile < tiles; ++tile)
  {
    begins[tile] = static_cast<cl_uint>(place);
    for (std::size_t list = 0; list < lists; ++list)
    {
      cl_uint& entry = places[list * tiles + tile];
      const cl_uint number = entry;
      entry = static_cast<cl_uint>(place);
      place += number;
    }
  }
  begins[tiles] = static_cast<cl_uint>(place);
  queue.enqueueUnmapMemObject(this->Places, places);
  if (place > std::numeric_limits<cl_uint>::max())
  {
    throw Error("The deformation mesh and the output are too large for the resampler "
                "MeshRasterization: use the resampler Exact, or a coarser mesh.");
  }
  queue.enqueueWriteBuffer(
    this->Begins, CL_TRUE, 0, begins.size() * sizeof(cl_uint), begins.data());
  return place;
}

std::uint64_t TetrahedronLists::GetMemory() const
{
  return deformvolume::GetMemory(this->Places) + deformvolume::GetMemory(this->Begins) +
    deformvolume::GetMemory(this->Lists);
}

} // namespace deformvolume
