// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChainMailSolver_h
#define DeformVolumeChainMailSolver_h

#include "ActiveBlocks.h"
#include "ChainMailBlocks.h"
#include "ChainMailHandles.h"
#include "ChainMailSnapshot.h"
#include "ChainMailState.h"
#include "ChainMailTypes.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace deformvolume
{

/// Runs the steps of a ChainMailModel: chooses the blocks that kernels visit, and their order.
class ChainMailSolver
{
public:
  ChainMailSolver(ChainMailState& state, const ChainMailBlocks& blocks);

  /// Set the order of visits: 0 for the default order, other numbers for different random orders.
  void SetOrder(unsigned int order) { this->Active.SetOrder(order); }

  ChainMailReport Step(const ChainMailHandles& handles, const ChainMailRequest& request);

  /// Lets these blocks relax in the next steps.
  void Touch(const std::vector<std::uint32_t>& blocks);
  /// Sets all displacements to 0.
  void ResetDisplacements();
  /// Sets all displacements to 0 if any of them violates a limit in these blocks.
  void CheckDisplacements(const std::vector<std::uint32_t>& blocks);
  /// Sets all displacements to 0 if any of them violates a limit.
  void CheckDisplacements() { this->CheckDisplacements(this->Displaced); }

  /// Returns the current displacements. last: null, or a snapshot with which unchanged blocks are
  /// shared.
  std::shared_ptr<const ChainMailSnapshot> TakeSnapshot(const ChainMailSnapshot* last);
  /// Restores the displacements of a snapshot. The next step checks them.
  void Restore(const ChainMailSnapshot& snapshot);

private:
  ChainMailReport Advance(const ChainMailHandles& handles, const ChainMailRequest& request);
  void Resolve(const ChainMailHandles& handles, ChainMailReport& report);
  void ResolveInOrder(const ChainMailHandles& handles, ChainMailReport& report);
  /// Moves the handles of a step. Returns the shared numbers afterwards.
  SharedNumbers Move(
    const ChainMailHandles& handles, const std::vector<HandleTask>& tasks, ChainMailReport& report);
  void Propagate(ChainMailReport& report);
  void Relax(const ChainMailRequest& request, ChainMailReport& report);
  void SaveBlocks(const std::vector<std::uint32_t>& blocks);
  void MarkSaved(std::uint32_t block);
  void ForgetSaved();
  void Finish(ChainMailReport& report);
  void PublishChanges(const std::vector<std::uint32_t>& blocks);

  ChainMailState& State;
  ChainMailBlocks Blocks;
  ActiveBlocks Active;
  // The blocks saved in this step, those with displaced voxels, and those that still relax: as one
  // byte for each block, and as lists.
  std::vector<unsigned char> IsSaved, IsDisplaced, IsRecent;
  std::vector<std::uint32_t> Saved, Displaced, Recent;
  std::vector<std::int64_t> LastTouched; // for each block, the number of the step
  std::vector<std::uint32_t> PutBack;    // blocks that changed between steps
  std::int64_t NumberOfSteps = 0;
  bool HasMoved = false;
  bool WasReset = false;
  bool IsToCheck = false; // whether displacements may violate limits
};

} // namespace deformvolume

#endif
