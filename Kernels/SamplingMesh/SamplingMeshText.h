// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSamplingMeshText_h
#define DeformVolumeSamplingMeshText_h

#include "ProgramText.h"

namespace deformvolume
{

/// What kernels need of the sampling mesh (FiveTetrahedra.h), and the parameters of launches over
/// it (KernelParameters.h).
ProgramText GetSamplingMeshText();

} // namespace deformvolume

#endif
