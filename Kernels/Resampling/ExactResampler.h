// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeExactResampler_h
#define DeformVolumeExactResampler_h

#include "BoundaryCells.h"
#include "ExactPasses.h"
#include "KernelLauncher.h"
#include "OutputSlab.h"
#include "SlabResampler.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace deformvolume
{

class DeviceVolume;
class DisplacementSource;
class MemoryBudget;
class WorkDevice;

/// Resamples by the cells of the sampling mesh; one tetrahedron writes each voxel. Needs one pass,
/// and more passes to find the winners if tetrahedra overlap.
class ExactResampler : public SlabResampler
{
public:
  ExactResampler(
    WorkDevice& device, MemoryBudget& budget, DeviceVolume& volume, DisplacementSource& source);

  /// Resets the launches for a new deformation.
  void Start() { this->Launcher.Start(); }
  /// Adds the times of all launches since Start().
  void AddTimes(DeformReport& report) { this->Launcher.AddTimes(report); }

  void Begin(const DeformRequest& request, const SlabPlan& plan, DeformReport& report) override;
  void Make(const DeformRequest& request, const SlabPlan& plan, std::size_t slab,
    DeformReport& report) override;
  OutputMemory& GetTarget(std::size_t target) override { return this->Targets[target]; }
  void Finish() noexcept override;

  /// Whether the last output was made in one slab from one chunk, so that UpdateOutput() can update
  /// parts of it.
  bool CanUpdateOutput() const { return this->Last != LastOutput::Unknown; }
  /// Whether the last output, of a request for the same extent and by the same method, is still
  /// available.
  bool HoldsLastOutput(const DeformRequest& request);
  /// Whether the last output chose winners.
  bool HasWinners() const { return this->Last == LastOutput::Won; }
  /// The result of UpdateOutput().
  struct UpdatedOutput
  {
    SlabCounts Counts;        // over all bricks
    bool Overlapping = false; // only set if winners were chosen
  };
  /// Resamples some bricks of the last output, in target 0. The memory of the request must hold
  /// the last output. First clears some patches of the output. Chooses winners if the last output
  /// chose them. Returns nothing if there are no winners any more, so that the whole output must be
  /// made.
  std::optional<UpdatedOutput> UpdateOutput(const DeformRequest& request,
    const std::vector<cl_uint>& bricks, const std::vector<std::uint32_t>& patches);
  /// Counts the covered voxels of some patches of the last output, on the device.
  std::uint64_t CountCovered(const std::vector<std::uint32_t>& patches);
  /// Returns the resampling at the boundary of the deformation mesh inside the volume.
  BoundaryCells& GetBoundary() { return this->Boundary; }
  const BoundaryCells& GetBoundary() const { return this->Boundary; }

  /// Returns the memory on the device, in bytes.
  std::uint64_t GetMemory() const;

private:
  /// The result of the first pass.
  struct Outcome
  {
    SlabCounts Counts;
    std::uint64_t Covered = 0;
    bool HasLargeCells = false;
  };
  Outcome RunFirstPass(const DeformRequest& request, OutputSlab& output, int pass);
  void RunPass(const DeformRequest& request, const OutputSlab& output, int pass, bool hasLargeCells,
    const std::vector<cl_uint>* bricks = nullptr);
  /// Runs the passes that find winners and write their samples. claimed: whether the first pass was
  /// the claiming one. Returns whether the claims are known in the end.
  bool ChooseWinners(
    const DeformRequest& request, OutputSlab& output, const Outcome& first, bool claimed);
  /// Runs the last two of these passes: over all bricks, or over the bricks with possible winners.
  /// claimed: whether the samples that cells hold without owning them are known.
  void WriteWinners(
    const DeformRequest& request, OutputSlab& output, bool hasLargeCells, bool claimed);
  /// Counts the tetrahedra that hold each voxel of a finished slab, in the memory of the winners.
  /// The winners are lost.
  void CountFolds(const DeformRequest& request, OutputSlab& output);
  /// Whether some tetrahedra are inverted. False if most of them are, because a mirror image is not
  /// folded.
  bool IsFolded(const SlabCounts& counts) const;
  void MakeExact(
    const DeformRequest& request, OutputSlab& output, bool isFirst, DeformReport& report);

  MemoryBudget& Budget;
  DeviceVolume& Volume;
  DisplacementSource& Source;
  KernelLauncher Launcher;
  ExactPasses Exact;
  BoundaryCells Boundary;
  std::array<OutputSlab, 2> Targets;
  bool WasContested = false; // whether cells of the last output overlapped or were folded
  bool IsContested = false;  // the same for the current output
  /// The kind of the last output.
  enum class LastOutput
  {
    Unknown,
    Plain, // one slab of one chunk, without winners
    Won    // the same, with winners
  };
  LastOutput Last = LastOutput::Unknown;
};

} // namespace deformvolume

#endif
