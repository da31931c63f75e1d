// SPDX-License-Identifier: BSD-3-Clause
// Products of integer vectors; GLM has these for floating-point vectors only.
#ifndef DeformVolumeExactVectors_h
#define DeformVolumeExactVectors_h

#include "SnappedPoint.h"

#include <cstdint>

namespace deformvolume
{

inline SnappedPoint Cross(const SnappedPoint& u, const SnappedPoint& v)
{
  return SnappedPoint(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
}

inline std::int64_t Dot(const SnappedPoint& u, const SnappedPoint& v)
{
  return u.x * v.x + u.y * v.y + u.z * v.z;
}

inline int GetSign(std::int64_t value)
{
  return (value > 0 ? 1 : 0) - (value < 0 ? 1 : 0);
}

/// Returns the sign of the scalar product of a vector with (e, e^2, e^3) for infinitesimal e > 0:
/// the sign of its first component that is not 0. Returns 0 for the zero vector.
inline int FindSign(const SnappedPoint& v)
{
  return GetSign(v.x != 0 ? v.x : v.y != 0 ? v.y : v.z);
}

} // namespace deformvolume

#endif
