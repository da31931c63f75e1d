// SPDX-License-Identifier: BSD-3-Clause
#include "SamplingMeshText.h"

#include "KernelSources.h"

namespace deformvolume
{

ProgramText GetSamplingMeshText()
{
  return ProgramText(FiveTetrahedra_h) + KernelParameters_h;
}

} // namespace deformvolume
