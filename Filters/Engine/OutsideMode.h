// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutsideMode_h
#define DeformVolumeOutsideMode_h

#include "Fading.h"

namespace deformvolume
{

/// What an OutsideMode of the filters and a FadeDistance ask for. Throws an Error where the
/// distance counts and is none.
OutsideVoxels MakeOutsideVoxels(int outsideMode, double fadeDistance);

} // namespace deformvolume

#endif
