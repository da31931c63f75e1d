// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSamplingMeshText_h
#define DeformVolumeSamplingMeshText_h

#include "ProgramText.h"

namespace deformvolume
{

/// What kernels need of the sampling mesh (FiveTetrahedra.h), and the parameters of launches over
/// it (KernelParameters.h). withCut: the program knows smooth cuts; without one it must not pay for
/// them.
ProgramText GetSamplingMeshText(bool withCut = false);

} // namespace deformvolume

#endif
