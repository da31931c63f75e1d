// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceNeeds.h"

#include "Device.h"

using namespace deformvolume;

bool HasDoublePrecision()
{
  return GetDeviceAbilities("").DoublePrecision;
}

bool HasVectors()
{
  return GetDeviceAbilities("").Vectors;
}

std::vector<Resampling> GetExactMethods()
{
  return HasVectors() ? std::vector<Resampling>{ Resampling::ExactByLanes, Resampling::ExactByCell }
                      : std::vector<Resampling>{ Resampling::ExactByCell };
}
