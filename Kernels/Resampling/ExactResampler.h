// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeExactResampler_h
#define DeformVolumeExactResampler_h

#include "ExactPasses.h"
#include "Launches.h"
#include "OutputSlab.h"
#include "PublishedPass.h"
#include "SlabResampler.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

class DeviceVolume;
class DisplacementSource;
class MemoryBudget;
class WorkDevice;

/// Resamples by the cells of the sampling mesh, each voxel written by one tetrahedron: in one pass,
/// and where tetrahedra overlap in more, which find the winners. The published method, too, where
/// the request asks for it.
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
  void FinishReading() override;
  void Finish() noexcept override;

  /// Whether MakeAgain can make some bricks of the last output, which was that of this request,
  /// anew: it was made by lanes, in one slab, and no winners were chosen.
  bool CanMakeAgain(const DeformRequest& request);
  /// Makes some bricks of the last output anew, where the memory of the request holds it as far as
  /// it is still wanted, in the target 0. Returns what was counted in all bricks.
  OutputSlab::Counts MakeAgain(const DeformRequest& request, const std::vector<cl_uint>& bricks);

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
  /// the voxels that several cells write.
  void ChooseWinners(
    const DeformRequest& request, OutputSlab& output, const Outcome& first, bool claimed);
  /// False where winners had to be chosen.
  bool MakeExact(
    const DeformRequest& request, OutputSlab& output, bool isFirst, DeformReport& report);
  void MakePublished(const DeformRequest& request, OutputSlab& output, DeformReport& report);

  WorkDevice& Device;
  MemoryBudget& Budget;
  DeviceVolume& Volume;
  DisplacementSource& Source;
  Launches Launched;
  ExactPasses Exact;
  PublishedPass Published;
  std::array<OutputSlab, 2> Targets;
  bool WasContested = false; // whether cells of the last output overlapped
  bool IsContested = false;  // and of this one, as far as is known
  bool IsPlain = false;      // whether it is one slab of one chunk, without winners
};

} // namespace deformvolume

#endif
