// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeExactResampler_h
#define DeformVolumeExactResampler_h

#include "BoundaryCells.h"
#include "ExactPasses.h"
#include "Launches.h"
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

/// Resamples by the cells of the sampling mesh, each voxel written by one tetrahedron: in one pass,
/// and where tetrahedra overlap in more, which find the winners.
class ExactResampler : public SlabResampler
{
public:
  ExactResampler(
    WorkDevice& device, MemoryBudget& budget, DeviceVolume& volume, DisplacementSource& source);

  /// Of a new deformation nothing was launched yet.
  void Start() { this->Launched.Start(); }
  /// Adds the times of what was launched since.
  void AddTimes(DeformReport& report) { this->Launched.AddTimes(report); }

  void Begin(const DeformRequest& request, const SlabPlan& plan, DeformReport& report) override;
  void Make(const DeformRequest& request, const SlabPlan& plan, std::size_t slab,
    DeformReport& report) override;
  void Read(const DeformRequest& request, std::size_t target) override;
  std::vector<std::shared_ptr<DeviceOutput>> Leave(
    const DeformRequest& request, std::size_t target) override;
  void FinishReading() override;
  void Finish() noexcept override;

  /// Whether the last output was made in one slab of one chunk, so that MakeAgain can make bricks
  /// of it anew.
  bool CanMakeAgain() const { return this->Last != LastOutput::Unknown; }
  /// Whether the last output, of a request for the same extent and by the same method, is at hand.
  bool HoldsLastOutput(const DeformRequest& request);
  /// Whether winners were chosen in the last output.
  bool HasWinners() const { return this->Last == LastOutput::Won; }
  /// What came of MakeAgain.
  struct Again
  {
    OutputSlab::Counts Counts; // of all bricks
    bool Overlapping = false;  // only where winners were chosen
  };
  /// Makes some bricks of the last output anew, in the target 0. The memory of the request holds
  /// the last output. Some of its patches are cleared before, in that memory or on the device.
  /// Chooses winners where they were chosen in the last output. Nothing where a whole output is
  /// needed, as there are none any more.
  std::optional<Again> MakeAgain(const DeformRequest& request, const std::vector<cl_uint>& bricks,
    const std::vector<std::uint32_t>& patches);
  /// The covered voxels of some patches of the last output, counted on the device.
  std::uint64_t CountCovered(const std::vector<std::uint32_t>& patches);
  /// The same as Leave(), where of each array, and of the coverage, a part has to be copied when it
  /// is read.
  std::vector<std::shared_ptr<DeviceOutput>> LeaveParts(
    const DeformRequest& request, const std::vector<Extent>& parts);
  /// Begins to copy a part of that to the memory of the request, as Read() does.
  void ReadPart(const DeformRequest& request, const Extent& part);

  /// What it does where the boundary of the deformation mesh passes through the volume.
  BoundaryCells& GetBoundary() { return this->Boundary; }
  const BoundaryCells& GetBoundary() const { return this->Boundary; }

  /// Bytes on the device.
  std::uint64_t GetMemory() const;

private:
  /// What a pass is followed by.
  struct Outcome
  {
    OutputSlab::Counts Counts;
    std::uint64_t Covered = 0;
    bool HasLargeCells = false;
  };
  Outcome RunFirstPass(const DeformRequest& request, OutputSlab& output, int pass);
  void RunPass(const DeformRequest& request, const OutputSlab& output, int pass, bool hasLargeCells,
    const std::vector<cl_uint>* bricks = nullptr);
  /// The passes that find winners and write what these have won. claimed: the first pass has found
  /// the voxels that several cells write. Returns whether that is known in the end.
  bool ChooseWinners(
    const DeformRequest& request, OutputSlab& output, const Outcome& first, bool claimed);
  /// The last two of these: in all bricks, or in those that may have something to win. claimed:
  /// whether it is known what cells hold beside what they own.
  void WriteWinners(
    const DeformRequest& request, OutputSlab& output, bool hasLargeCells, bool claimed);
  /// Counts the tetrahedra that hold each voxel of a slab, which is done and has room for winners.
  /// These are lost.
  void CountFolds(const DeformRequest& request, OutputSlab& output);
  /// Whether some tetrahedra are inverted, but not most of them, as they are in a mirror image.
  bool IsFolded(const OutputSlab::Counts& counts) const;
  void MakeExact(
    const DeformRequest& request, OutputSlab& output, bool isFirst, DeformReport& report);

  WorkDevice& Device;
  MemoryBudget& Budget;
  DeviceVolume& Volume;
  DisplacementSource& Source;
  Launches Launched;
  ExactPasses Exact;
  BoundaryCells Boundary;
  std::array<OutputSlab, 2> Targets;
  bool WasContested = false; // whether cells of the last output overlapped, or were folded
  bool IsContested = false;  // and of this one, as far as is known
  /// What is known of it.
  enum class LastOutput
  {
    Unknown,
    Plain, // one slab of one chunk, without winners
    Won    // the same, and what wins each voxel, or has it alone
  };
  LastOutput Last = LastOutput::Unknown;
};

} // namespace deformvolume

#endif
