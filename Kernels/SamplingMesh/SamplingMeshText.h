// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSamplingMeshText_h
#define DeformVolumeSamplingMeshText_h

#include <string>

namespace deformvolume
{

/// What kernels need of the sampling mesh (FiveTetrahedra.h), and the parameters of launches over
/// it (KernelParameters.h).
std::string GetSamplingMeshText();

} // namespace deformvolume

#endif
