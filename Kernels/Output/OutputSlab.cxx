// SPDX-License-Identifier: BSD-3-Clause
#include "OutputSlab.h"

#include "DeviceOutputInternals.h"
#include "KernelMaking.h"
#include "OutputFilling.h"
#include "OutputPatches.h"
#include "ResamplingProgram.h"
#include "SlabSizes.h"
#include "WorkDevice.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace deformvolume
{
namespace
{

/// Adds up the values that a kernel writes for each of its work-items.
std::uint64_t ReadSum(const cl::CommandQueue& queue, const cl::Buffer& sums, std::size_t items)
{
  std::vector<cl_uint> counts(items);
  queue.enqueueReadBuffer(sums, CL_TRUE, 0, items * sizeof(cl_uint), counts.data());
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{ 0 });
}

/// Releases a buffer that uses host memory in place.
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

void OutputSlab::BindArrays(
  OpenCLContext& context, const DeformRequest& request, const std::vector<VolumeArray>& arrays)
{
  this->Arrays.resize(arrays.size());
  this->TupleSizes.resize(arrays.size());
  const std::uint64_t offset = this->GetOffset(request);
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    this->TupleSizes[i] = GetTupleSize(arrays[i]);
    deformvolume::Bind(context, this->Arrays[i],
      static_cast<char*>(request.Outputs[i]) + offset * this->TupleSizes[i],
      GetElementSize(arrays[i].Type), this->NumberOfVoxels * this->TupleSizes[i]);
  }
  deformvolume::Bind(context, this->Coverage, request.Coverage + offset, 1, this->NumberOfVoxels);
}

bool OutputSlab::HoldsLastOutput(const OpenCLContext& context, const DeformRequest& request,
  const std::vector<VolumeArray>& arrays) const
{
  const auto voxels = static_cast<std::uint64_t>(GetNumberOfPoints(request.OutputExtent));
  // Arrays in host memory are always available.
  const auto holds = [&](const cl::Buffer& buffer, const void* memory, std::size_t elementSize,
                       std::size_t tupleSize)
  {
    return CanWorkInPlace(context, memory, elementSize) ||
      deformvolume::GetMemory(buffer) == voxels * tupleSize;
  };
  bool all = this->SlabExtent == request.OutputExtent && this->Arrays.size() == arrays.size() &&
    holds(this->Coverage, request.Coverage, 1, 1);
  for (std::size_t i = 0; all && i < arrays.size(); ++i)
  {
    all = holds(
      this->Arrays[i], request.Outputs[i], GetElementSize(arrays[i].Type), GetTupleSize(arrays[i]));
  }
  return all;
}

void OutputSlab::PrepareUpdate(OpenCLContext& context, const cl::CommandQueue& queue,
  const DeformRequest& request, const std::vector<VolumeArray>& arrays, const PartToUpdate& part,
  std::vector<cl::Event>& events)
{
  this->Finish();
  this->Queue = queue;
  this->WholeExtent = GetWholeOutput(request);
  const bool onHost = GetOutputBytesPerVoxel(context, arrays, request) == 0;
  if (onHost)
  {
    // Clear patches on the host, before buffers use the memory.
    ClearPatches(request, arrays, part.Patches);
  }
  this->BindArrays(context, request, arrays);
  const bool withWinners = part.WithWinners && !part.Bricks.empty();
  this->NumberOfListedPatches = 0;
  if (!onHost || withWinners || this->BitsUsed)
  {
    this->SendPatches(context, part.Patches);
  }
  KernelParameters p = {};
  this->SetParameters(p);
  if (!part.Patches.empty() && !onHost)
  {
    const auto clear = [&](
                         const cl::Buffer& buffer, const ElementBytes& value, std::size_t elements)
    {
      FillPatches(
        context, queue, buffer, value, elements, this->PatchList, part.Patches.size(), p, events);
    };
    for (std::size_t i = 0; i < arrays.size(); ++i)
    {
      clear(
        this->Arrays[i], GetBackground(arrays[i]), static_cast<std::size_t>(arrays[i].Components));
    }
    clear(this->Coverage, ElementBytes::Of(cl_uchar{ 0 }), 1);
  }
  if (this->BitsUsed && !part.Patches.empty())
  {
    ClearPatchBits(
      context, queue, this->CoverageBits, this->PatchList, part.Patches.size(), p, events);
  }
  if (withWinners)
  {
    this->Winners.PrepareUpdate(context, part.Patches, this->PatchList, p, events);
  }
  if (!part.Bricks.empty())
  {
    this->Counters.ClearSections(
      context, part.Bricks.size(), part.BrickList, part.WithWinners, events);
  }
}

void OutputSlab::SendPatches(OpenCLContext& context, const std::vector<std::uint32_t>& patches)
{
  if (!patches.empty())
  {
    const std::uint64_t bytes = patches.size() * sizeof(cl_uint);
    Reserve(context, this->PatchList, bytes);
    this->Queue.enqueueWriteBuffer(this->PatchList, CL_TRUE, 0, bytes, patches.data());
    this->NumberOfListedPatches = patches.size();
  }
}

void OutputSlab::Bind(OpenCLContext& context, const cl::CommandQueue& queue, const Extent& extent,
  const DeformRequest& request, const std::vector<VolumeArray>& arrays, const VoxelGrid& voxelGrid,
  std::size_t numberOfBricks, std::vector<cl::Event>& events)
{
  this->FinishReading();
  this->Finish();
  this->Queue = queue;
  this->SlabExtent = extent;
  this->WholeExtent = GetWholeOutput(request);
  this->NumberOfVoxels = static_cast<std::uint64_t>(GetNumberOfPoints(extent));
  this->Winners.Start(queue, extent, voxelGrid);
  this->BindArrays(context, request, arrays);
  this->Counters.Start(context, queue, numberOfBricks, events);
  this->LargeCells.Start(context, queue, GetNumberOfCells(voxelGrid.VertexExtent));
}

void OutputSlab::Clear(OpenCLContext& context, const std::vector<VolumeArray>& arrays,
  bool coverageBits, std::vector<cl::Event>& events)
{
  this->BitsUsed = coverageBits;
  if (coverageBits)
  {
    const std::uint64_t words = CountWords(this->NumberOfVoxels);
    Reserve(context, this->CoverageBits, words * sizeof(cl_uint));
    Fill(context, this->Queue, this->CoverageBits, ElementBytes::Of(cl_uint{ 0 }), words, events);
    return;
  }
  this->CoverageBits = cl::Buffer();
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    Fill(context, this->Queue, this->Arrays[i], GetBackground(arrays[i]),
      this->NumberOfVoxels * static_cast<std::uint64_t>(arrays[i].Components), events);
  }
  Fill(context, this->Queue, this->Coverage, ElementBytes::Of(cl_uchar{ 0 }), this->NumberOfVoxels,
    events);
}

void OutputSlab::ExpandCoverage(
  OpenCLContext& context, bool isUpdate, std::vector<cl::Event>& events)
{
  if (!isUpdate)
  {
    deformvolume::ExpandCoverage(
      context, this->Queue, this->CoverageBits, this->Coverage, this->NumberOfVoxels, events);
  }
  else if (this->NumberOfListedPatches > 0)
  {
    KernelParameters p = {};
    this->SetParameters(p);
    ExpandPatches(context, this->Queue, this->CoverageBits, this->Coverage, this->PatchList,
      this->NumberOfListedPatches, p, events);
  }
}

void OutputSlab::Complete(OpenCLContext& context, const std::vector<VolumeArray>& arrays,
  bool isUpdate, std::vector<cl::Event>& events)
{
  if (!this->BitsUsed)
  {
    return;
  }
  this->ExpandCoverage(context, isUpdate, events);
  for (std::size_t i = 0; i < arrays.size() && !isUpdate; ++i)
  {
    FillUncovered(context, this->Queue, this->Arrays[i], GetBackground(arrays[i]),
      this->NumberOfVoxels, static_cast<std::size_t>(arrays[i].Components), this->CoverageBits,
      events);
  }
  this->Queue.finish(); // the output is read in another queue
}

void OutputSlab::Settle(OpenCLContext& context, bool claimed, const KernelParameters& parameters,
  std::vector<cl::Event>& events)
{
  KernelParameters p = parameters;
  this->SetParameters(p);
  if (this->BitsUsed && !claimed)
  {
    this->ExpandCoverage(context, false, events);
  }
  this->Winners.Settle(context, claimed, this->Coverage, this->Counters.GetBuffer(), p, events);
}

std::uint64_t OutputSlab::CountCovered(WorkDevice& device, std::vector<cl::Event>& events)
{
  if (this->BitsUsed)
  {
    return this->ReadCounts(device, true, events).Covered;
  }
  OpenCLContext& context = device.GetContext();
  const cl_uint voxelsOfItem = GetCountedVoxels(context);
  const std::uint64_t items = (this->NumberOfVoxels + voxelsOfItem - 1) / voxelsOfItem;
  const cl::Buffer sums(context.GetContext(), CL_MEM_WRITE_ONLY, items * sizeof(cl_uint));
  const cl::Kernel kernel = MakeKernel(GetOutputProgram(context), "CountCovered", this->Coverage,
    cl_ulong{ this->NumberOfVoxels }, voxelsOfItem, sums);
  LaunchBusyItems(context, this->Queue, kernel, static_cast<std::size_t>(items), events);
  return ReadSum(this->Queue, sums, static_cast<std::size_t>(items));
}

std::uint64_t OutputSlab::CountCovered(
  OpenCLContext& context, const std::vector<std::uint32_t>& patches, std::vector<cl::Event>& events)
{
  if (patches.empty())
  {
    return 0;
  }
  this->SendPatches(context, patches);
  const cl::Buffer sums(context.GetContext(), CL_MEM_WRITE_ONLY, patches.size() * sizeof(cl_uint));
  KernelParameters p = {};
  this->SetParameters(p);
  CountCoveredInPatches(
    context, this->Queue, this->Coverage, this->PatchList, patches.size(), p, sums, events);
  return ReadSum(this->Queue, sums, patches.size());
}

SlabCounts OutputSlab::ReadCounts(WorkDevice& device, bool covered, std::vector<cl::Event>& events)
{
  const bool withBits = covered && this->BitsUsed;
  return this->Counters.Read(device, withBits ? this->CoverageBits : cl::Buffer(),
    withBits ? CountWords(this->NumberOfVoxels) : 0, events);
}

bool OutputSlab::FitsLanes() const
{
  // Positions in 1/256 voxel are exact in float up to 2^24. Relative positions fit 32 bits if the
  // output begins within 2^22 voxels: positions at rest lie within 2^21.
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
  parameters.MostLargeCells = static_cast<int>(this->LargeCells.GetCapacity());
  parameters.KeepsPatches = this->Winners.KeepsPatches() ? 1 : 0;
  parameters.IsPart = this->WholeExtent != this->SlabExtent ? 1 : 0;
}

std::uint64_t OutputSlab::GetOffset(const DeformRequest& request) const
{
  const std::uint64_t plane = static_cast<std::uint64_t>(GetSize(this->SlabExtent, 0)) *
    static_cast<std::uint64_t>(GetSize(this->SlabExtent, 1));
  return plane *
    static_cast<std::uint64_t>(std::int64_t{ this->SlabExtent[4] } - request.OutputExtent[4]);
}

void OutputSlab::Read(
  const cl::CommandQueue& queue, const DeformRequest& request, const Extent& part)
{
  const std::uint64_t offset = this->GetOffset(request);
  const auto read = [&](const cl::Buffer& buffer, std::size_t tupleSize, void* memory)
  {
    char* const first = static_cast<char*>(memory) + offset * tupleSize;
    if (part == this->SlabExtent || IsInPlace(buffer))
    {
      this->Reads.Add(BeginToRead(queue, buffer, this->NumberOfVoxels * tupleSize, first));
    }
    else if (GetNumberOfPoints(part) > 0)
    {
      this->Reads.Add(
        BeginToReadBox(queue, buffer, this->SlabExtent, part, tupleSize, first, this->SlabExtent));
    }
  };
  for (std::size_t i = 0; i < this->Arrays.size(); ++i)
  {
    read(this->Arrays[i], this->TupleSizes[i], request.Outputs[i]);
  }
  read(this->Coverage, 1, request.Coverage);
  queue.flush();
}

std::vector<std::shared_ptr<DeviceOutput>> OutputSlab::KeepOnDevice(const cl::CommandQueue& queue,
  const DeformRequest& request, const std::vector<VolumeArray>& arrays,
  const std::vector<Extent>& parts) const
{
  std::vector<std::shared_ptr<DeviceOutput>> outputs;
  const auto leave = [&](const cl::Buffer& buffer, std::size_t tupleSize, void* memory,
                       const ElementBytes& background)
  {
    const DeviceOutput::Internals::Voxels voxels{ this->SlabExtent, parts[outputs.size()],
      tupleSize };
    outputs.push_back(std::make_shared<DeviceOutput>(
      std::make_shared<DeviceOutput::Internals>(queue, buffer, voxels, memory, background)));
  };
  for (std::size_t i = 0; i < this->Arrays.size(); ++i)
  {
    leave(this->Arrays[i], this->TupleSizes[i], request.Outputs[i], GetBackground(arrays[i]));
  }
  leave(this->Coverage, 1, request.Coverage, ElementBytes::Of(cl_uchar{ 0 }));
  return outputs;
}

void OutputSlab::Finish()
{
  if (this->Queue())
  {
    clFinish(this->Queue()); // does not throw: this is also called after a failure
  }
  this->Reads.Drop();
  for (cl::Buffer& array : this->Arrays)
  {
    Release(array);
  }
  Release(this->Coverage);
}

std::uint64_t OutputSlab::GetMemory() const
{
  std::uint64_t bytes = deformvolume::GetMemory(this->Coverage) +
    deformvolume::GetMemory(this->CoverageBits) + this->Winners.GetMemory() +
    this->Counters.GetMemory();
  for (const cl::Buffer& array : this->Arrays)
  {
    bytes += deformvolume::GetMemory(array);
  }
  return bytes;
}

} // namespace deformvolume
