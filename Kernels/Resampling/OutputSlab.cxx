// SPDX-License-Identifier: BSD-3-Clause
#include "OutputSlab.h"

#include "Background.h"
#include "BrickGrid.h"
#include "Error.h"
#include "OutputPatches.h"
#include "ResamplingProgram.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <type_traits>

namespace deformvolume
{
namespace
{

/// The bits of a section of a brick, as DEFORMVOLUME_BRICK_BITS says.
cl_uint GetSectionBits(std::size_t section)
{
  const std::size_t halves = section / DEFORMVOLUME_COLUMNS;
  return MakeSectionBits(
           static_cast<cl_uint>(section % DEFORMVOLUME_COLUMNS), halves & 1, halves & 2)
    << DEFORMVOLUME_BRICK_BITS;
}

template <typename T>
using BitsOf = std::conditional_t<sizeof(T) == 1, cl_uchar,
  std::conditional_t<sizeof(T) == 2, cl_ushort,
    std::conditional_t<sizeof(T) == 4, cl_uint, cl_ulong>>>;

template <typename T>
BitsOf<T> GetBits(T value)
{
  BitsOf<T> bits;
  std::memcpy(&bits, &value, sizeof(T));
  return bits;
}

/// Launches a kernel over so many items that have much to do. Groups run on one thread, and drivers
/// for processors put many items into one. Elsewhere items may be more, which the kernel leaves
/// out: of a prime number drivers would make groups of one item.
void LaunchBusyItems(OpenCLContext& context, const cl::CommandQueue& queue,
  const cl::Kernel& kernel, std::size_t items, std::vector<cl::Event>& events)
{
  const std::size_t group = context.GetDevice().HasVectors ? 1 : 64;
  events.push_back(context.Launch(
    queue, kernel, cl::NDRange((items + group - 1) / group * group), cl::NDRange(group)));
}

/// Fills a buffer of so many elements. Processors do that with a kernel: see OutputClearing.cl.
template <typename T>
void Fill(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Buffer& buffer, T value,
  std::uint64_t size, std::vector<cl::Event>& events)
{
  if constexpr (sizeof(T) > 1)
  {
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (std::all_of(bytes, bytes + sizeof(T), [&](unsigned char byte) { return byte == bytes[0]; }))
    {
      Fill(context, queue, buffer, bytes[0], size * sizeof(T), events);
      return;
    }
  }
  if (!context.GetDevice().IsProcessor)
  {
    events.emplace_back();
    queue.enqueueFillBuffer(buffer, value, 0, size * sizeof(T), nullptr, &events.back());
    return;
  }
  cl::Kernel kernel(GetOutputProgram(context), ("Fill" + std::to_string(sizeof(T))).c_str());
  kernel.setArg(0, buffer);
  kernel.setArg(1, cl_ulong{ size });
  kernel.setArg(2, GetBits(value));
  constexpr std::uint64_t step = DEFORMVOLUME_FILLED_BYTES / sizeof(T);
  LaunchBusyItems(
    context, queue, kernel, static_cast<std::size_t>((size + step - 1) / step), events);
}

/// The sum of what a kernel writes for each of its work-items.
std::uint64_t ReadSum(const cl::CommandQueue& queue, const cl::Buffer& sums, std::size_t items)
{
  std::vector<cl_uint> counts(items);
  queue.enqueueReadBuffer(sums, CL_TRUE, 0, items * sizeof(cl_uint), counts.data());
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{ 0 });
}

/// Lets go of memory of the host.
void Release(cl::Buffer& buffer)
{
  if (IsInPlace(buffer))
  {
    buffer = cl::Buffer();
  }
}

Extent GetWholeOutput(const DeformRequest& request)
{
  return GetNumberOfPoints(request.WholeOutputExtent) > 0 ? request.WholeOutputExtent
                                                          : request.OutputExtent;
}

} // namespace

std::size_t GetWinnerSize(const VoxelGrid& voxelGrid)
{
  constexpr std::int64_t mostCells = (std::int64_t{ 1 } << 30) - 2;
  return GetNumberOfCells(voxelGrid.VertexExtent) <= mostCells ? 4 : 8;
}

std::vector<Extent> OutputSlab::Split(const Extent& output, const std::vector<VolumeArray>& arrays,
  const VoxelGrid& voxelGrid, std::uint64_t allocationLimit)
{
  std::uint64_t widest = GetWinnerSize(voxelGrid);
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

std::uint64_t OutputSlab::GetBytesPerVoxel(const OpenCLContext& context,
  const std::vector<VolumeArray>& arrays, const DeformRequest& request)
{
  std::uint64_t bytes = CanWorkInPlace(context, request.Coverage, 1) ? 0 : 1;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    if (!CanWorkInPlace(context, request.Outputs[i], GetElementSize(arrays[i].Type)))
    {
      bytes += GetTupleSize(arrays[i]);
    }
  }
  return bytes;
}

void OutputSlab::Clear(OpenCLContext& context, const cl::Buffer& buffer, double value,
  ElementType type, std::uint64_t size, std::vector<cl::Event>& events) const
{
  switch (type)
  {
#define DEFORMVOLUME_CASE(name, ctype, cl)                                                         \
  case ElementType::name:                                                                          \
    Fill(context, this->Queue, buffer, ClampTo<ctype>(value), size, events);                       \
    break;
    DEFORMVOLUME_ELEMENT_TYPES(DEFORMVOLUME_CASE)
#undef DEFORMVOLUME_CASE
  }
}

void OutputSlab::PlaceArrays(
  OpenCLContext& context, const DeformRequest& request, const std::vector<VolumeArray>& arrays)
{
  this->Arrays.resize(arrays.size());
  this->TupleSizes.resize(arrays.size());
  const std::uint64_t offset = this->GetOffset(request);
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    this->TupleSizes[i] = GetTupleSize(arrays[i]);
    Place(context, this->Arrays[i],
      static_cast<char*>(request.Outputs[i]) + offset * this->TupleSizes[i],
      GetElementSize(arrays[i].Type), this->NumberOfVoxels * this->TupleSizes[i]);
  }
  Place(context, this->Coverage, request.Coverage + offset, 1, this->NumberOfVoxels);
}

void OutputSlab::PrepareAgain(OpenCLContext& context, const cl::CommandQueue& queue,
  const DeformRequest& request, const std::vector<VolumeArray>& arrays,
  const std::vector<cl_uint>& bricks)
{
  this->Finish();
  this->Queue = queue;
  this->SlabExtent = request.OutputExtent;
  this->WholeExtent = GetWholeOutput(request);
  this->NumberOfVoxels = static_cast<std::uint64_t>(GetNumberOfPoints(request.OutputExtent));
  this->PlaceArrays(context, request, arrays);
  for (const cl_uint brick : bricks)
  {
    const std::size_t number = brick & ((1U << DEFORMVOLUME_BRICK_BITS) - 1);
    for (std::size_t section = 0; section < DEFORMVOLUME_SECTIONS; ++section)
    {
      const cl_uint bits = GetSectionBits(section);
      if ((brick & bits) == bits)
      {
        std::fill_n(this->LastCounters.begin() +
            static_cast<std::ptrdiff_t>(
              (DEFORMVOLUME_SECTIONS * number + section) * DEFORMVOLUME_COUNTERS),
          DEFORMVOLUME_COUNTERS, cl_uint{ 0 });
      }
    }
  }
  if (!bricks.empty())
  {
    for (std::size_t section = 0; section < this->NumberOfSections; ++section)
    {
      cl_uint* const counter = this->LastCounters.data() + section * DEFORMVOLUME_COUNTERS;
      counter[DEFORMVOLUME_COUNT_CANDIDATES] = counter[DEFORMVOLUME_COUNT_TOUCHED] = 0;
    }
    // Done when Finish() is, at the latest.
    queue.enqueueWriteBuffer(this->Counters, CL_FALSE, 0,
      this->LastCounters.size() * sizeof(cl_uint), this->LastCounters.data());
  }
}

void OutputSlab::Prepare(OpenCLContext& context, const cl::CommandQueue& queue,
  const Extent& extent, const DeformRequest& request, const std::vector<VolumeArray>& arrays,
  const VoxelGrid& voxelGrid, std::size_t numberOfBricks, std::vector<cl::Event>& events)
{
  this->FinishReading();
  this->Finish();
  this->Queue = queue;
  this->SlabExtent = extent;
  this->WholeExtent = GetWholeOutput(request);
  this->WinnerSize = GetWinnerSize(voxelGrid);
  this->KeepsPatches = false;
  this->NumberOfVoxels = static_cast<std::uint64_t>(GetNumberOfPoints(extent));
  if (!this->HasWinners())
  {
    this->Winners = cl::Buffer();
    this->PatchStates = cl::Buffer();
  }
  this->PlaceArrays(context, request, arrays);
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    const VolumeArray& array = arrays[i];
    this->Clear(context, this->Arrays[i], array.Background, array.Type,
      this->NumberOfVoxels * static_cast<std::uint64_t>(array.Components), events);
  }
  this->Clear(context, this->Coverage, 0.0, ElementType::Int8, this->NumberOfVoxels, events);
  this->NumberOfSections = DEFORMVOLUME_SECTIONS * numberOfBricks;
  Reserve(
    context, this->Counters, this->NumberOfSections * DEFORMVOLUME_COUNTERS * sizeof(cl_uint));
  this->ClearCounters(context, events);
  this->MostLargeCells = static_cast<std::size_t>(std::min<std::int64_t>(
    GetNumberOfCells(voxelGrid.VertexExtent), DEFORMVOLUME_MOST_LARGE_CELLS));
  Reserve(context, this->LargeCells, (1 + this->MostLargeCells) * sizeof(LargeCell));
}

void OutputSlab::ClearCounters(OpenCLContext& context, std::vector<cl::Event>& events)
{
  Fill(context, this->Queue, this->Counters, cl_uint{ 0 },
    this->NumberOfSections * DEFORMVOLUME_COUNTERS, events);
}

bool OutputSlab::HasWinners() const
{
  // Those of a somewhat larger output serve as well: to touch fresh memory takes longer than to
  // fill it.
  const std::uint64_t needed = this->NumberOfVoxels * this->WinnerSize;
  const std::uint64_t held = deformvolume::GetMemory(this->Winners);
  return held >= needed && held - needed <= needed / 4 &&
    deformvolume::GetMemory(this->PatchStates) >= 2 * this->CountAllPatches();
}

std::uint64_t OutputSlab::GetMissingWinnerMemory() const
{
  return this->HasWinners() ? 0
                            : this->NumberOfVoxels * this->WinnerSize + 2 * this->CountAllPatches();
}

void OutputSlab::PrepareWinners(OpenCLContext& context, std::vector<cl::Event>& events)
{
  if (!this->HasWinners())
  {
    Reserve(context, this->Winners, this->NumberOfVoxels * this->WinnerSize);
    Reserve(context, this->PatchStates, 2 * this->CountAllPatches());
  }
  Fill(context, this->Queue, this->Winners, std::numeric_limits<cl_uint>::max(),
    this->NumberOfVoxels * this->WinnerSize / sizeof(cl_uint), events);
  Fill(context, this->Queue, this->PatchStates, cl_uchar{ 0 }, 2 * this->CountAllPatches(), events);
}

void OutputSlab::PrepareWinnersAgain(const std::vector<std::uint32_t>& patches)
{
  const MappedBuffer<unsigned char> winners(this->Queue, this->Winners, CL_MAP_WRITE);
  FillPatches(this->SlabExtent, patches, winners.Get(), this->WinnerSize, 0xff);
  const MappedBuffer<unsigned char> states(
    this->Queue, this->PatchStates, CL_MAP_READ | CL_MAP_WRITE);
  this->KeepsPatches = true;
  const std::uint64_t all = this->CountAllPatches();
  std::fill_n(states.Get(), all, static_cast<unsigned char>(DEFORMVOLUME_PATCH_KEPT));
  for (const std::uint32_t patch : patches)
  {
    states.Get()[patch] = states.Get()[all + patch] = 0;
  }
}

bool OutputSlab::HasContested() const
{
  const std::uint64_t all = this->CountAllPatches();
  std::vector<unsigned char> contested(static_cast<std::size_t>(all));
  this->Queue.enqueueReadBuffer(this->PatchStates, CL_TRUE, all, all, contested.data());
  return std::find(contested.begin(), contested.end(), 1) != contested.end();
}

std::uint64_t OutputSlab::CountAllPatches() const
{
  std::uint64_t patches = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    patches *= static_cast<std::uint64_t>(DEFORMVOLUME_PATCHES(GetSize(this->SlabExtent, axis)));
  }
  return patches;
}

void OutputSlab::Settle(OpenCLContext& context, bool claimed, const KernelParameters& parameters,
  std::vector<cl::Event>& events)
{
  const std::size_t items = this->CountItems();
  KernelParameters p = parameters;
  this->SetParameters(p);
  if (!claimed)
  {
    // Nor is it known what cells hold beside what they own.
    Fill(context, this->Queue, this->PatchStates, cl_uchar{ DEFORMVOLUME_PATCH_TOUCHED },
      this->CountAllPatches(), events);
  }
  cl::Kernel kernel(GetOutputProgram(context), "Settle");
  kernel.setArg(0, this->Coverage);
  kernel.setArg(1, this->Winners);
  kernel.setArg(2, static_cast<cl_uint>(this->WinnerSize / sizeof(cl_uint)));
  kernel.setArg(3, cl_int{ claimed });
  kernel.setArg(4, this->PatchStates);
  kernel.setArg(5, this->Counters);
  kernel.setArg(6, p);
  LaunchBusyItems(context, this->Queue, kernel, items, events);
}

std::size_t OutputSlab::CountItems() const
{
  return static_cast<std::size_t>(
    (this->NumberOfVoxels + DEFORMVOLUME_COUNTED_VOXELS - 1) / DEFORMVOLUME_COUNTED_VOXELS);
}

void OutputSlab::ClearLargeCells() const
{
  this->Queue.enqueueFillBuffer(this->LargeCells, cl_uint{ 0 }, 0, sizeof(cl_uint));
}

std::vector<OutputSlab::LargeCell> OutputSlab::ReadLargeCells() const
{
  cl_uint number = 0;
  this->Queue.enqueueReadBuffer(this->LargeCells, CL_TRUE, 0, sizeof(number), &number);
  std::vector<LargeCell> cells(std::min<std::size_t>(number, this->MostLargeCells));
  if (!cells.empty())
  {
    this->Queue.enqueueReadBuffer(
      this->LargeCells, CL_TRUE, sizeof(LargeCell), cells.size() * sizeof(LargeCell), cells.data());
  }
  return cells;
}

std::uint64_t OutputSlab::CountCovered(OpenCLContext& context, std::vector<cl::Event>& events)
{
  const std::size_t items = this->CountItems();
  const cl::Buffer sums(context.GetContext(), CL_MEM_WRITE_ONLY, items * sizeof(cl_uint));
  cl::Kernel kernel(GetOutputProgram(context), "CountCovered");
  kernel.setArg(0, this->Coverage);
  kernel.setArg(1, cl_ulong{ this->NumberOfVoxels });
  kernel.setArg(2, sums);
  LaunchBusyItems(context, this->Queue, kernel, items, events);
  return ReadSum(this->Queue, sums, items);
}

const std::vector<cl_uint>& OutputSlab::ReadCounters()
{
  this->LastCounters.resize(this->NumberOfSections * DEFORMVOLUME_COUNTERS);
  this->Queue.enqueueReadBuffer(this->Counters, CL_TRUE, 0,
    this->LastCounters.size() * sizeof(cl_uint), this->LastCounters.data());
  return this->LastCounters;
}

std::vector<cl_uint> OutputSlab::FindBricks(int counter)
{
  const std::vector<cl_uint>& counters = this->ReadCounters();
  std::vector<cl_uint> bricks;
  for (std::size_t brick = 0; brick < this->NumberOfSections / DEFORMVOLUME_SECTIONS; ++brick)
  {
    cl_uint bits = 0;
    for (std::size_t section = 0; section < DEFORMVOLUME_SECTIONS; ++section)
    {
      const std::size_t place = (DEFORMVOLUME_SECTIONS * brick + section) * DEFORMVOLUME_COUNTERS;
      if (counters[place + static_cast<std::size_t>(counter)])
      {
        bits |= GetSectionBits(section);
      }
    }
    if (bits)
    {
      bricks.push_back(static_cast<cl_uint>(brick) | bits);
    }
  }
  return bricks;
}

OutputSlab::Counts OutputSlab::ReadCounts()
{
  const std::vector<cl_uint>& counters = this->ReadCounters();
  Counts counts;
  std::uint64_t missing = 0;
  std::uint64_t assumed = 0;
  for (std::size_t section = 0; section < this->NumberOfSections; ++section)
  {
    const cl_uint* counter = counters.data() + section * DEFORMVOLUME_COUNTERS;
    counts.Writes += counter[DEFORMVOLUME_COUNT_WRITES];
    counts.Inverted += counter[DEFORMVOLUME_COUNT_INVERTED];
    counts.Overstretched += counter[DEFORMVOLUME_COUNT_OVERSTRETCHED];
    counts.Large += counter[DEFORMVOLUME_COUNT_LARGE];
    missing += counter[DEFORMVOLUME_COUNT_MISSING];
    assumed += counter[DEFORMVOLUME_COUNT_ASSUMED];
  }
  counts.MissingWhereAssumed = missing > 0 && assumed > 0;
  return counts;
}

bool OutputSlab::FitsLanes() const
{
  // Positions in 1/256 voxel are exact in float up to 2^24. Relative to the output they fit 32 bits
  // where that begins within 2^22 voxels: those at rest lie within 2^21.
  constexpr int farthest = 1 << 22;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int first = this->SlabExtent[2 * axis];
    if (GetSize(this->SlabExtent, axis) > 32768 || first < -farthest || first > farthest)
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
    parameters.WholeFirst[axis] = this->WholeExtent[2 * axis] - this->SlabExtent[2 * axis];
    parameters.WholeEnd[axis] = this->WholeExtent[2 * axis + 1] + 1 - this->SlabExtent[2 * axis];
  }
  parameters.MostLargeCells = static_cast<int>(this->MostLargeCells);
  parameters.KeepsPatches = this->KeepsPatches ? 1 : 0;
  parameters.IsPart = this->WholeExtent != this->SlabExtent ? 1 : 0;
}

std::uint64_t OutputSlab::GetOffset(const DeformRequest& request) const
{
  const std::uint64_t plane = static_cast<std::uint64_t>(GetSize(this->SlabExtent, 0)) *
    static_cast<std::uint64_t>(GetSize(this->SlabExtent, 1));
  return plane *
    static_cast<std::uint64_t>(std::int64_t{ this->SlabExtent[4] } - request.OutputExtent[4]);
}

void OutputSlab::Read(const cl::CommandQueue& queue, const DeformRequest& request)
{
  const std::uint64_t offset = this->GetOffset(request);
  for (std::size_t i = 0; i < this->Arrays.size(); ++i)
  {
    this->Reads.Add(BeginToRead(queue, this->Arrays[i], this->NumberOfVoxels * this->TupleSizes[i],
      static_cast<char*>(request.Outputs[i]) + offset * this->TupleSizes[i]));
  }
  this->Reads.Add(
    BeginToRead(queue, this->Coverage, this->NumberOfVoxels, request.Coverage + offset));
  queue.flush();
}

void OutputSlab::Finish()
{
  if (this->Queue())
  {
    clFinish(this->Queue()); // throws nothing: this is also called after a failure
  }
  this->Reads.Wait();
  for (cl::Buffer& array : this->Arrays)
  {
    Release(array);
  }
  Release(this->Coverage);
}

std::uint64_t OutputSlab::GetMemory() const
{
  std::uint64_t bytes = deformvolume::GetMemory(this->Coverage) +
    deformvolume::GetMemory(this->Winners) + deformvolume::GetMemory(this->PatchStates) +
    deformvolume::GetMemory(this->Counters);
  for (const cl::Buffer& array : this->Arrays)
  {
    bytes += deformvolume::GetMemory(array);
  }
  return bytes;
}

} // namespace deformvolume
