// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldPoints_h
#define DeformVolumeWorldPoints_h

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace deformvolume
{

/// The input of WorldDeformer::DeformPoints(), and the memory that it writes.
struct PointsRequest
{
  std::size_t Count = 0;
  /// Three numbers per point, in world coordinates.
  const double* Points = nullptr;
  /// Whether the points were rounded to single precision; see MeshPointMap::SetPointsAreFloats().
  bool AreFloats = false;
  /// Whether the points lie in the deformed volume and are moved back to rest.
  bool IsInverse = false;
  /// Memory for three numbers per point: its new position. May be that of Points.
  double* Moved = nullptr;
  /// Memory for one byte per point: 0 for points outside the deformation, which do not move,
  /// otherwise 1.
  signed char* Valid = nullptr;
  /// Called with the completed fraction, only in the thread that called DeformPoints(). If it
  /// returns false, DeformPoints() throws Aborted.
  std::function<bool(double)> Progress;
};

struct PointsReport
{
  std::int64_t NumberOfOutsidePoints = 0;
  /// All warnings, separated by spaces; "" if there are none.
  std::string Warnings;
};

} // namespace deformvolume

#endif
