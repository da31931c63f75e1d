// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDisplacementBuffer_h
#define DeformVolumeDisplacementBuffer_h

#include "DisplacementBounds.h"
#include "PointRanges.h"
#include "PointSet.h"
#include "WorkDevice.h"

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace deformvolume
{

class BrickPoints;
class ChangeTracker;

/// Throws Error if a displacement is too large or not finite. displacements: three floats per
/// point. what: "node" or "point", for the message. changes: points to check; null: all.
void CheckDisplacements(
  const float* displacements, std::size_t count, const char* what, const PointRanges* changes);

/// Throws the Error of CheckDisplacements() for a point.
[[noreturn]] void ThrowBadDisplacement(const char* what, std::size_t point);

/// Displacements of points on the device, four floats each. Only the range of the points that have
/// changed is copied to the device, and the tracker is notified of these points.
class DisplacementBuffer
{
public:
  DisplacementBuffer(WorkDevice& device, ChangeTracker& tracker)
    : Device(device)
    , Tracker(tracker)
  {
  }

  /// Set the displacements. displacements: three floats per point, already checked. room: least
  /// number of points of the buffer, for meshes that had more nodes before. changes: points that
  /// may have changed since the last call; null: all. makePoints: returns the argument of
  /// ChangeTracker::SetPoints().
  void Set(const float* displacements, std::size_t count, std::size_t room,
    const PointRanges* changes, const std::function<BrickPoints()>& makePoints);

  /// Enlarges the buffer to at least `count` points. The displacements of new points are 0.
  void Grow(std::size_t count);

  /// Returns a buffer for `count` points, to be written by a kernel. The previous displacements may
  /// be lost. All points count as changed.
  const cl::Buffer& AllocateForKernel(std::size_t count);

  const cl::Buffer& Get() const { return this->Buffer; }
  /// Calls visit(displacements) with the displacements on the device, four floats per point.
  void WithDisplacements(const std::function<void(const float*)>& visit) const;
  /// Number of points for which the buffer has room.
  std::size_t GetNumberOfPoints() const;
  void Clear();

private:
  /// The arguments of Set().
  struct SetArguments
  {
    const float* Vectors;
    std::size_t Count;
    const PointRanges* Changes;
    const std::function<BrickPoints()>& MakePoints;
  };
  /// Writes the displacements to `sent` (the mapped buffer, or Copy), and notifies the tracker.
  /// Returns a range that contains all changed points.
  std::array<std::size_t, 2> Write(const SetArguments& arguments, float* sent);

  WorkDevice& Device;
  ChangeTracker& Tracker;
  cl::Buffer Buffer;
  // A copy of the buffer on the host, for devices with memory of their own. Empty if a kernel has
  // written the buffer.
  std::vector<float> Copy;
  PointSet Changed; // used within Write()
};

} // namespace deformvolume

#endif
