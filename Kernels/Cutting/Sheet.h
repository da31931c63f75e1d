// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSheet_h
#define DeformVolumeSheet_h

#include "DeformVolumeExport.h"
#include "SnappedPoint.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A surface of triangles to cut with, or a closed one to carve with, in structured indices of the
/// volume. Points are rounded to 1/256 voxel. It may be open, fold, cross itself, and have
/// triangles of either orientation.
class DEFORMVOLUME_EXPORT Sheet
{
public:
  /// Three numbers of points.
  using Triangle = std::array<std::int64_t, 3>;

  Sheet() = default;
  /// points: continuous indices of the volume. Throws Error where a triangle has a point that is
  /// none, is not finite, or is more than 2^31 voxels away from index 0.
  Sheet(const std::vector<glm::dvec3>& points, const std::vector<Triangle>& triangles);

  /// The triangles after rounding, those without area included.
  const std::vector<SnappedTriangle>& GetTriangles() const { return this->Triangles; }
  /// The box of all triangles; empty where there are none.
  const SnappedBox& GetBox() const { return this->Box; }

  /// Whether each edge is one of an even number of triangles, points in one place being one: such
  /// a surface has an inside and an outside.
  bool IsClosed() const;

  /// The sheet with its triangles turned so that those which share an edge, two of them, are
  /// oriented alike, as far as that can be; one of each piece stays as it is.
  Sheet Orient() const;

  /// What the triangles are within a box: those with area, divided until none is longer than
  /// LongestTriangle on an axis. An edge is divided in the same place for all triangles that have
  /// it, so that no gaps arise; a point where an edge is divided lies at most half a step off it on
  /// each axis, and not off planes that hold the edge and are parallel to an axis plane or at 45
  /// degrees between two of them. Triangles outside the box may be missing.
  std::vector<SnappedTriangle> Divide(const SnappedBox& within) const;

  /// In steps: 512 voxels. Predicates are exact in 64 bits for triangles and tetrahedra of such
  /// sizes, see TriangleCrossing.
  static constexpr std::int64_t LongestTriangle = std::int64_t{ 1 } << 17;

private:
  std::vector<SnappedTriangle> Triangles;
  SnappedBox Box;
};

} // namespace deformvolume

#endif
