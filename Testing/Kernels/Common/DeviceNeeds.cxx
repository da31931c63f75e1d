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
  std::vector<Resampling> methods{ Resampling::ExactByColumns, Resampling::ExactByCell };
  if (HasVectors())
  {
    methods.insert(methods.begin(), Resampling::ExactByLanes);
  }
  return methods;
}
