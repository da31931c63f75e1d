// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeImageGeometry_h
#define DeformVolumeImageGeometry_h

#include "DeformVolumeExport.h"
#include "Extent.h"
#include "VoxelGrid.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <string>

namespace deformvolume
{

/// Where the points of an image lie. The transform goes between world coordinates and
/// continuous structured indices: index (0, 0, 0) is at Origin, whether the extent holds it or
/// not.
struct DEFORMVOLUME_EXPORT ImageGeometry
{
  /// Structured indices of the points.
  Extent PointExtent{ { 0, -1, 0, -1, 0, -1 } };
  /// World coordinates of the index (0, 0, 0).
  glm::dvec3 Origin{ 0.0 };
  /// The distance of neighbouring points on each axis, in world units.
  glm::dvec3 Spacing{ 1.0 };
  /// The axes in the world, as columns.
  glm::dmat3 Direction{ 1.0 };

  /// Takes structured indices to world coordinates.
  glm::dmat4 GetIndexToWorld() const;
  /// Takes world coordinates to continuous structured indices.
  glm::dmat4 GetWorldToIndex() const;

  /// Whether extent, origin, spacing and direction are equal.
  bool operator==(const ImageGeometry& other) const;
  /// Whether one of them differs.
  bool operator!=(const ImageGeometry& other) const { return !(*this == other); }
};

/// A direction matrix from its nine elements, row by row.
DEFORMVOLUME_EXPORT glm::dmat3 MakeDirection(const double* rows);

/// Whether the points of an extent lie at the same places in the world, to a thousandth of the
/// distance between them. The second geometry must have a transform that can be inverted.
DEFORMVOLUME_EXPORT bool AreSamePositions(
  const ImageGeometry& first, const ImageGeometry& second, const Extent& extent);

/// What takes indices of an image to indices of another one. Rounding errors are dropped: two
/// images whose axes are parallel have a diagonal matrix, and grids that lie over each other whole
/// numbers.
DEFORMVOLUME_EXPORT OutputMap GetOutputMap(const ImageGeometry& image, const ImageGeometry& output);

/// The world positions of the points, x varying fastest, by axes: room for a float a point each.
DEFORMVOLUME_EXPORT void ComputeWorldPositions(
  const ImageGeometry& image, const std::array<float*, 3>& positions);

/// Origin, spacing and direction, in words for an error.
DEFORMVOLUME_EXPORT std::string DescribeTransform(const ImageGeometry& geometry);

/// An extent in words for an error.
DEFORMVOLUME_EXPORT std::string DescribeExtent(const Extent& extent);

/// Whether an extent holds all of another one.
DEFORMVOLUME_EXPORT bool Contains(const Extent& extent, const Extent& other);

/// Throws an Error that speaks of the image as `what` where its transform cannot be inverted.
DEFORMVOLUME_EXPORT void CheckTransform(const ImageGeometry& geometry, const std::string& what);

/// Throws an Error unless the volume has two voxels or more on each axis and a transform that can
/// be inverted.
DEFORMVOLUME_EXPORT void CheckVolume(const ImageGeometry& volume);

} // namespace deformvolume

#endif
