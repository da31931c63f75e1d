// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorBounds_h
#define DeformVolumeVectorBounds_h

#include "DeformVolumeExport.h"
#include "DeviceVectors.h"
#include "DisplacementField.h"
#include "IndexBounds.h"
#include "VoxelGrid.h"

#include <optional>

namespace deformvolume
{

/// Computes the bounds of the deformed voxels, as ComputeDeformedBounds() does, for a field whose
/// vectors are on a device. No vectors are copied to the host.
///
/// Returns an empty result unless all of these hold: each voxel is a point of the field
/// (AreVoxelsPoints()), the device has memory of its own and double precision, and all
/// displacements are finite and not too large. Vectors and Owner of `field` are not used. Throws
/// Error if the number of vectors is not that of the points of the field.
DEFORMVOLUME_EXPORT std::optional<IndexBounds> FindDeformedBounds(
  const VoxelGrid& voxelGrid, const DisplacementField& field, DeviceVectors& vectors);

} // namespace deformvolume

#endif
