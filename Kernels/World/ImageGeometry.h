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

/// The positions of the points of an image. Its transforms convert between world coordinates and
/// continuous structured indices. Index (0, 0, 0) is at Origin, even if the extent does not contain
/// it.
struct DEFORMVOLUME_EXPORT ImageGeometry
{
  /// Structured indices of the points.
  Extent PointExtent = EmptyExtent;
  /// World coordinates of the index (0, 0, 0).
  glm::dvec3 Origin{ 0.0 };
  /// The distance of neighboring points on each axis, in world units.
  glm::dvec3 Spacing{ 1.0 };
  /// The directions of the axes in world coordinates, as columns.
  glm::dmat3 Direction{ 1.0 };

  /// Returns the matrix that converts structured indices to world coordinates.
  glm::dmat4 GetIndexToWorld() const;
  /// Returns the matrix that converts world coordinates to continuous structured indices.
  glm::dmat4 GetWorldToIndex() const;

  /// Whether extent, origin, spacing and direction are equal.
  bool operator==(const ImageGeometry& other) const;
  /// Whether extent, origin, spacing or direction differ.
  bool operator!=(const ImageGeometry& other) const { return !(*this == other); }
};

/// Returns a direction matrix from its nine elements, row by row.
DEFORMVOLUME_EXPORT glm::dmat3 MakeDirection(const double* rows);

/// Whether the points of an extent have the same world positions in two geometries, to 1/1000 of
/// the distance between points. The transform of the second geometry must be invertible.
DEFORMVOLUME_EXPORT bool AreSamePositions(
  const ImageGeometry& first, const ImageGeometry& second, const Extent& extent);

/// Returns the map from indices of an image to indices of another image. Rounding errors are
/// removed: the matrix is diagonal if the axes of the images are parallel, and has whole numbers if
/// the points of the grids coincide.
DEFORMVOLUME_EXPORT OutputMap GetOutputMap(const ImageGeometry& image, const ImageGeometry& output);

/// Returns the largest absolute world coordinate of the points of an image.
DEFORMVOLUME_EXPORT double GetLargestCoordinate(const ImageGeometry& image);
/// Returns the smallest distance of neighboring points of an image, in world units.
DEFORMVOLUME_EXPORT double GetSmallestSpacing(const ImageGeometry& image);

/// Returns the point to which single-precision positions in a volume are relative: the origin of
/// the world, or the middle of the volume if positions relative to the origin would be less exact
/// than 1/256 voxel.
DEFORMVOLUME_EXPORT glm::dvec3 GetPositionsOrigin(const ImageGeometry& volume);

/// Computes the world positions of the points relative to `origin`, x varying fastest. positions:
/// for each axis an array of one float per point.
DEFORMVOLUME_EXPORT void ComputeWorldPositions(
  const ImageGeometry& image, const glm::dvec3& origin, const std::array<float*, 3>& positions);

/// Returns origin, spacing and direction as text for an error.
DEFORMVOLUME_EXPORT std::string DescribeTransform(const ImageGeometry& geometry);

/// Returns an extent as text for an error.
DEFORMVOLUME_EXPORT std::string DescribeExtent(const Extent& extent);

/// Whether an extent contains another extent.
DEFORMVOLUME_EXPORT bool Contains(const Extent& extent, const Extent& other);

/// Throws an Error if the transform of an image is not finite or not invertible. what: the name of
/// the image in the error, for example "the volume".
DEFORMVOLUME_EXPORT void CheckTransform(const ImageGeometry& geometry, const std::string& what);

/// Throws an Error unless the volume has two voxels or more on each axis and an invertible
/// transform.
DEFORMVOLUME_EXPORT void CheckVolume(const ImageGeometry& volume);

} // namespace deformvolume

#endif
