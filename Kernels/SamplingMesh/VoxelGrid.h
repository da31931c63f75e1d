// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVoxelGrid_h
#define DeformVolumeVoxelGrid_h

#include "Extent.h"

#include <array>

namespace deformvolume
{

/// The voxels of a volume at rest, which are the vertices of the implicit sampling mesh, and where
/// they lie in the output.
struct VoxelGrid
{
  /// Structured indices of the voxels. Their parity decides the 5T split.
  Extent VertexExtent{ { 0, -1, 0, -1, 0, -1 } };
  /// Voxel (i, j, k) at rest has the continuous output index Scale * (i, j, k), axis by axis:
  /// the ratio of the volume's spacing to the output's; 1 where both share one spacing.
  std::array<double, 3> Scale{ { 1.0, 1.0, 1.0 } };
  /// Structured indices of the volume that the voxels are a part of; empty: they are all of it.
  /// Voxels of a part are displaced as in the whole, to the last bit.
  Extent WholeExtent{ { 0, -1, 0, -1, 0, -1 } };
};

/// Structured indices of the whole volume, whether the voxels are a part of it or all of it.
inline const Extent& GetWholeExtent(const VoxelGrid& grid)
{
  return GetNumberOfPoints(grid.WholeExtent) > 0 ? grid.WholeExtent : grid.VertexExtent;
}

} // namespace deformvolume

#endif
