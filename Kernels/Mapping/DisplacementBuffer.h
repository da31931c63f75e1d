// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDisplacementBuffer_h
#define DeformVolumeDisplacementBuffer_h

#include "DisplacementBounds.h"
#include "PointSet.h"
#include "Tetrahedron.h"
#include "WorkDevice.h"

#include <cstddef>
#include <cstdint>
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

/// Displacements of points on the device, four floats each. On a processor only those that change
/// are written, and the observer is told which.
class DisplacementBuffer
{
public:
  DisplacementBuffer(WorkDevice& device, DisplacementObserver& observer)
    : Device(device)
    , Observer(observer)
  {
  }

  /// What the device calls each point; empty: as it comes.
  using Numbers = std::vector<std::int32_t>;
  /// displacements: three floats a point, checked. changes: those that may have changed since the
  /// last call; null: all. makePoints: makes what the observer wants to know
  /// (DisplacementObserver::SetPoints).
  void Send(const float* displacements, std::size_t count, const Numbers& numbers,
    const PointRanges* changes, const std::function<BrickPoints()>& makePoints);

  /// Makes room for points of so many numbers; those that are new have no displacement yet.
  void Reserve(std::size_t count);

  /// Makes room for points of so many numbers that a kernel writes; what was there may be lost. All
  /// points count as changed.
  const cl::Buffer& Place(std::size_t count);

  const cl::Buffer& Get() const { return this->Buffer; }
  /// That there is room for.
  std::size_t GetNumberOfPoints() const;
  void Clear() { this->Buffer = cl::Buffer(); }

private:
  void SendAll(const float* displacements, std::size_t count, const Numbers& numbers);

  WorkDevice& Device;
  DisplacementObserver& Observer;
  cl::Buffer Buffer;
  PointSet Changed; // while they are sent
};

} // namespace deformvolume

#endif
