// SPDX-License-Identifier: BSD-3-Clause
#include "OutputSlab.h"

#include "KernelLauncher.h"
#include "KernelMaking.h"
#include "OutputFilling.h"
#include "OutputPatches.h"
#include "ResamplingProgram.h"
#include "SlabSizes.h"

#include <algorithm>
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

void OutputSlab::PrepareUpdate(KernelLauncher& launcher, const DeformRequest& request,
  const std::vector<VolumeArray>& arrays, const PartToUpdate& part)
{
  this->Finish();
  this->Queue = launcher.GetQueue();
  this->WholeExtent = GetWholeOutput(request);
  const bool onHost = GetOutputBytesPerVoxel(launcher.GetContext(), arrays, request) == 0;
  if (onHost)
  {
    // Clear patches on the host, before buffers use the memory.
    ClearPatches(request, arrays, part.Patches);
  }
  OutputMemory::Bind(launcher.GetContext(), request, arrays, this->GetExtent());
  const bool withWinners = part.WithWinners && !part.Bricks.empty();
  this->NumberOfListedPatches = 0;
  if (!onHost || withWinners || this->BitsUsed)
  {
    this->SendPatches(launcher, part.Patches);
  }
  KernelParameters p = {};
  this->SetParameters(p);
  if (!part.Patches.empty() && !onHost)
  {
    for (const Element& element : this->GetElements())
    {
      FillPatches(launcher, element.Buffer, element.Background, element.GetComponents(),
        this->PatchList, part.Patches.size(), p);
    }
  }
  if (this->BitsUsed && !part.Patches.empty())
  {
    LaunchPatches(launcher,
      MakeKernel(GetOutputProgram(launcher.GetContext()), "ClearPatchBits", this->CoverageBits,
        this->PatchList, p),
      part.Patches.size());
  }
  if (withWinners)
  {
    this->Winners.PrepareUpdate(launcher, part.Patches, this->PatchList, p);
  }
  if (!part.Bricks.empty())
  {
    this->Counters.ClearSections(launcher, part.Bricks.size(), part.BrickList, part.WithWinners);
  }
}

void OutputSlab::SendPatches(KernelLauncher& launcher, const std::vector<std::uint32_t>& patches)
{
  if (!patches.empty())
  {
    const std::uint64_t bytes = patches.size() * sizeof(cl_uint);
    Reserve(launcher.GetContext(), this->PatchList, bytes);
    this->Queue.enqueueWriteBuffer(this->PatchList, CL_TRUE, 0, bytes, patches.data());
    this->NumberOfListedPatches = patches.size();
  }
}

void OutputSlab::Bind(KernelLauncher& launcher, const Extent& extent, const DeformRequest& request,
  const std::vector<VolumeArray>& arrays, const VoxelGrid& voxelGrid, std::size_t numberOfBricks)
{
  this->FinishReading();
  this->Finish();
  this->Queue = launcher.GetQueue();
  this->WholeExtent = GetWholeOutput(request);
  this->Winners.Start(extent, voxelGrid);
  OutputMemory::Bind(launcher.GetContext(), request, arrays, extent);
  this->Counters.Start(launcher, numberOfBricks);
  this->LargeCells.Start(
    launcher.GetContext(), launcher.GetQueue(), GetNumberOfCells(voxelGrid.VertexExtent));
}

void OutputSlab::Clear(KernelLauncher& launcher, bool coverageBits)
{
  this->BitsUsed = coverageBits;
  if (coverageBits)
  {
    const std::uint64_t words = CountWords(this->GetNumberOfVoxels());
    Reserve(launcher.GetContext(), this->CoverageBits, words * sizeof(cl_uint));
    Fill(launcher, this->CoverageBits, ElementBytes::Of(cl_uint{ 0 }), words);
    return;
  }
  this->CoverageBits = cl::Buffer();
  for (const Element& element : this->GetElements())
  {
    Fill(launcher, element.Buffer, element.Background,
      this->GetNumberOfVoxels() * element.GetComponents());
  }
}

void OutputSlab::ExpandCoverage(KernelLauncher& launcher, bool isUpdate)
{
  if (!isUpdate)
  {
    LaunchSteps(launcher,
      MakeKernel(GetOutputProgram(launcher.GetContext()), "ExpandCoverage", this->CoverageBits,
        this->GetCoverage(), cl_ulong{ this->GetNumberOfVoxels() }),
      this->GetNumberOfVoxels(), DEFORMVOLUME_EXPANDED);
  }
  else if (this->NumberOfListedPatches > 0)
  {
    KernelParameters p = {};
    this->SetParameters(p);
    LaunchPatches(launcher,
      MakeKernel(GetOutputProgram(launcher.GetContext()), "ExpandPatches", this->CoverageBits,
        this->GetCoverage(), this->PatchList, p),
      this->NumberOfListedPatches);
  }
}

void OutputSlab::FillUncoveredVoxels(KernelLauncher& launcher, bool isUpdate)
{
  if (!this->BitsUsed)
  {
    return;
  }
  this->ExpandCoverage(launcher, isUpdate);
  const std::vector<Element>& elements = this->GetElements();
  for (std::size_t i = 0; i + 1 < elements.size() && !isUpdate; ++i)
  {
    FillUncovered(launcher, elements[i].Buffer, elements[i].Background, this->GetNumberOfVoxels(),
      elements[i].GetComponents(), this->CoverageBits);
  }
  this->Queue.finish(); // the output is read in another queue
}

void OutputSlab::FindUnsettledVoxels(
  KernelLauncher& launcher, bool claimed, const KernelParameters& parameters)
{
  KernelParameters p = parameters;
  this->SetParameters(p);
  if (this->BitsUsed && !claimed)
  {
    this->ExpandCoverage(launcher, false);
  }
  this->Winners.FindUnsettledVoxels(
    launcher, claimed, this->GetCoverage(), this->Counters.GetBuffer(), p);
}

std::uint64_t OutputSlab::CountCovered(KernelLauncher& launcher)
{
  if (this->BitsUsed)
  {
    return this->ReadCounts(launcher, true).Covered;
  }
  OpenCLContext& context = launcher.GetContext();
  // Many if a work-item has a thread of its own, fewer if the device executes thousands at once.
  const cl_uint voxelsOfItem = context.GetDevice().HasVectors ? 4096 : 128;
  const std::uint64_t items = (this->GetNumberOfVoxels() + voxelsOfItem - 1) / voxelsOfItem;
  const cl::Buffer sums(context.GetContext(), CL_MEM_WRITE_ONLY, items * sizeof(cl_uint));
  const cl::Kernel kernel = MakeKernel(GetOutputProgram(context), "CountCovered",
    this->GetCoverage(), cl_ulong{ this->GetNumberOfVoxels() }, voxelsOfItem, sums);
  LaunchHeavyItems(launcher, kernel, static_cast<std::size_t>(items));
  return ReadSum(this->Queue, sums, static_cast<std::size_t>(items));
}

std::uint64_t OutputSlab::CountCovered(
  KernelLauncher& launcher, const std::vector<std::uint32_t>& patches)
{
  if (patches.empty())
  {
    return 0;
  }
  this->SendPatches(launcher, patches);
  const cl::Buffer sums(
    launcher.GetContext().GetContext(), CL_MEM_WRITE_ONLY, patches.size() * sizeof(cl_uint));
  KernelParameters p = {};
  this->SetParameters(p);
  LaunchHeavyItems(launcher,
    MakeKernel(GetOutputProgram(launcher.GetContext()), "CountCoveredInPatches",
      this->GetCoverage(), this->PatchList, static_cast<cl_uint>(patches.size()), sums, p),
    patches.size());
  return ReadSum(this->Queue, sums, patches.size());
}

SlabCounts OutputSlab::ReadCounts(KernelLauncher& launcher, bool covered)
{
  const bool withBits = covered && this->BitsUsed;
  return this->Counters.Read(launcher, withBits ? this->CoverageBits : cl::Buffer(),
    withBits ? CountWords(this->GetNumberOfVoxels()) : 0);
}

bool OutputSlab::FitsLanes() const
{
  // Positions in 1/256 voxel are exact in float up to 2^24. Relative positions fit 32 bits if the
  // output begins within 2^22 voxels: positions at rest lie within 2^21. The whole extent decides,
  // so that values do not depend on how the output is divided.
  constexpr int farthest = 1 << 22;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int first = this->WholeExtent[2 * axis];
    if (GetSize(this->WholeExtent, axis) > 32768 || first < -farthest || first > farthest)
    {
      return false;
    }
  }
  return true;
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
