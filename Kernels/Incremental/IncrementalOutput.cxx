// SPDX-License-Identifier: BSD-3-Clause
#include "IncrementalOutput.h"

#include "DeviceVolume.h"
#include "DisplacementSource.h"
#include "ExactResampler.h"
#include "HostMemory.h"
#include "OutputPatches.h"
#include "OutputSlab.h"
#include "ParallelFor.h"
#include "Stopwatch.h"
#include "WorkDevice.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <optional>
#include <utility>

namespace deformvolume
{
namespace
{

// Revisions are unique in a process, so that an object that replaces another one does not repeat
// its revisions.
std::uint64_t MakeRevision()
{
  static std::atomic<std::uint64_t> last{ 0 };
  return ++last;
}

void CopyOnThreads(void* to, const void* from, std::uint64_t bytes)
{
  constexpr std::size_t step = std::size_t{ 1 } << 20;
  ParallelForParts(static_cast<std::size_t>(bytes), step,
    [&](std::size_t begin, std::size_t end)
    {
      std::memcpy(
        static_cast<char*>(to) + begin, static_cast<const char*>(from) + begin, end - begin);
    });
}

} // namespace

IncrementalOutput::IncrementalOutput(WorkDevice& device, DeviceVolume& volume)
  : Device(device)
  , Volume(volume)
{
}

void IncrementalOutput::Start(
  const DeformRequest& request, const DisplacementSource& source, DeformReport& report)
{
  this->Changes.Start(this->Volume.GetBricks(), this->Volume.GetVoxelGrid(), request.OutputExtent);
  this->UpdateCut();
  this->LastMethod = request.Method;
  this->LastInterpolation = request.Interpolation;
  this->LastWholeExtent = request.WholeOutputExtent;
  this->LastCovered = static_cast<std::uint64_t>(report.NumberOfCoveredVoxels);
  this->RevisionBefore = 0;
  this->LastChanges.clear();
  this->Revision = MakeRevision();
  report.Revision = this->Revision;
  if (source.IsWrittenInPart())
  {
    // Find all boxes now: the old positions of the points will be overwritten.
    const Stopwatch watch;
    if (!this->Changes.HasPoints())
    {
      this->Changes.SetPoints(source.MakeBrickPoints());
    }
    source.WithDisplacements([this](const Displacements& displacements, std::size_t)
      { this->Changes.FindAllBoxes(displacements); });
    report.ResamplingTime += watch.GetSeconds();
  }
}

void IncrementalOutput::ChangeCut(const std::vector<Extent>& boxes)
{
  if (boxes.empty())
  {
    return;
  }
  this->CutIsKnown = false;
  this->Changes.SetHalo(this->Volume.GetBricks().Halo);
  if (this->Changes.IsTracking())
  {
    this->Changes.AddCut(this->Volume.GetMasks().GetCut().GetList());
    this->Changes.ChangeMask(boxes, false);
  }
}

void IncrementalOutput::UpdateCut()
{
  if (!this->CutIsKnown)
  {
    this->Changes.SetCut(this->Volume.GetMasks().GetCut().GetList());
    this->CutIsKnown = true;
  }
}

bool IncrementalOutput::IsChangeInside() const
{
  const cl::Buffer& state = this->Volume.GetChunks().front().State;
  const Extent moved = this->Changes.GetMovedVertices();
  if (!state() || GetNumberOfPoints(moved) == 0)
  {
    return this->Changes.IsChangeInterior(nullptr, moved);
  }
  // The states are those of the last output: if a mask changed, the change is not inside.
  const std::array<int, 3>& size = this->Volume.GetBricks().Size;
  const Extent all{ { 0, size[0] - 1, 0, size[1] - 1, 0, size[2] - 1 } };
  const cl::CommandQueue& queue = this->Device.GetQueue();
  if (this->Device.GetDevice().IsProcessor)
  {
    const MappedBuffer<const unsigned char> mapped(queue, state, CL_MAP_READ);
    return this->Changes.IsChangeInterior(mapped.Get(), all);
  }
  std::vector<unsigned char> read(static_cast<std::size_t>(GetNumberOfPoints(moved)));
  BeginToReadBox(queue, state, all, moved, 1, read.data(), moved).Check();
  return this->Changes.IsChangeInterior(read.data(), moved);
}

bool IncrementalOutput::StaysOnDevice(const DeformRequest& request) const
{
  return request.MayStayOnDevice && !this->Device.GetDevice().IsProcessor;
}

bool IncrementalOutput::CanUpdate(const DeformRequest& request, ExactResampler& resampler)
{
  const bool hasLast = request.LastCoverage &&
    request.LastOutputs.size() == request.Outputs.size() &&
    !std::count(request.LastOutputs.begin(), request.LastOutputs.end(), nullptr);
  return request.Incremental && this->Changes.IsTracking() &&
    this->Changes.GetOutputExtent() == request.OutputExtent &&
    this->LastWholeExtent == request.WholeOutputExtent && this->LastMethod == request.Method &&
    this->LastInterpolation == request.Interpolation && (hasLast || this->StaysOnDevice(request)) &&
    resampler.HoldsLastOutput(request);
}

void IncrementalOutput::CopyLastOutput(const DeformRequest& request) const
{
  const std::vector<VolumeArray>& arrays = this->Volume.GetArrays().Get();
  if (request.OutputRevision != 0 && request.OutputRevision == this->RevisionBefore)
  {
    CopyPatches(request, arrays, this->LastPatches);
    return;
  }
  const auto voxels = static_cast<std::uint64_t>(GetNumberOfPoints(request.OutputExtent));
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    if (request.LastOutputs[i] != request.Outputs[i])
    {
      CopyOnThreads(request.Outputs[i], request.LastOutputs[i], voxels * GetTupleSize(arrays[i]));
    }
  }
  if (request.LastCoverage != request.Coverage)
  {
    CopyOnThreads(request.Coverage, request.LastCoverage, voxels);
  }
}

Extent IncrementalOutput::GetMissing(std::uint64_t held) const
{
  const auto first = std::find_if(this->LastChanges.begin(), this->LastChanges.end(),
    [=](const Change& change) { return change.Before == held; });
  if (first == this->LastChanges.end())
  {
    return this->Changes.GetOutputExtent();
  }
  Extent missing = EmptyExtent;
  for (auto change = first; change != this->LastChanges.end(); ++change)
  {
    if (GetNumberOfPoints(change->Changed) > 0)
    {
      Include(missing, change->Changed);
    }
  }
  return missing;
}

std::vector<std::shared_ptr<DeviceOutput>> IncrementalOutput::KeepOnDevice(
  const DeformRequest& request, const OutputMemory& output) const
{
  std::vector<Extent> parts;
  for (std::size_t i = 0; i <= request.Outputs.size(); ++i)
  {
    parts.push_back(this->GetMissing(request.HeldRevisions.empty() ? 0 : request.HeldRevisions[i]));
  }
  return output.KeepOnDevice(this->Device.GetReadQueue(), parts);
}

bool IncrementalOutput::Update(const DeformRequest& request, const DisplacementSource& source,
  ExactResampler& resampler, DeformReport& report)
{
  try
  {
    if (this->CanUpdate(request, resampler) && this->TryUpdate(request, source, resampler, report))
    {
      return true;
    }
  }
  catch (...)
  {
    this->Invalidate();
    throw;
  }
  this->Invalidate();
  return false;
}

bool IncrementalOutput::TryUpdate(const DeformRequest& request, const DisplacementSource& source,
  ExactResampler& resampler, DeformReport& report)
{
  const Stopwatch planning;
  if (!this->Changes.HasPoints())
  {
    this->Changes.SetPoints(source.MakeBrickPoints());
  }
  // The shortcut for interior changes compares numbers of writes. It fails if the last output chose
  // winners of overlaps.
  const bool hadWinners = resampler.HasWinners();
  const bool inside = !hadWinners && this->IsChangeInside();
  if (!inside && !this->Changes.HasPlanBoxes())
  {
    source.WithDisplacements([this](const Displacements& displacements, std::size_t count)
      { this->Changes.FindPlanBoxes(displacements, count); });
  }
  ChangeTracker::Plan plan;
  if (!this->Changes.PlanUpdate(inside, plan))
  {
    return false;
  }
  if (inside && !plan.Bricks.empty())
  {
    source.WithDisplacements([this](const Displacements& displacements, std::size_t)
      { this->Changes.FindChangedBoxes(displacements); });
  }
  // Also after an exception, nothing may write to the memory of the request any more.
  const SlabResampler::FinishGuard finish(resampler);
  const QueueGuard reads(this->Device.GetReadQueue());
  const bool stays = this->StaysOnDevice(request);
  const auto countCovered = [&]
  {
    return stays ? resampler.CountCovered(plan.Patches)
                 : CountCoveredInPatches(request, plan.Patches);
  };
  if (!stays)
  {
    this->CopyLastOutput(request);
  }
  const std::uint64_t before = countCovered();
  report.ResamplingTime += planning.GetSeconds();
  const std::optional<ExactResampler::UpdatedOutput> updated =
    resampler.UpdateOutput(request, plan.Bricks, plan.Patches);
  if (!updated)
  {
    return false;
  }
  const SlabCounts& counts = updated->Counts;
  const Stopwatch reading;
  const Extent changed = this->Changes.GetChangedExtent();
  if (!stays)
  {
    resampler.GetTarget(0).Read(this->Device.GetReadQueue(), changed);
    resampler.FinishReading();
  }
  report.TransferTime += reading.GetSeconds();
  const Stopwatch counting;
  const std::uint64_t covered = this->LastCovered - before + countCovered();
  report.ResamplingTime += counting.GetSeconds();
  const BoundaryCells& boundary = resampler.GetBoundary();
  const std::uint64_t byCells = covered - boundary.GetNumberOfCovered();
  if (!hadWinners && (counts.NeedWinners(byCells) || (inside && counts.Writes != byCells)))
  {
    return false;
  }
  constexpr std::size_t mostChanges = 16;
  this->LastChanges.push_back({ this->Revision, changed });
  if (this->LastChanges.size() > mostChanges)
  {
    this->LastChanges.pop_front();
  }
  if (stays)
  {
    report.DeviceOutputs = this->KeepOnDevice(request, resampler.GetTarget(0));
  }
  this->LastCovered = covered;
  report.ChangedExtent = changed;
  this->LastPatches = inside ? this->Changes.GetChangedPatches() : std::move(plan.Patches);
  this->RevisionBefore = std::exchange(this->Revision, MakeRevision());
  report.Revision = this->Revision;
  this->Changes.Finish();
  this->UpdateCut();
  report.NumberOfInvertedTetrahedra =
    static_cast<std::int64_t>(counts.Inverted) + boundary.GetCounts().Inverted;
  report.NumberOfOverstretchedCells =
    static_cast<std::int64_t>(counts.Overstretched) + boundary.GetCounts().Overstretched;
  report.Overlapping = updated->Overlapping;
  report.NumberOfCoveredVoxels = static_cast<std::int64_t>(covered);
  report.NumberOfResampledBricks = static_cast<std::int64_t>(plan.Bricks.size());
  return true;
}

} // namespace deformvolume
