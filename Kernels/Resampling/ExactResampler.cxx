// SPDX-License-Identifier: BSD-3-Clause
#include "ExactResampler.h"

#include "DeviceVolume.h"
#include "DisplacementSource.h"
#include "MemoryBudget.h"

namespace deformvolume
{

ExactResampler::ExactResampler(
  WorkDevice& device, MemoryBudget& budget, DeviceVolume& volume, DisplacementSource& source)
  : Budget(budget)
  , Volume(volume)
  , Source(source)
  , Launcher(device)
  , Exact(device, volume, source, this->Launcher)
  , Boundary(device, budget, volume, source, this->Launcher)
{
}

void ExactResampler::Begin(const DeformRequest&, const SlabPlan& plan, DeformReport&)
{
  if (!plan.Overlapped)
  {
    this->Targets[1] = OutputSlab();
  }
  this->WasContested = this->IsContested;
  this->IsContested = false;
  this->Last = plan.Slabs.size() == 1 && this->Volume.GetChunks().size() == 1 ? LastOutput::Plain
                                                                              : LastOutput::Unknown;
}

void ExactResampler::Make(
  const DeformRequest& request, const SlabPlan& plan, std::size_t slab, DeformReport& report)
{
  OutputSlab& target = this->Targets[plan.GetTarget(slab)];
  this->Launcher.Expect((plan.Slabs.size() - slab) *
    (this->Exact.GetNumberOfLaunches() + this->Boundary.GetNumberOfLaunches()));
  target.Bind(this->Launcher, plan.Slabs[slab], request, this->Volume.GetArrays().Get(),
    this->Volume.GetVoxelGrid(), this->Volume.GetBricks().GetNumberOfBricks());
  target.Clear(
    this->Launcher, this->Exact.ChooseKernel(request, target) == ResamplingKernel::Columns);
  this->MakeExact(request, target, slab == 0, report);
}

void ExactResampler::RunPass(const DeformRequest& request, const OutputSlab& output, int pass,
  bool hasLargeCells, const std::vector<cl_uint>* bricks)
{
  this->Exact.Run(request, output, pass, bricks);
  if (hasLargeCells)
  {
    this->Exact.RunLargeCells(request, output, pass);
  }
}

ExactResampler::Outcome ExactResampler::RunFirstPass(
  const DeformRequest& request, OutputSlab& output, int pass)
{
  Outcome outcome;
  const auto count = [&]
  {
    outcome.Counts = output.ReadCounts(this->Launcher, true);
    outcome.Covered =
      output.HasCoverageBits() ? outcome.Counts.Covered : output.CountCovered(this->Launcher);
  };
  this->Launcher.AddMapping(this->Source.PrepareMapping());
  this->RunPass(request, output, pass, false);
  count();
  outcome.HasLargeCells = outcome.Counts.HasLarge;
  if (outcome.HasLargeCells)
  {
    this->Exact.RunLargeCells(request, output, pass);
    count();
  }
  return outcome;
}

bool ExactResampler::IsFolded(const SlabCounts& counts) const
{
  const auto tetrahedra =
    5 * static_cast<std::uint64_t>(GetNumberOfCells(this->Volume.GetVoxelGrid().VertexExtent));
  return counts.Inverted > 0 && counts.Inverted < tetrahedra / 2;
}

void ExactResampler::MakeExact(
  const DeformRequest& request, OutputSlab& output, bool isFirst, DeformReport& report)
{
  // If the last output was folded, this output probably is folded as well: use the claiming pass at
  // once.
  const bool expected =
    this->WasContested && this->Budget.HasRoomFor(output.GetWinners().GetMissingMemory());
  if (expected)
  {
    output.GetWinners().Prepare(this->Launcher);
  }
  const Outcome first = this->RunFirstPass(
    request, output, expected ? DEFORMVOLUME_PASS_OWNERS : DEFORMVOLUME_PASS_DIRECT);
  if (isFirst) // each slab counts all tetrahedra
  {
    report.NumberOfInvertedTetrahedra = static_cast<std::int64_t>(first.Counts.Inverted);
    report.NumberOfOverstretchedCells = static_cast<std::int64_t>(first.Counts.Overstretched);
  }
  const bool settled = !first.Counts.NeedWinners(first.Covered);
  std::uint64_t covered = first.Covered;
  if (!settled)
  {
    report.Overlapping |= first.Counts.Writes > first.Covered;
    report.NumberOfHiddenSamples +=
      static_cast<std::int64_t>(std::max(first.Counts.Writes, first.Covered) - first.Covered);
    const bool claimed = this->ChooseWinners(request, output, first, expected);
    if (this->Last != LastOutput::Unknown)
    {
      this->Last =
        claimed && first.Counts.Overstretched == 0 ? LastOutput::Won : LastOutput::Unknown;
    }
    covered = output.CountCovered(this->Launcher);
  }
  this->Boundary.Run(request, output);
  if (request.FoldCounts && first.Counts.Writes > first.Covered)
  {
    this->CountFolds(request, output);
  }
  output.FillUncoveredVoxels(this->Launcher, false);
  report.NumberOfCoveredVoxels +=
    static_cast<std::int64_t>(covered + this->Boundary.GetNumberOfCovered());
  if (isFirst)
  {
    report.NumberOfInvertedTetrahedra += this->Boundary.GetCounts().Inverted;
    report.NumberOfOverstretchedCells += this->Boundary.GetCounts().Overstretched;
  }
  this->IsContested = report.Overlapping || this->IsFolded(first.Counts);
}

bool ExactResampler::ChooseWinners(
  const DeformRequest& request, OutputSlab& output, const Outcome& first, bool claimed)
{
  const bool contested = first.Counts.Writes > first.Covered;
  this->Launcher.ExpectMore((contested && !claimed ? 3 : 2) * this->Exact.GetNumberOfLaunches());
  if (!claimed)
  {
    this->Budget.CheckRoomFor(output.GetWinners().GetMissingMemory(),
      "on the device for a deformation that folds the volume over");
    output.GetWinners().Prepare(this->Launcher);
    if (contested)
    {
      output.GetCounters().Clear(this->Launcher);
      this->RunPass(request, output, DEFORMVOLUME_PASS_OWNERS, first.HasLargeCells);
      claimed = true;
    }
  }
  output.FindUnsettledVoxels(
    this->Launcher, claimed, this->Volume.GetParameters(this->Volume.GetChunks().front()));
  this->WriteWinners(request, output, first.HasLargeCells, claimed);
  return claimed;
}

void ExactResampler::WriteWinners(
  const DeformRequest& request, OutputSlab& output, bool hasLargeCells, bool claimed)
{
  const bool someBricks = this->Volume.GetChunks().size() == 1;
  const auto runPass = [&](int pass, bool all, int counter)
  {
    std::vector<cl_uint> bricks;
    if (!all)
    {
      bricks = output.GetCounters().FindBricks(this->Launcher, counter);
    }
    this->RunPass(request, output, pass, hasLargeCells, all ? nullptr : &bricks);
  };
  runPass(DEFORMVOLUME_PASS_MARK, !someBricks || !claimed, DEFORMVOLUME_COUNT_TOUCHED);
  runPass(DEFORMVOLUME_PASS_WINNER, !someBricks, DEFORMVOLUME_COUNT_CANDIDATES);
}

void ExactResampler::CountFolds(const DeformRequest& request, OutputSlab& output)
{
  output.GetWinners().PrepareCounts(this->Launcher);
  this->RunPass(request, output, DEFORMVOLUME_PASS_COUNT, true);
  const std::vector<std::uint32_t> counts = output.GetWinners().ReadCounts(this->Launcher);
  const Extent& slab = output.GetExtent();
  const Extent& all = request.OutputExtent;
  const auto width = static_cast<std::size_t>(GetSize(slab, 0));
  std::size_t row = 0;
  for (int z = slab[4]; z <= slab[5]; ++z)
  {
    for (int y = slab[2]; y <= slab[3]; ++y, ++row)
    {
      const std::int64_t index =
        ((z - all[4]) * GetSize(all, 1) + y - all[2]) * GetSize(all, 0) + slab[0] - all[0];
      std::copy_n(counts.data() + row * width, width, request.FoldCounts + index);
    }
  }
  this->Last = LastOutput::Unknown;
}

std::uint64_t ExactResampler::CountCovered(const std::vector<std::uint32_t>& patches)
{
  return this->Targets[0].CountCovered(this->Launcher, patches);
}

void ExactResampler::Finish() noexcept
{
  for (OutputSlab& target : this->Targets)
  {
    target.Finish();
  }
}

bool ExactResampler::HoldsLastOutput(const DeformRequest& request)
{
  return this->CanUpdateOutput() &&
    this->Targets[0].HoldsLastOutput(this->Launcher.GetContext(), request);
}

std::optional<ExactResampler::UpdatedOutput> ExactResampler::UpdateOutput(
  const DeformRequest& request, const std::vector<cl_uint>& bricks,
  const std::vector<std::uint32_t>& patches)
{
  OutputSlab& output = this->Targets[0];
  const bool won = this->HasWinners();
  const int pass = won ? DEFORMVOLUME_PASS_OWNERS : DEFORMVOLUME_PASS_DIRECT;
  const cl::Buffer list = bricks.empty() ? cl::Buffer() : this->Exact.SendBricks(bricks);
  output.PrepareUpdate(
    this->Launcher, request, this->Volume.GetArrays().Get(), { bricks, list, patches, won });
  this->Launcher.AddMapping(this->Source.PrepareMapping(&bricks));
  this->RunPass(request, output, pass, false, &bricks);
  UpdatedOutput updated;
  updated.Counts = output.ReadCounts(this->Launcher, false);
  const bool hasLargeCells = updated.Counts.HasLarge;
  if (hasLargeCells)
  {
    this->Exact.RunLargeCells(request, output, pass);
    updated.Counts = output.ReadCounts(this->Launcher, false);
  }
  const auto complete = [&]
  {
    if (!patches.empty())
    {
      this->Boundary.Run(request, output, &patches);
    }
    output.FillUncoveredVoxels(this->Launcher, true);
    this->Launcher.GetQueue().finish(); // the output is read in another queue
  };
  if (!won)
  {
    complete();
    return updated;
  }
  if (!bricks.empty())
  {
    output.FindUnsettledVoxels(
      this->Launcher, true, this->Volume.GetParameters(this->Volume.GetChunks().front()));
  }
  updated.Overlapping = output.GetWinners().HasContested(this->Launcher);
  if (updated.Counts.Overstretched > 0 ||
    !(updated.Overlapping || updated.Counts.Inverted > 0 || updated.Counts.MissingWhereAssumed))
  {
    return std::nullopt;
  }
  if (!bricks.empty())
  {
    this->WriteWinners(request, output, hasLargeCells, true);
  }
  complete();
  return updated;
}

std::uint64_t ExactResampler::GetMemory() const
{
  return this->Exact.GetMemory() + this->Boundary.GetMemory() + this->Targets[0].GetMemory() +
    this->Targets[1].GetMemory();
}

} // namespace deformvolume
