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
