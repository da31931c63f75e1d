// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeIncrementalOutput_h
#define DeformVolumeIncrementalOutput_h

#include "ChangeTracker.h"
#include "DeformRequest.h"
#include "Extent.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

namespace deformvolume
{

class DeviceVolume;
class DisplacementSource;
class ExactResampler;
class OutputMemory;
class WorkDevice;

/// The last output, and its incremental update after a change of the deformation or the masks.
class IncrementalOutput
{
public:
  IncrementalOutput(WorkDevice& device, DeviceVolume& volume);

  /// The tracker that must be notified of all changes of the displacements.
  ChangeTracker& GetTracker() { return this->Changes; }
  /// Notes that a mask of cells or of vertices changed in some boxes.
  void ChangeMask(const std::vector<Extent>& boxes, bool ofCells)
  {
    this->Changes.ChangeMask(boxes, ofCells);
  }
  /// Notes that the smooth cut changed near vertices in some boxes.
  void ChangeCut(const std::vector<Extent>& boxes);
  /// Discards the last output.
  void Invalidate() { this->Changes.Invalidate(); }

  /// Notes that the whole output of a request was made, and that the resampler can make parts of it
  /// again. Sets the revision in the report.
  void Start(const DeformRequest& request, const DisplacementSource& source, DeformReport& report);

  /// Makes the output of a request by updating the last one, and fills the report. Returns false if
  /// the whole output must be made.
  bool Update(const DeformRequest& request, const DisplacementSource& source,
    ExactResampler& resampler, DeformReport& report);

private:
  /// Whether the output stays on the device.
  bool StaysOnDevice(const DeformRequest& request) const;
  bool CanUpdate(const DeformRequest& request, ExactResampler& resampler);
  /// Like Update, but does not discard the last output after a failure.
  bool TryUpdate(const DeformRequest& request, const DisplacementSource& source,
    ExactResampler& resampler, DeformReport& report);
  /// Returns the part of the last output that memory with the output of revision `held` lacks.
  Extent GetMissing(std::uint64_t held) const;
  /// Leaves the updated output on the device.
  std::vector<std::shared_ptr<DeviceOutput>> KeepOnDevice(
    const DeformRequest& request, const OutputMemory& output) const;
  /// See ChangeTracker::IsChangeInterior.
  bool IsChangeInside() const;
  /// Passes the vertices of the current smooth cut to Changes, once the last output includes that
  /// cut.
  void UpdateCut();
  /// Copies the last output to the memory of the request.
  void CopyLastOutput(const DeformRequest& request) const;

  WorkDevice& Device;
  DeviceVolume& Volume;
  ChangeTracker Changes;
  bool CutIsKnown = true; // whether Changes has the vertices of the current cut only
  Resampling LastMethod = Resampling::Exact;
  Interpolation LastInterpolation = Interpolation::Linear;
  Extent LastWholeExtent = EmptyExtent;
  std::uint64_t LastCovered = 0;
  std::uint64_t Revision = 0; // of the last output
  // The revision before the last one, and the patches that differ between these two; 0: unknown.
  std::uint64_t RevisionBefore = 0;
  std::vector<std::uint32_t> LastPatches;
  // The changes of the last incremental updates, each from the revision before it.
  struct Change
  {
    std::uint64_t Before;
    Extent Changed;
  };
  std::deque<Change> LastChanges;
};

} // namespace deformvolume

#endif
