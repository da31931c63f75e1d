// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldChecker_h
#define DeformVolumeFieldChecker_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "Extent.h"
#include "IndexBounds.h"
#include "PointRanges.h"
#include "VoxelGrid.h"

#include <array>
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

/// Returns n if every n-th point of a field on each axis is a voxel, and all voxels are points of
/// the field; otherwise 0. indexToField: see DisplacementField.
DEFORMVOLUME_EXPORT int GetFieldStride(const Extent& voxels,
  const std::array<double, 12>& indexToField, const std::array<int, 3>& dimensions);

/// Whether each voxel is a point of a field, and each point between voxels is a voxel.
inline bool AreVoxelsPoints(const VoxelGrid& voxelGrid, const DisplacementField& field)
{
  return GetFieldStride(voxelGrid.VertexExtent, field.IndexToField, field.Dimensions) == 1;
}

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
