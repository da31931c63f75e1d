// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRangesOfGhosts_h
#define DeformVolumeRangesOfGhosts_h

#include "vtkVersionMacros.h"

/// Whether the range of an array can be found without its ghosts, from VTK 9.2 on: then
/// vtkDataArray::ComputeRange() has an overload for that.
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 0)
#define DEFORMVOLUME_RANGES_OF_GHOSTS
#endif

#endif
