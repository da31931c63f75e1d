// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputExtent_h
#define DeformVolumeOutputExtent_h

#include "DeformVolumeExport.h"
#include "ImageGeometry.h"
#include "IndexBounds.h"
#include "VoxelGrid.h"

namespace deformvolume
{

/// Far below 2^63, so that no count of bytes can overflow.
inline constexpr double MostOutputVoxels = 281474976710656.0; // 2^48

/// The output voxels inside bounds, whose ends are rounded to 1/256 voxel as the kernels round
/// positions. Throws an Error where there are none or more than an extent can count.
DEFORMVOLUME_EXPORT Extent GetExtentInside(const IndexBounds& bounds);

/// The fewest output voxels whose box contains bounds, after the same rounding.
DEFORMVOLUME_EXPORT Extent GetExtentAround(const IndexBounds& bounds);

/// The box of a volume's voxels, in continuous output indices.
DEFORMVOLUME_EXPORT IndexBounds GetVolumeBounds(
  const ImageGeometry& volume, const glm::dvec3& scale);

/// The box of the corners of a box in world coordinates (x min, x max, y min, ...), in continuous
/// indices of an image. Throws an Error where the box is not one.
DEFORMVOLUME_EXPORT IndexBounds GetWorldBoxBounds(const double* box, const ImageGeometry& image);

/// An extent that holds another one, rounded outwards to multiples of so many voxels. Each end
/// stays where it was last while what is needed lies within it and it could be no more than so many
/// voxels nearer: an output whose needs vary little keeps its extent. last: empty where there is
/// none.
DEFORMVOLUME_EXPORT Extent GetKept(const Extent& last, const Extent& needed, int granularity);

/// An extent with a border of so many voxels. Throws an Error where it counts more voxels than any
/// machine can hold or stream.
DEFORMVOLUME_EXPORT Extent GetPadded(const Extent& extent, int padding);

/// Throws an Error if the volume at rest has indices beyond MostOutputIndex in the grid of the
/// reference image. voxelGrid: of the volume, with its transform to that grid.
DEFORMVOLUME_EXPORT void CheckReferenceIndices(
  const VoxelGrid& voxelGrid, const ImageGeometry& reference);

} // namespace deformvolume

#endif
