// SPDX-License-Identifier: BSD-3-Clause
#include "Device.h"

#include "OpenCLContext.h"

#include <algorithm>
#include <cstdlib>
#include <thread>

namespace deformvolume
{

std::vector<std::string> GetDeviceNames()
{
  std::vector<std::string> names;
  for (const OpenCLDevice& device : FindDevices())
  {
    names.push_back(device.Name);
  }
  return names;
}

std::string ResolveDevice(const std::string& request)
{
  return FindDevice(request).Name;
}

void ShareProcessors(int processes)
{
  if (processes > 1)
  {
    const int processors = static_cast<int>(std::thread::hardware_concurrency());
    const int share = std::max(1, processors / processes);
    setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(share).c_str(), 0);
  }
}

} // namespace deformvolume
