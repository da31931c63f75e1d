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

/// A triangle surface to cut with, or a closed one to carve with, in structured indices of the
/// volume. Points are rounded to 1/256 voxel. The surface may be open, folded and
/// self-intersecting, and its triangles may have any orientation.
class DEFORMVOLUME_EXPORT Sheet
{
public:
  /// The indices of three points.
  using Triangle = std::array<std::int64_t, 3>;

  Sheet() = default;
  /// points: continuous indices of the volume. Throws an Error if a triangle refers to a point that
  /// does not exist, is not finite, or is more than 2^31 voxels away from index 0.
  Sheet(const std::vector<glm::dvec3>& points, const std::vector<Triangle>& triangles);

  /// Returns the rounded triangles, including those without area.
  const std::vector<SnappedTriangle>& GetTriangles() const { return this->Triangles; }
  /// Returns the bounding box of all triangles; empty if there are none.
  const SnappedBox& GetBox() const { return this->Box; }

  /// Whether each edge belongs to an even number of triangles; points with equal positions count as
  /// one. Such a surface has an inside and an outside.
  bool IsClosed() const;

  /// Returns the sheet with consistent orientation, as far as that is possible, across edges with
  /// two triangles. One triangle of each connected component keeps its orientation.
  Sheet Orient() const;

  /// Returns the triangles with area, divided until none is longer than LongestTriangle on an axis.
  /// All triangles at an edge divide it at the same point, so that there are no gaps. This point is
  /// at most half a step off the edge on each axis. If the edge lies in a plane that is parallel to
  /// two axes, or in one on which the sum or the difference of two coordinates is constant, the
  /// point lies in this plane as well. Triangles outside the box `within` may be missing.
  std::vector<SnappedTriangle> Divide(const SnappedBox& within) const;

  /// The largest extent of a divided triangle, in steps: 512 voxels. Predicates are exact in 64
  /// bits for triangles and tetrahedra of this size (TriangleCrossing).
  static constexpr std::int64_t LongestTriangle = std::int64_t{ 1 } << 17;

private:
  std::vector<SnappedTriangle> Triangles;
  SnappedBox Box;
};

} // namespace deformvolume

#endif
