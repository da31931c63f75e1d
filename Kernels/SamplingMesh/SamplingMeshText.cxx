// SPDX-License-Identifier: BSD-3-Clause
#include "SamplingMeshText.h"

#include "KernelSources.h"

namespace deformvolume
{

std::string GetSamplingMeshText()
{
  return std::string(FiveTetrahedra_h) + KernelParameters_h;
}

} // namespace deformvolume
