// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutsideMode_h
#define DeformVolumeOutsideMode_h

#include "Fading.h"

namespace deformvolume
{

/// Converts the properties OutsideMode and FadeDistance of the filters. Throws an Error if
/// OutsideMode is KEEP and FadeDistance is negative or not finite.
OutsideVoxels MakeOutsideVoxels(int outsideMode, double fadeDistance);

} // namespace deformvolume

#endif
