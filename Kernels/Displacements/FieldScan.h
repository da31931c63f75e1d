// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldScan_h
#define DeformVolumeFieldScan_h

#include "BlockBounds.h"
#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "IndexBounds.h"
#include "PointRanges.h"
#include "VoxelGrid.h"

#include <vector>

namespace deformvolume
{

/// What there is to know of the vectors of a displacement field before it is used.
struct FieldState
{
  /// Whether all vectors are finite, and no displacement is over LargestDisplacement.
  bool IsUsable = false;
  /// Of the voxels after the deformation, as ComputeDeformedBounds has them.
  IndexBounds Bounds;
};

/// Whether each voxel is a point of a field.
DEFORMVOLUME_EXPORT bool AreVoxelsPoints(
  const VoxelGrid& voxelGrid, const DisplacementField& field);

/// Looks at each vector of a field that has each voxel for a point; once, and then at those only
/// that have been written.
class DEFORMVOLUME_EXPORT FieldScan
{
public:
  /// changes: points of the field. If all else is as it was at the last call, only those are looked
  /// at. Null: any may have changed.
  FieldState Look(const VoxelGrid& voxelGrid, const DisplacementField& field,
    const PointRanges* changes = nullptr);

private:
  std::vector<unsigned char> FindChanged(
    const DisplacementField& field, const PointRanges* changes) const;

  BlockBounds Bounds; // of some rows of points each, and of as many in all that follows
  std::vector<unsigned char> AreUsable;
};

} // namespace deformvolume

#endif
