// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLookupBounds_h
#define DeformVolumeLookupBounds_h

#include "IndexBounds.h"
#include "VolumeDeformer.h" // for Lattice, DisplacementField

namespace deformvolume
{

/// Bounds of the output voxels that an inverse displacement field leads into the volume. Exact, as
/// the kernel decides (FieldLookup.cl); empty where there are none.
IndexBounds ComputeLookupBounds(const Lattice& lattice, const DisplacementField& field);

} // namespace deformvolume

#endif
