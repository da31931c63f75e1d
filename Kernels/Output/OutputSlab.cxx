// SPDX-License-Identifier: BSD-3-Clause
#include "OutputSlab.h"

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

Extent GetWholeOutput(const DeformRequest& request)
{
  return GetNumberOfPoints(request.WholeOutputExtent) > 0 ? request.WholeOutputExtent
                                                          : request.OutputExtent;
}

} // namespace

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
  OutputMemory::Bind(context, request, arrays, this->GetExtent());
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
    for (const Element& element : this->GetElements())
    {
      FillPatches(context, queue, element.Buffer, element.Background, element.GetComponents(),
        this->PatchList, part.Patches.size(), p, events);
    }
  }
  if (this->BitsUsed && !part.Patches.empty())
  {
    LaunchPatches(context, queue,
      MakeKernel(
        GetOutputProgram(context), "ClearPatchBits", this->CoverageBits, this->PatchList, p),
      part.Patches.size(), events);
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
  this->WholeExtent = GetWholeOutput(request);
  this->Winners.Start(queue, extent, voxelGrid);
  OutputMemory::Bind(context, request, arrays, extent);
  this->Counters.Start(context, queue, numberOfBricks, events);
  this->LargeCells.Start(context, queue, GetNumberOfCells(voxelGrid.VertexExtent));
}

void OutputSlab::Clear(OpenCLContext& context, bool coverageBits, std::vector<cl::Event>& events)
{
  this->BitsUsed = coverageBits;
  if (coverageBits)
  {
    const std::uint64_t words = CountWords(this->GetNumberOfVoxels());
    Reserve(context, this->CoverageBits, words * sizeof(cl_uint));
    Fill(context, this->Queue, this->CoverageBits, ElementBytes::Of(cl_uint{ 0 }), words, events);
    return;
  }
  this->CoverageBits = cl::Buffer();
  for (const Element& element : this->GetElements())
  {
    Fill(context, this->Queue, element.Buffer, element.Background,
      this->GetNumberOfVoxels() * element.GetComponents(), events);
  }
}

void OutputSlab::ExpandCoverage(
  OpenCLContext& context, bool isUpdate, std::vector<cl::Event>& events)
{
  if (!isUpdate)
  {
    LaunchSteps(context, this->Queue,
      MakeKernel(GetOutputProgram(context), "ExpandCoverage", this->CoverageBits,
        this->GetCoverage(), cl_ulong{ this->GetNumberOfVoxels() }),
      this->GetNumberOfVoxels(), DEFORMVOLUME_EXPANDED, events);
  }
  else if (this->NumberOfListedPatches > 0)
  {
    KernelParameters p = {};
    this->SetParameters(p);
    LaunchPatches(context, this->Queue,
      MakeKernel(GetOutputProgram(context), "ExpandPatches", this->CoverageBits,
        this->GetCoverage(), this->PatchList, p),
      this->NumberOfListedPatches, events);
  }
}

void OutputSlab::Complete(OpenCLContext& context, bool isUpdate, std::vector<cl::Event>& events)
{
  if (!this->BitsUsed)
  {
    return;
  }
  this->ExpandCoverage(context, isUpdate, events);
  const std::vector<Element>& elements = this->GetElements();
  for (std::size_t i = 0; i + 1 < elements.size() && !isUpdate; ++i)
  {
    FillUncovered(context, this->Queue, elements[i].Buffer, elements[i].Background,
      this->GetNumberOfVoxels(), elements[i].GetComponents(), this->CoverageBits, events);
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
  this->Winners.Settle(
    context, claimed, this->GetCoverage(), this->Counters.GetBuffer(), p, events);
}

std::uint64_t OutputSlab::CountCovered(WorkDevice& device, std::vector<cl::Event>& events)
{
  if (this->BitsUsed)
  {
    return this->ReadCounts(device, true, events).Covered;
  }
  OpenCLContext& context = device.GetContext();
  // Many if a work-item has a thread of its own, fewer if the device executes thousands at once.
  const cl_uint voxelsOfItem = context.GetDevice().HasVectors ? 4096 : 128;
  const std::uint64_t items = (this->GetNumberOfVoxels() + voxelsOfItem - 1) / voxelsOfItem;
  const cl::Buffer sums(context.GetContext(), CL_MEM_WRITE_ONLY, items * sizeof(cl_uint));
  const cl::Kernel kernel = MakeKernel(GetOutputProgram(context), "CountCovered",
    this->GetCoverage(), cl_ulong{ this->GetNumberOfVoxels() }, voxelsOfItem, sums);
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
  LaunchBusyItems(context, this->Queue,
    MakeKernel(GetOutputProgram(context), "CountCoveredInPatches", this->GetCoverage(),
      this->PatchList, static_cast<cl_uint>(patches.size()), sums, p),
    patches.size(), events);
  return ReadSum(this->Queue, sums, patches.size());
}

SlabCounts OutputSlab::ReadCounts(WorkDevice& device, bool covered, std::vector<cl::Event>& events)
{
  const bool withBits = covered && this->BitsUsed;
  return this->Counters.Read(device, withBits ? this->CoverageBits : cl::Buffer(),
    withBits ? CountWords(this->GetNumberOfVoxels()) : 0, events);
}

bool OutputSlab::FitsLanes() const
{
  // Positions in 1/256 voxel are exact in float up to 2^24. Relative positions fit 32 bits if the
  // output begins within 2^22 voxels: positions at rest lie within 2^21.
  constexpr int farthest = 1 << 22;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int first = this->GetExtent()[2 * axis];
    if (GetSize(this->GetExtent(), axis) > 32768 || first < -farthest || first > farthest)
    {
      return false;
    }
  }
  return this->GetNumberOfVoxels() <=
    static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max());
}

void OutputSlab::SetParameters(KernelParameters& parameters) const
{
  for (int axis = 0; axis < 3; ++axis)
  {
    parameters.OutputFirst[axis] = this->GetExtent()[2 * axis];
    parameters.OutputSize[axis] = static_cast<int>(GetSize(this->GetExtent(), axis));
    parameters.WholeFirst[axis] = this->WholeExtent[2 * axis] - this->GetExtent()[2 * axis];
    parameters.WholeEnd[axis] = this->WholeExtent[2 * axis + 1] + 1 - this->GetExtent()[2 * axis];
  }
  parameters.MostLargeCells = static_cast<int>(this->LargeCells.GetCapacity());
  parameters.KeepsPatches = this->Winners.KeepsPatches() ? 1 : 0;
  parameters.IsPart = this->WholeExtent != this->GetExtent() ? 1 : 0;
}

void OutputSlab::Finish()
{
  if (this->Queue())
  {
    clFinish(this->Queue()); // does not throw: this is also called after a failure
  }
  this->Release();
}

std::uint64_t OutputSlab::GetMemory() const
{
  return OutputMemory::GetMemory() + deformvolume::GetMemory(this->CoverageBits) +
    this->Winners.GetMemory() + this->Counters.GetMemory();
}

} // namespace deformvolume
