// SPDX-License-Identifier: BSD-3-Clause
#include "ChainMailSolver.h"

#include "ChainMailParameters.h"
#include "Error.h"

#include <algorithm>
#include <cmath>

namespace deformvolume
{
namespace
{

// The number of steps in which a block relaxes after it was touched.
constexpr std::int64_t RelaxingSteps = 30;

// Flags of the voxels of a handle. A source moves other voxels. Firm voxels do not yield to other
// handles.
constexpr std::int32_t Source = DEFORMVOLUME_ALL_SYSTEMS | DEFORMVOLUME_HELD;
constexpr std::int32_t FirmSource = Source | DEFORMVOLUME_FIXED;
constexpr std::int32_t Firm = DEFORMVOLUME_HELD | DEFORMVOLUME_FIXED;
// A handle is moved back at most once in each direction, and then tried a last time.
constexpr int MostAttempts = 3;

double ToVoxels(std::int64_t units)
{
  return static_cast<double>(units) / DEFORMVOLUME_CHAINMAIL_UNITS;
}

bool IsContradiction(const SharedNumbers& shared)
{
  return std::any_of(shared.begin(), shared.begin() + DEFORMVOLUME_CONFLICTS + 1,
    [](std::uint32_t number) { return number != 0; });
}

// Moves a handle back by the distance that voxels which do not yield would have to move. Returns
// false if these voxels would have to move in both directions on an axis.
bool MoveBack(HandleTask& task, const SharedNumbers& shared)
{
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const auto down = static_cast<std::int32_t>(shared[axis]);
    const auto up = static_cast<std::int32_t>(shared[axis + 3]);
    if (down > 0 && up > 0)
    {
      return false;
    }
    task.Target[axis] += down - up;
  }
  return true;
}

} // namespace

ChainMailSolver::ChainMailSolver(ChainMailState& state, const ChainMailBlocks& blocks)
  : State(state)
  , Blocks(blocks)
  , Active(blocks)
  , IsSaved(blocks.GetNumberOfBlocks())
  , IsDisplaced(blocks.GetNumberOfBlocks())
  , IsRecent(blocks.GetNumberOfBlocks())
  , LastTouched(blocks.GetNumberOfBlocks())
{
}

void ChainMailSolver::Touch(const std::vector<std::uint32_t>& blocks)
{
  for (const std::uint32_t block : blocks)
  {
    this->LastTouched[block] = this->NumberOfSteps;
    if (!this->IsRecent[block])
    {
      this->IsRecent[block] = 1;
      this->Recent.push_back(block);
    }
  }
}

void ChainMailSolver::ResetDisplacements()
{
  std::sort(this->Displaced.begin(), this->Displaced.end());
  this->State.ResetDisplacements(this->Displaced);
  this->PublishChanges(this->Displaced);
  std::fill(this->IsDisplaced.begin(), this->IsDisplaced.end(), static_cast<unsigned char>(0));
  std::fill(this->IsRecent.begin(), this->IsRecent.end(), static_cast<unsigned char>(0));
  this->Displaced.clear();
  this->Recent.clear();
  this->WasReset = true;
}

// Publishes changes of blocks between two steps. blocks: in ascending order.
void ChainMailSolver::PublishChanges(const std::vector<std::uint32_t>& blocks)
{
  if (this->State.HasOutput())
  {
    this->State.WriteOutput(blocks);
    const std::vector<Extent> changes = this->Blocks.Join(blocks);
    this->State.ReadOutput(changes);
    this->State.MarkChanges(changes);
  }
  this->PutBack.insert(this->PutBack.end(), blocks.begin(), blocks.end());
}

std::shared_ptr<const ChainMailSnapshot> ChainMailSolver::TakeSnapshot(
  const ChainMailSnapshot* last)
{
  using Block = ChainMailSnapshot::Block;
  auto snapshot = std::make_shared<ChainMailSnapshot>();
  snapshot->Voxels = this->Blocks.GetExtent();
  std::sort(this->Displaced.begin(), this->Displaced.end());
  std::vector<Block> values(this->Displaced.size());
  this->State.ReadBlocks(this->Displaced, values);
  std::size_t next = 0; // index in the last snapshot
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    const std::uint32_t block = this->Displaced[i];
    if (std::all_of(
          values[i].begin(), values[i].end(), [](std::int32_t value) { return value == 0; }))
    {
      continue;
    }
    while (last && next < last->Numbers.size() && last->Numbers[next] < block)
    {
      ++next;
    }
    const bool isKnown = last && last->Voxels == snapshot->Voxels && next < last->Numbers.size() &&
      last->Numbers[next] == block && *last->Blocks[next] == values[i];
    snapshot->Numbers.push_back(block);
    snapshot->Blocks.push_back(
      isKnown ? last->Blocks[next] : std::make_shared<const Block>(values[i]));
  }
  return snapshot;
}

void ChainMailSolver::Restore(const ChainMailSnapshot& snapshot)
{
  std::vector<std::uint32_t> blocks = this->Displaced;
  blocks.insert(blocks.end(), snapshot.Numbers.begin(), snapshot.Numbers.end());
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  this->State.ResetDisplacements(blocks);
  this->State.WriteBlocks(snapshot.Numbers, snapshot.Blocks);
  this->PublishChanges(blocks);
  std::fill(this->IsDisplaced.begin(), this->IsDisplaced.end(), static_cast<unsigned char>(0));
  std::fill(this->IsRecent.begin(), this->IsRecent.end(), static_cast<unsigned char>(0));
  this->Displaced = snapshot.Numbers;
  for (const std::uint32_t block : this->Displaced)
  {
    this->IsDisplaced[block] = 1;
  }
  this->Recent.clear();
  this->WasReset = false;
  this->IsToCheck = true;
}

void ChainMailSolver::CheckDisplacements(const std::vector<std::uint32_t>& blocks)
{
  if (this->Displaced.empty())
  {
    return;
  }
  this->State.Check(blocks);
  if (this->State.TakeShared()[DEFORMVOLUME_VIOLATION] > 0)
  {
    this->ResetDisplacements();
  }
}

void ChainMailSolver::MarkSaved(std::uint32_t block)
{
  if (!this->IsSaved[block])
  {
    this->IsSaved[block] = 1;
    this->Saved.push_back(block);
  }
}

void ChainMailSolver::SaveBlocks(const std::vector<std::uint32_t>& blocks)
{
  std::vector<std::uint32_t> list;
  std::copy_if(blocks.begin(), blocks.end(), std::back_inserter(list),
    [this](std::uint32_t block) { return !this->IsSaved[block]; });
  for (const std::uint32_t block : list)
  {
    this->MarkSaved(block);
  }
  this->State.Save(list);
}

void ChainMailSolver::ForgetSaved()
{
  for (const std::uint32_t block : this->Saved)
  {
    this->IsSaved[block] = 0;
  }
  this->Saved.clear();
}

void ChainMailSolver::Propagate(ChainMailReport& report)
{
  std::vector<BlockTask> tasks;
  std::vector<std::uint32_t> results;
  for (int color = 0; !this->Active.IsEmpty(); color = 1 - color)
  {
    tasks.clear();
    for (const ActiveBlock& active : this->Active.Take(color, ChainMailState::AtOnce))
    {
      const std::uint32_t saved = this->IsSaved[active.Block] ? 1U << DEFORMVOLUME_SYSTEMS : 0U;
      tasks.push_back({ active.Block, active.Systems | saved });
    }
    if (tasks.empty())
    {
      continue;
    }
    this->State.Propagate(tasks, results);
    ++report.NumberOfSweeps;
    for (std::size_t i = 0; i < tasks.size(); ++i)
    {
      const std::uint32_t systems =
        results[i] >> DEFORMVOLUME_CHANGED_SYSTEMS & DEFORMVOLUME_ALL_SYSTEMS;
      if (results[i] & DEFORMVOLUME_SAVED)
      {
        this->MarkSaved(tasks[i].Block);
      }
      this->Active.AddNeighbors(tasks[i].Block, results[i], systems);
    }
    this->State.Continue();
  }
}

SharedNumbers ChainMailSolver::Move(
  const ChainMailHandles& handles, const std::vector<HandleTask>& tasks, ChainMailReport& report)
{
  std::vector<std::uint32_t> counts;
  this->State.Hold(handles.GetVoxels(), tasks, counts);
  for (std::size_t i = 0; i < tasks.size(); ++i)
  {
    if (tasks[i].Flags)
    {
      report.Handles[i].NumberOfVoxels = counts[i];
    }
  }
  const std::uint32_t needed = this->State.TakeShared()[DEFORMVOLUME_NEEDED];
  if (!needed)
  {
    return {};
  }
  this->HasMoved = true;
  for (const std::uint32_t block : handles.GetBlocks())
  {
    constexpr std::uint32_t allFaces = 63;
    this->Active.Add(block, needed);
    this->Active.AddNeighbors(block, allFaces, needed);
  }
  this->Propagate(report);
  return this->State.TakeShared();
}

void ChainMailSolver::ResolveInOrder(const ChainMailHandles& handles, ChainMailReport& report)
{
  const std::size_t count = handles.GetNumberOfHandles();
  std::vector<HandleTask> accepted(count, HandleTask{ { { 0, 0, 0 } }, 0 });
  bool isRestored = true; // whether only accepted handles have moved voxels in this step
  for (std::size_t i = 0; i < count; ++i)
  {
    if (!handles.HasVoxels(i))
    {
      continue; // all of its voxels belong to earlier handles
    }
    HandleTask task{ handles.GetTarget(i), Source };
    for (int attempt = 0; task.Flags; ++attempt)
    {
      if (!isRestored)
      {
        this->State.Restore(this->Saved);
        std::vector<HandleTask> again = accepted;
        for (HandleTask& other : again)
        {
          other.Flags = other.Flags ? FirmSource : 0;
        }
        this->Move(handles, again, report);
        this->State.ClearFlags(this->Saved);
      }
      std::vector<HandleTask> tasks = accepted;
      tasks[i] = task;
      const SharedNumbers shared = this->Move(handles, tasks, report);
      isRestored = !IsContradiction(shared);
      if (isRestored)
      {
        break;
      }
      if (!MoveBack(task, shared) || attempt + 1 == MostAttempts)
      {
        task.Flags = 0;
        report.Handles[i].IsHeld = false;
      }
    }
    accepted[i] = { task.Target, task.Flags ? Firm : 0 };
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      report.Handles[i].Reduction[axis] = report.Handles[i].IsHeld
        ? ToVoxels(std::int64_t{ handles.GetTarget(i)[axis] } - task.Target[axis])
        : 0.0;
    }
    if (isRestored && count > 1)
    {
      this->State.ClearFlags(this->Saved);
    }
  }
  if (!isRestored)
  {
    this->State.Restore(this->Saved);
    for (HandleTask& task : accepted)
    {
      task.Flags = task.Flags ? FirmSource : 0;
    }
  }
  if (!isRestored || count > 1)
  {
    this->Move(handles, accepted, report); // held voxels must not relax
  }
}

void ChainMailSolver::Resolve(const ChainMailHandles& handles, ChainMailReport& report)
{
  const std::size_t count = handles.GetNumberOfHandles();
  if (count == 0)
  {
    return;
  }
  this->SaveBlocks(handles.GetBlocks());
  if (count > 1)
  {
    std::vector<HandleTask> tasks;
    for (std::size_t i = 0; i < count; ++i)
    {
      tasks.push_back({ handles.GetTarget(i), FirmSource });
    }
    if (!IsContradiction(this->Move(handles, tasks, report)))
    {
      return;
    }
    this->State.Restore(this->Saved);
  }
  this->ResolveInOrder(handles, report);
}

void ChainMailSolver::Relax(const ChainMailRequest& request, ChainMailReport& report)
{
  std::vector<std::uint32_t> recent;
  for (const std::uint32_t block : this->Recent)
  {
    this->IsRecent[block] = this->NumberOfSteps - this->LastTouched[block] < RelaxingSteps;
    if (this->IsRecent[block])
    {
      recent.push_back(block);
    }
  }
  this->Recent = recent;
  if (request.RelaxationSweeps <= 0 || recent.empty())
  {
    return;
  }
  std::sort(recent.begin(), recent.end());
  this->SaveBlocks(recent);
  const auto threshold = static_cast<int>(
    std::ceil(std::min(request.PlasticityThreshold, 8192.0) * DEFORMVOLUME_CHAINMAIL_UNITS));
  std::vector<std::uint32_t> results(recent.size());
  for (int sweep = 0; sweep < request.RelaxationSweeps; ++sweep)
  {
    std::fill(results.begin(), results.end(), 0U);
    this->State.Relax(recent, static_cast<float>(request.Elasticity), threshold, results);
    ++report.NumberOfSweeps;
    if (std::find(results.begin(), results.end(), 1U) == results.end())
    {
      break;
    }
  }
}

void ChainMailSolver::Finish(ChainMailReport& report)
{
  std::sort(this->Saved.begin(), this->Saved.end());
  std::vector<std::uint32_t> moved;
  this->State.Finish(this->Saved, moved);
  report.LargestViolation = ToVoxels(this->State.TakeShared()[DEFORMVOLUME_VIOLATION]);
  std::vector<std::uint32_t> changed = this->PutBack;
  for (std::size_t i = 0; i < this->Saved.size(); ++i)
  {
    const std::uint32_t block = this->Saved[i];
    if (moved[i] > 0)
    {
      report.NumberOfMovedVoxels += moved[i];
      changed.push_back(block);
      if (!this->IsDisplaced[block])
      {
        this->IsDisplaced[block] = 1;
        this->Displaced.push_back(block);
      }
    }
  }
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  report.Changes = this->Blocks.Join(changed);
  for (const Extent& extent : report.Changes)
  {
    Include(report.ChangedExtent, extent);
  }
  // Blocks that were saved but did not move must be read, too: the output holds their saved state
  // until then.
  this->State.ReadOutput(this->Blocks.Join(this->Saved));
  this->State.MarkChanges(report.Changes);
  report.WasReset = this->WasReset;
  this->WasReset = false;
  this->PutBack.clear();
  this->ForgetSaved();
}

ChainMailReport ChainMailSolver::Advance(
  const ChainMailHandles& handles, const ChainMailRequest& request)
{
  ChainMailReport report;
  report.Handles.resize(handles.GetNumberOfHandles());
  ++this->NumberOfSteps;
  this->HasMoved = false;
  this->Resolve(handles, report);
  for (ChainMailHandleReport& handle : report.Handles)
  {
    handle.IsHeld = handle.IsHeld && handle.NumberOfVoxels > 0;
  }
  if (this->HasMoved)
  {
    this->Touch(this->Saved);
  }
  this->Relax(request, report);
  this->State.SetProgress(nullptr); // Finish is short and must not be aborted
  this->Finish(report);
  return report;
}

ChainMailReport ChainMailSolver::Step(
  const ChainMailHandles& handles, const ChainMailRequest& request)
{
  if (this->IsToCheck)
  {
    this->CheckDisplacements();
    this->IsToCheck = false;
  }
  this->State.SetProgress(request.Progress);
  try
  {
    return this->Advance(handles, request);
  }
  catch (const Aborted&)
  {
    this->State.SetProgress(nullptr);
    this->Active.Clear();
    constexpr bool isEnd = true;
    this->State.Restore(this->Saved, isEnd);
    this->State.ReadOutput(this->Blocks.Join(this->Saved));
    this->State.TakeShared();
    this->ForgetSaved();
    throw;
  }
}

} // namespace deformvolume
