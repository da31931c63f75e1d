// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSnappedPoint_h
#define DeformVolumeSnappedPoint_h

#include "IndexBounds.h"

#include <glm/ext/vector_int3_sized.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <cstdint>

namespace deformvolume
{

/// The number of steps per voxel. Cuts are computed with integers: positions are rounded to 1/256
/// voxel.
constexpr std::int64_t StepsPerVoxel = 256;

/// A position in steps of 1/256 voxel, in structured indices of the volume.
using SnappedPoint = glm::i64vec3;
/// The corners of a triangle.
using SnappedTriangle = std::array<SnappedPoint, 3>;

/// Returns the snapped point nearest to a continuous index, which must be finite.
inline SnappedPoint Snap(const glm::dvec3& index)
{
  constexpr auto steps = static_cast<double>(StepsPerVoxel);
  return SnappedPoint(
    std::llround(index.x * steps), std::llround(index.y * steps), std::llround(index.z * steps));
}

/// Returns a snapped point as a continuous index.
inline glm::dvec3 GetIndex(const SnappedPoint& point)
{
  return glm::dvec3(point) / static_cast<double>(StepsPerVoxel);
}

/// A box of snapped points.
using SnappedBox = BoundingBox<SnappedPoint>;

} // namespace deformvolume

#endif
