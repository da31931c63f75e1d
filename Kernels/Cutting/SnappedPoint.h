// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSnappedPoint_h
#define DeformVolumeSnappedPoint_h

#include <glm/common.hpp>
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

/// A closed box; empty until a point is added.
struct SnappedBox
{
  /// The lowest coordinate on each axis.
  SnappedPoint Min{ 1 };
  /// The highest coordinate on each axis.
  SnappedPoint Max{ -1 };

  /// Whether nothing was added.
  bool IsEmpty() const { return this->Min.x > this->Max.x; }
  /// Extends the box to a point.
  void Add(const SnappedPoint& point)
  {
    const bool isEmpty = this->IsEmpty();
    this->Min = isEmpty ? point : glm::min(this->Min, point);
    this->Max = isEmpty ? point : glm::max(this->Max, point);
  }
  /// Extends the box to another box.
  void Add(const SnappedBox& other)
  {
    if (!other.IsEmpty())
    {
      this->Add(other.Min);
      this->Add(other.Max);
    }
  }
  /// Whether two boxes overlap; false if one is empty.
  bool Overlaps(const SnappedBox& other) const
  {
    return !this->IsEmpty() && !other.IsEmpty() && this->Min.x <= other.Max.x &&
      other.Min.x <= this->Max.x && this->Min.y <= other.Max.y && other.Min.y <= this->Max.y &&
      this->Min.z <= other.Max.z && other.Min.z <= this->Max.z;
  }
  /// Returns the length of the longest edge.
  std::int64_t GetLength() const
  {
    const SnappedPoint size = this->Max - this->Min;
    return glm::max(size.x, glm::max(size.y, size.z));
  }
};

/// Returns the box of the corners of a triangle.
inline SnappedBox GetBox(const SnappedTriangle& triangle)
{
  SnappedBox box;
  for (const SnappedPoint& point : triangle)
  {
    box.Add(point);
  }
  return box;
}

} // namespace deformvolume

#endif
