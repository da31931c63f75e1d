// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldChecker_h
#define DeformVolumeFieldChecker_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "IndexBounds.h"
#include "PointRanges.h"
#include "VoxelGrid.h"

#include <vector>

namespace deformvolume
{

/// State of the vectors of a displacement field.
struct FieldCheckResult
{
  /// Whether all vectors are finite, and no displacement exceeds LargestDisplacement.
  bool IsUsable = false;
  /// Bounds of the deformed voxels, as by ComputeDeformedBounds().
  IndexBounds Bounds;
};

/// Whether each voxel is a point of a field.
DEFORMVOLUME_EXPORT bool AreVoxelsPoints(
  const VoxelGrid& voxelGrid, const DisplacementField& field);

/// Checks the vectors of a field in which each voxel is a point, and computes the bounds of the
/// deformed voxels. Later calls process only vectors that have changed.
class DEFORMVOLUME_EXPORT FieldChecker
{
public:
  /// Checks the vectors. changes: points whose vectors have changed since the last call, if nothing
  /// else has changed; null: any vector may have changed.
  FieldCheckResult Check(const VoxelGrid& voxelGrid, const DisplacementField& field,
    const PointRanges* changes = nullptr);

private:
  std::vector<unsigned char> FindChanged(
    const DisplacementField& field, const PointRanges* changes) const;

  // One element for each block of rows.
  std::vector<IndexBounds> Bounds;
  std::vector<unsigned char> AreUsable;
};

} // namespace deformvolume

#endif
