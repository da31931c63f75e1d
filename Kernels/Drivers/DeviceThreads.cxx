// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceThreads.h"

#include "Processors.h"

#include <cstdlib>
#include <string>

#include <unistd.h>

namespace deformvolume
{

void LimitDeviceThreads()
{
  const int share = GetProcessorShare();
  if (share < sysconf(_SC_NPROCESSORS_ONLN))
  {
    setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(share).c_str(), 0);
  }
}

} // namespace deformvolume
