// SPDX-License-Identifier: BSD-3-Clause
#include "Device.h"

#include "AddedDrivers.h"
#include "DeviceThreads.h"
#include "OpenCLContext.h"
#include "Processors.h"

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

void AddDriver(const std::string& path)
{
  AddedDrivers::Get().Add(path);
}

std::vector<DeviceSummary> GetDevices()
{
  std::vector<DeviceSummary> devices;
  for (const OpenCLDevice& device : FindDevices())
  {
    devices.push_back({ device.Name, device.IsProcessor, IsEmulated(device.Description),
      device.Description.HasDouble });
  }
  return devices;
}

std::string ResolveDevice(const std::string& request)
{
  return FindDevice(request).Name;
}

DeviceAbilities GetDeviceAbilities(const std::string& request)
{
  const OpenCLDevice device = FindDevice(request);
  return { device.Description.HasDouble, device.HasVectors, !device.IsProcessor };
}

void ShareProcessors(int processes)
{
  SetProcessesHere(processes);
  LimitDeviceThreads();
}

} // namespace deformvolume
