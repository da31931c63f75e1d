// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeIncrementalOutput_h
#define DeformVolumeIncrementalOutput_h

#include "DeformRequest.h"
#include "Extent.h"
#include "IncrementalUpdate.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

namespace deformvolume
{

class DeviceVolume;
class DisplacementSource;
class ExactResampler;
class WorkDevice;

/// The last output, as far as it can be brought up to date where only some of what it was made of
/// changes, in place of making it anew.
class IncrementalOutput
{
public:
  IncrementalOutput(WorkDevice& device, DeviceVolume& volume);

  /// What has to be told of all changes of the displacements.
  DisplacementObserver& GetObserver() { return this->Changes; }
  /// A mask of the volume has changed, that of cells or that of vertices, in some boxes.
  void ChangeMask(const std::vector<Extent>& boxes, bool ofCells)
  {
    this->Changes.ChangeMask(boxes, ofCells);
  }
  /// The smooth cut is another one round vertices in some boxes.
  void ChangeCut(const std::vector<Extent>& boxes);
  /// The last output is of no use any more.
  void Forget() { this->Changes.Forget(); }

  /// The output of a request was made, wholly, of what is set now; the resampler can make bricks of
  /// it anew. Adds its revision to the report.
  void Start(const DeformRequest& request, const DisplacementSource& source, DeformReport& report);

  /// Makes the output of a request of the last one, and adds what was done to the report. False
  /// where the whole output has to be made.
  bool Update(const DeformRequest& request, const DisplacementSource& source,
    ExactResampler& resampler, DeformReport& report);

private:
  /// Whether the output is left on the device.
  bool StaysOnDevice(const DeformRequest& request) const;
  bool CanUpdate(const DeformRequest& request, ExactResampler& resampler);
  /// The same as Update, but that after a failure it is not forgotten that there is a last output.
  bool TryUpdate(const DeformRequest& request, const DisplacementSource& source,
    ExactResampler& resampler, DeformReport& report);
  /// What has to be copied to memory that holds the output of a revision, for it to hold the last
  /// one.
  Extent GetMissing(std::uint64_t held) const;
  /// The last output where it is left on the device, in an update of a part.
  std::vector<std::shared_ptr<DeviceOutput>> Leave(
    const DeformRequest& request, ExactResampler& resampler) const;
  /// See IncrementalUpdate::IsInside.
  bool IsChangeInside() const;
  /// Finds out where the smooth cut passes, once the last output is that with it.
  void FindCut();
  /// Makes the request's memory that of the last output.
  void CopyLastOutput(const DeformRequest& request) const;

  WorkDevice& Device;
  DeviceVolume& Volume;
  IncrementalUpdate Changes;
  bool CutIsKnown = true; // where it passes, and nowhere else
  Resampling LastMethod = Resampling::Exact;
  Interpolation LastInterpolation = Interpolation::Linear;
  Extent LastWholeExtent{ { 0, -1, 0, -1, 0, -1 } };
  std::uint64_t LastCovered = 0;
  std::uint64_t Revision = 0; // of the last output
  // Of the one before it, and the patches that are different in that; 0: that is not known.
  std::uint64_t RevisionBefore = 0;
  std::vector<std::uint32_t> LastPatches;
  // What has changed in the last updates of parts: from the revision before each to its own.
  struct Change
  {
    std::uint64_t Before;
    Extent Changed;
  };
  std::deque<Change> LastChanges;
};

} // namespace deformvolume

#endif
