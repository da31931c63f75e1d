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
class DisplacementObserver;

/// Throws an Error where a displacement, of three floats each, is not finite or too large. what:
/// what has it, in the Error. changes: those to look at, null: all.
void CheckDisplacements(
  const float* displacements, std::size_t count, const char* what, const PointRanges* changes);

/// Throws that Error.
[[noreturn]] void ThrowBadDisplacement(const char* what, std::size_t point);

/// Displacements of points on the device, four floats each. Only those that change are written, or
/// sent together with some between them, and the observer is told which.
class DisplacementBuffer
{
public:
  DisplacementBuffer(WorkDevice& device, DisplacementObserver& observer)
    : Device(device)
    , Observer(observer)
  {
  }

  /// displacements: three floats a point, checked. room: the buffer has room for at least so many
  /// points (meshes that had more nodes). changes: those that may have changed since the last call;
  /// null: all. makePoints: makes what the observer wants to know
  /// (DisplacementObserver::SetPoints).
  void Send(const float* displacements, std::size_t count, std::size_t room,
    const PointRanges* changes, const std::function<BrickPoints()>& makePoints);

  /// Makes room for so many points; those that are new have no displacement yet.
  void Reserve(std::size_t count);

  /// Makes room for so many points that a kernel writes; what was there may be lost. All points
  /// count as changed.
  const cl::Buffer& Place(std::size_t count);

  const cl::Buffer& Get() const { return this->Buffer; }
  /// Calls a function with the displacements as the device has them.
  void Visit(const std::function<void(const float*)>& visit) const;
  /// That there is room for.
  std::size_t GetNumberOfPoints() const;
  void Clear();

private:
  /// Displacements that are sent.
  struct News
  {
    const float* Vectors;
    std::size_t Count;
    const PointRanges* Changes;
    const std::function<BrickPoints()>& MakePoints;
  };
  /// Brings up to date what the device has, as the host sees it, and tells the observer. Returns
  /// the first point that has changed and one past the last, or more points.
  std::array<std::size_t, 2> Write(const News& news, float* sent);

  WorkDevice& Device;
  DisplacementObserver& Observer;
  cl::Buffer Buffer;
  // What the device has, where the host cannot look into that; empty where a kernel has written it.
  std::vector<float> Copy;
  PointSet Changed; // while they are sent
};

} // namespace deformvolume

#endif
