// SPDX-License-Identifier: BSD-3-Clause
#include "Call.h"
#include "Device.h"

#include <cstddef>
#include <string>
#include <vector>

namespace
{

struct ThreadTexts
{
  std::string Error;
  std::string Device;
};

// A thread-local object with a destructor keeps a library that was loaded at run time in memory
// until the thread ends. This is no disadvantage: ctypes never unloads libraries.
ThreadTexts& GetTexts()
{
  thread_local ThreadTexts texts;
  return texts;
}

deformvolume::DeviceSummary GetDevice(std::int32_t index)
{
  const std::vector<deformvolume::DeviceSummary> devices = deformvolume::GetDevices();
  if (index < 0 || static_cast<std::size_t>(index) >= devices.size())
  {
    throw deformvolume::Error("There is no OpenCL device " + std::to_string(index) +
      ": the number of devices is " + std::to_string(devices.size()) + ".");
  }
  return devices[static_cast<std::size_t>(index)];
}

} // namespace

namespace deformvolume
{

void SetLastError(const char* message) noexcept
{
  try
  {
    GetTexts().Error = message;
  }
  catch (...)
  {
    GetTexts().Error.clear(); // no memory for the text
  }
}

} // namespace deformvolume

std::int32_t dv_abi_version(void)
{
  return DV_ABI_VERSION;
}

const char* dv_version(void)
{
  return DEFORMVOLUME_VERSION;
}

const char* dv_last_error(void)
{
  return GetTexts().Error.c_str();
}

std::int32_t dv_add_driver(const char* path)
{
  return deformvolume::Call(
    [&]
    {
      if (!path)
      {
        throw deformvolume::Error("dv_add_driver: the path of the driver is null.");
      }
      deformvolume::AddDriver(path);
    });
}

std::int32_t dv_set_linker(const char* folder)
{
  return deformvolume::Call(
    [&]
    {
      if (!folder)
      {
        throw deformvolume::Error("dv_set_linker: the folder is null.");
      }
      deformvolume::SetKernelLinker(folder);
    });
}

std::int32_t dv_device_count(void)
{
  std::int32_t count = 0;
  deformvolume::Call([&] { count = static_cast<std::int32_t>(deformvolume::GetDevices().size()); });
  return count;
}

const char* dv_device_name(std::int32_t index)
{
  const char* name = nullptr;
  deformvolume::Call(
    [&]
    {
      GetTexts().Device = GetDevice(index).Name;
      name = GetTexts().Device.c_str();
    });
  return name;
}

std::int32_t dv_device_flags(std::int32_t index)
{
  std::int32_t flags = -1;
  deformvolume::Call(
    [&]
    {
      const deformvolume::DeviceSummary device = GetDevice(index);
      flags = (device.IsProcessor ? DV_DEVICE_PROCESSOR : 0) |
        (device.IsEmulated ? DV_DEVICE_EMULATED : 0) |
        (device.DoublePrecision ? DV_DEVICE_DOUBLE : 0);
    });
  return flags;
}
