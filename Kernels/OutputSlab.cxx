// SPDX-License-Identifier: BSD-3-Clause
#include "OutputSlab.h"

#include "Background.h"
#include "DeviceLattice.h" // for GetMemory
#include "KernelProgram.h"

#include <algorithm>
#include <limits>

namespace deformvolume
{
namespace
{

template <typename T>
void Fill(const cl::CommandQueue& queue, const cl::Buffer& buffer, double value,
  std::vector<cl::Event>& events)
{
  events.emplace_back();
  queue.enqueueFillBuffer(buffer, ClampTo<T>(value), 0, GetMemory(buffer), nullptr, &events.back());
}

void Reserve(OpenCLContext& context, cl::Buffer& buffer, std::uint64_t bytes)
{
  if (GetMemory(buffer) != bytes)
  {
    buffer = cl::Buffer(); // free the old one before the new one is made
    buffer = cl::Buffer(context.GetContext(), CL_MEM_READ_WRITE, bytes);
  }
}

} // namespace

std::size_t GetWinnerSize(const Lattice& lattice)
{
  return GetNumberOfCells(lattice.VertexExtent) < std::numeric_limits<std::int32_t>::max() ? 4 : 8;
}

std::vector<Extent> OutputSlab::Split(const Extent& output, const std::vector<VolumeArray>& arrays,
  const Lattice& lattice, std::uint64_t allocationLimit)
{
  std::uint64_t widest = GetWinnerSize(lattice);
  for (const VolumeArray& array : arrays)
  {
    widest = std::max<std::uint64_t>(widest, GetTupleSize(array));
  }
  const std::uint64_t plane = static_cast<std::uint64_t>(GetSize(output, 0)) *
    static_cast<std::uint64_t>(GetSize(output, 1)) * widest;
  const std::uint64_t planes = allocationLimit / plane;
  if (planes == 0)
  {
    throw Error("A slice of the output needs " + std::to_string(plane) +
      " bytes, and the device gives no more than " + std::to_string(allocationLimit) +
      " bytes at once. Use smaller output bounds or another device.");
  }
  std::vector<Extent> slabs;
  for (std::int64_t z = output[4]; z <= output[5];)
  {
    Extent slab = output;
    slab[4] = static_cast<int>(z);
    slab[5] = static_cast<int>(
      std::min<std::int64_t>(output[5], z + static_cast<std::int64_t>(planes) - 1));
    slabs.push_back(slab);
    z = std::int64_t{ slab[5] } + 1;
  }
  return slabs;
}

void OutputSlab::Prepare(OpenCLContext& context, const cl::CommandQueue& queue,
  const Extent& extent, const std::vector<VolumeArray>& arrays, const Lattice& lattice,
  std::size_t numberOfBricks, std::vector<cl::Event>& events)
{
  this->Queue = queue;
  this->SlabExtent = extent;
  this->WinnerSize = GetWinnerSize(lattice);
  this->NumberOfVoxels = static_cast<std::uint64_t>(GetNumberOfPoints(extent));
  if (deformvolume::GetMemory(this->Winners) != this->NumberOfVoxels * this->WinnerSize)
  {
    this->Winners = cl::Buffer();
  }
  this->Arrays.resize(arrays.size());
  this->TupleSizes.resize(arrays.size());
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    this->TupleSizes[i] = GetTupleSize(arrays[i]);
    Reserve(context, this->Arrays[i], this->NumberOfVoxels * this->TupleSizes[i]);
    switch (arrays[i].Type)
    {
#define DEFORMVOLUME_CASE(name, ctype, cl)                                                         \
  case ElementType::name:                                                                          \
    Fill<ctype>(queue, this->Arrays[i], arrays[i].Background, events);                             \
    break;
      DEFORMVOLUME_ELEMENT_TYPES(DEFORMVOLUME_CASE)
#undef DEFORMVOLUME_CASE
    }
  }
  Reserve(context, this->Coverage, this->NumberOfVoxels);
  Fill<std::int8_t>(queue, this->Coverage, 0.0, events);
  this->NumberOfBricks = numberOfBricks;
  Reserve(context, this->Counters, this->NumberOfBricks * DEFORMVOLUME_COUNTERS * sizeof(cl_uint));
  Fill<std::uint32_t>(queue, this->Counters, 0.0, events);
}

void OutputSlab::PrepareWinners(OpenCLContext& context, std::vector<cl::Event>& events)
{
  Reserve(context, this->Winners, this->NumberOfVoxels * this->WinnerSize);
  events.emplace_back();
  this->Queue.enqueueFillBuffer(this->Winners, std::numeric_limits<std::uint32_t>::max(), 0,
    deformvolume::GetMemory(this->Winners), nullptr, &events.back());
}

std::uint64_t OutputSlab::CountCovered(OpenCLContext& context, std::vector<cl::Event>& events)
{
  const std::size_t items = static_cast<std::size_t>(
    (this->NumberOfVoxels + DEFORMVOLUME_COUNTED_VOXELS - 1) / DEFORMVOLUME_COUNTED_VOXELS);
  const cl::Buffer sums(context.GetContext(), CL_MEM_WRITE_ONLY, items * sizeof(cl_uint));
  cl::Kernel kernel(GetCountingProgram(context), "CountCovered");
  kernel.setArg(0, this->Coverage);
  kernel.setArg(1, cl_ulong{ this->NumberOfVoxels });
  kernel.setArg(2, sums);
  events.emplace_back();
  this->Queue.enqueueNDRangeKernel(
    kernel, cl::NullRange, cl::NDRange(items), cl::NullRange, nullptr, &events.back());
  std::vector<cl_uint> counts(items);
  this->Queue.enqueueReadBuffer(sums, CL_TRUE, 0, items * sizeof(cl_uint), counts.data());
  std::uint64_t covered = 0;
  for (const cl_uint count : counts)
  {
    covered += count;
  }
  return covered;
}

OutputSlab::Counts OutputSlab::ReadCounts()
{
  std::vector<cl_uint> counters(this->NumberOfBricks * DEFORMVOLUME_COUNTERS);
  this->Queue.enqueueReadBuffer(
    this->Counters, CL_TRUE, 0, counters.size() * sizeof(cl_uint), counters.data());
  Counts counts;
  std::uint64_t missing = 0;
  std::uint64_t assumed = 0;
  for (std::size_t brick = 0; brick < this->NumberOfBricks; ++brick)
  {
    const cl_uint* counter = counters.data() + brick * DEFORMVOLUME_COUNTERS;
    counts.Writes += counter[DEFORMVOLUME_COUNT_WRITES];
    counts.Inverted += counter[DEFORMVOLUME_COUNT_INVERTED];
    counts.Overstretched += counter[DEFORMVOLUME_COUNT_OVERSTRETCHED];
    missing += counter[DEFORMVOLUME_COUNT_MISSING];
    assumed += counter[DEFORMVOLUME_COUNT_ASSUMED];
  }
  counts.MissingWhereAssumed = missing > 0 && assumed > 0;
  return counts;
}

bool OutputSlab::FitsLanes() const
{
  // Positions in 1/256 voxel are exact in float up to 2^24.
  for (int axis = 0; axis < 3; ++axis)
  {
    if (GetSize(this->SlabExtent, axis) > 32768)
    {
      return false;
    }
  }
  return this->NumberOfVoxels <=
    static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max());
}

void OutputSlab::SetParameters(KernelParameters& parameters) const
{
  for (int axis = 0; axis < 3; ++axis)
  {
    parameters.OutputFirst[axis] = this->SlabExtent[2 * axis];
    parameters.OutputSize[axis] = static_cast<int>(GetSize(this->SlabExtent, axis));
  }
}

void OutputSlab::Read(const DeformRequest& request)
{
  const std::uint64_t plane = static_cast<std::uint64_t>(GetSize(this->SlabExtent, 0)) *
    static_cast<std::uint64_t>(GetSize(this->SlabExtent, 1));
  const std::uint64_t offset = plane *
    static_cast<std::uint64_t>(std::int64_t{ this->SlabExtent[4] } - request.OutputExtent[4]);
  for (std::size_t i = 0; i < this->Arrays.size(); ++i)
  {
    this->Queue.enqueueReadBuffer(this->Arrays[i], CL_FALSE, 0,
      this->NumberOfVoxels * this->TupleSizes[i],
      static_cast<char*>(request.Outputs[i]) + offset * this->TupleSizes[i]);
  }
  this->Queue.enqueueReadBuffer(
    this->Coverage, CL_FALSE, 0, this->NumberOfVoxels, request.Coverage + offset);
  this->Queue.finish();
}

std::uint64_t OutputSlab::GetMemory() const
{
  std::uint64_t bytes = deformvolume::GetMemory(this->Coverage) +
    deformvolume::GetMemory(this->Winners) + deformvolume::GetMemory(this->Counters);
  for (const cl::Buffer& array : this->Arrays)
  {
    bytes += deformvolume::GetMemory(array);
  }
  return bytes;
}

} // namespace deformvolume
