// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRangesOfGhosts_h
#define DeformVolumeRangesOfGhosts_h

#include "vtkVersionMacros.h"

/// Defined if the range of an array can be computed without its ghosts: since VTK 9.2,
/// vtkDataArray::ComputeRange() has an overload for this.
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 0)
#define DEFORMVOLUME_RANGES_OF_GHOSTS
#endif

#endif
