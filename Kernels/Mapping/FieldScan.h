// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldScan_h
#define DeformVolumeFieldScan_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "IndexBounds.h"
#include "VoxelGrid.h"

namespace deformvolume
{

/// What there is to know of the vectors of a displacement field before it is used.
struct FieldScan
{
  /// Whether all vectors are finite, and no displacement is over LargestDisplacement.
  bool IsUsable = false;
  /// Of the voxels after the deformation, as ComputeDeformedBounds has them.
  IndexBounds Bounds;
};

/// Whether each voxel is a point of a field.
DEFORMVOLUME_EXPORT bool AreVoxelsPoints(
  const VoxelGrid& voxelGrid, const DisplacementField& field);

/// Looks at each vector once, of a field that has each voxel for a point.
DEFORMVOLUME_EXPORT FieldScan ScanField(const VoxelGrid& voxelGrid, const DisplacementField& field);

} // namespace deformvolume

#endif
