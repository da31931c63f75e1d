// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLookupBounds_h
#define DeformVolumeLookupBounds_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "IndexBounds.h"
#include "VoxelGrid.h"

namespace deformvolume
{

/// Bounds of the output voxels that an inverse displacement field leads into the volume. Exact, as
/// the kernel decides (FieldLookup.cl); empty where there are none.
DEFORMVOLUME_EXPORT IndexBounds ComputeLookupBounds(
  const VoxelGrid& voxelGrid, const DisplacementField& field);

} // namespace deformvolume

#endif
