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

/// The steps of a ChainMailModel: which blocks the kernels visit, and in which order.
class ChainMailSolver
{
public:
  ChainMailSolver(ChainMailState& state, const ChainMailBlocks& blocks);

  /// Blocks are visited in another order for each number but 0.
  void SetOrder(unsigned int order) { this->Active.SetOrder(order); }

  ChainMailReport Step(const ChainMailHandles& handles, const ChainMailRequest& request);

  /// These blocks relax in the next steps.
  void Touch(const std::vector<std::uint32_t>& blocks);
  /// Puts all displacements to 0.
  void PutToRest();
  /// Does so if they violate a limit somewhere in these blocks, or in all.
  void CheckDisplacements(const std::vector<std::uint32_t>& blocks);
  void CheckDisplacements() { this->CheckDisplacements(this->Displaced); }

  /// The displacements as they are, and as they are in another snapshot, or null, where that is so.
  std::shared_ptr<const ChainMailSnapshot> TakeSnapshot(const ChainMailSnapshot* last);
  /// Takes them back. The next step checks them.
  void Restore(const ChainMailSnapshot& snapshot);

private:
  ChainMailReport Advance(const ChainMailHandles& handles, const ChainMailRequest& request);
  void Resolve(const ChainMailHandles& handles, ChainMailReport& report);
  void ResolveInOrder(const ChainMailHandles& handles, ChainMailReport& report);
  /// Moves the handles of a step. Returns what the blocks share afterwards.
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
  std::vector<unsigned char> IsSaved, IsDisplaced, IsRecent; // of each block
  std::vector<std::uint32_t> Saved, Displaced, Recent;
  std::vector<std::int64_t> LastTouched; // of each block, the step
  std::vector<std::uint32_t> PutBack;    // changed since the last step
  std::int64_t NumberOfSteps = 0;
  bool HasMoved = false;
  bool WasReset = false;
  bool IsToCheck = false; // whether displacements may violate a limit
};

} // namespace deformvolume

#endif
