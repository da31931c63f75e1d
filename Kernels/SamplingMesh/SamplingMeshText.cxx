// SPDX-License-Identifier: BSD-3-Clause
#include "SamplingMeshText.h"

#include "KernelSources.h"

namespace deformvolume
{

ProgramText GetSamplingMeshText(bool withCut)
{
  return ProgramText(withCut ? "#define HAS_CUT 1\n" : "#define HAS_CUT 0\n") + FiveTetrahedra_h +
    KernelParameters_h;
}

} // namespace deformvolume
