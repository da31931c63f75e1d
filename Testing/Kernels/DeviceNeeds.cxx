// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceNeeds.h"

#include "OpenCLContext.h"

using namespace deformvolume;

bool HasDoublePrecision()
{
  return FindDevice("").Description.HasDouble;
}

bool HasVectors()
{
  return FindDevice("").HasVectors;
}

std::vector<Resampling> GetExactMethods()
{
  return HasVectors() ? std::vector<Resampling>{ Resampling::ExactByLanes, Resampling::ExactByCell }
                      : std::vector<Resampling>{ Resampling::ExactByCell };
}
