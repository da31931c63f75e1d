// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLookupBounds_h
#define DeformVolumeLookupBounds_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "IndexBounds.h"
#include "VoxelGrid.h"

namespace deformvolume
{

/// Computes the bounds of the output voxels that an inverse displacement field maps into the
/// volume. The result is exact, by the rule of the kernel (FieldLookup.cl). Empty if there are no
/// such voxels.
DEFORMVOLUME_EXPORT IndexBounds ComputeLookupBounds(
  const VoxelGrid& voxelGrid, const DisplacementField& field);

} // namespace deformvolume

#endif
