// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputExtent_h
#define DeformVolumeOutputExtent_h

#include "DeformVolumeExport.h"
#include "ImageGeometry.h"
#include "IndexBounds.h"
#include "VoxelGrid.h"

namespace deformvolume
{

/// The largest number of output voxels, far below 2^63, so that no number of bytes can overflow.
inline constexpr double MostOutputVoxels = 281474976710656.0; // 2^48

/// Returns the output voxels inside bounds. The ends of the bounds are rounded to 1/256 voxel, like
/// positions in the kernels. Throws an Error if there are no such voxels, or if their indices are
/// too large for an extent.
DEFORMVOLUME_EXPORT Extent GetExtentInside(const IndexBounds& bounds);

/// Returns the smallest extent whose box contains the bounds, after the same rounding as in
/// GetExtentInside().
DEFORMVOLUME_EXPORT Extent GetExtentAround(const IndexBounds& bounds);

/// Returns the box of a volume's voxels, in continuous output indices. scale: output voxels per
/// voxel of the volume on each axis.
DEFORMVOLUME_EXPORT IndexBounds GetVolumeBounds(
  const ImageGeometry& volume, const glm::dvec3& scale);

/// Converts a box in world coordinates (x min, x max, y min, ...) to continuous indices of an
/// image: returns the bounds of its eight corners. Throws an Error if a minimum is greater than its
/// maximum, or a value is not finite.
DEFORMVOLUME_EXPORT IndexBounds GetWorldBoxBounds(const double* box, const ImageGeometry& image);

/// Returns an extent that contains `needed`, rounded outwards to multiples of `granularity` voxels.
/// An end of the last extent is kept if it still includes `needed` and is at most `granularity`
/// voxels farther out than the rounded end. So an output that changes little keeps its extent.
/// last: the last extent; empty if there is none.
DEFORMVOLUME_EXPORT Extent GetStableExtent(
  const Extent& last, const Extent& needed, int granularity);

/// Returns an extent that is extended by `padding` voxels on all sides. Throws an Error if the
/// result has more than MostOutputVoxels voxels.
DEFORMVOLUME_EXPORT Extent GetPadded(const Extent& extent, int padding);

/// Throws an Error if the volume at rest has indices beyond MaxOutputIndex in the grid of the
/// reference image. voxelGrid: the grid of the volume, with its transform to the grid of the
/// reference image.
DEFORMVOLUME_EXPORT void CheckReferenceIndices(
  const VoxelGrid& voxelGrid, const ImageGeometry& reference);

} // namespace deformvolume

#endif
