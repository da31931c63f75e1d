// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSamplingMeshText_h
#define DeformVolumeSamplingMeshText_h

#include "ProgramText.h"

namespace deformvolume
{

/// Returns the source text that kernels on the sampling mesh include: FiveTetrahedra.h and
/// KernelParameters.h. withCut: whether the program supports smooth cuts, which make it slower.
ProgramText GetSamplingMeshText(bool withCut = false);

} // namespace deformvolume

#endif
