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

/// The bounds of the deformed voxels, as ComputeDeformedBounds has them, of a field whose vectors
/// lie on a device: found there, so that no vector comes to the host. Nothing where that is not
/// possible: each voxel has to be a point of the field (AreVoxelsPoints), the device needs memory
/// of its own and double precision, and displacements have to be finite and not too large. Vectors
/// and Owner of field are not used. Throws an Error where there are not so many vectors.
DEFORMVOLUME_EXPORT std::optional<IndexBounds> FindDeformedBounds(
  const VoxelGrid& voxelGrid, const DisplacementField& field, DeviceVectors& vectors);

} // namespace deformvolume

#endif
