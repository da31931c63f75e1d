// SPDX-License-Identifier: BSD-3-Clause
#include "AddedDrivers.h"

#include "DeviceThreads.h"
#include "Error.h"
#include "FloatingPointTrapGuard.h"
#include "KernelCache.h"

#include <algorithm>
#include <filesystem>

namespace deformvolume
{

AddedDrivers& AddedDrivers::Get()
{
  static auto* const drivers = new AddedDrivers; // lives as long as the process
  return *drivers;
}

void AddedDrivers::Add(const std::string& path)
{
  if (path.empty() || path[0] != '/')
  {
    throw Error(
      "The path \"" + path + "\" of an OpenCL driver is not absolute. Pass an absolute path.");
  }
  std::error_code error;
  const std::string library = std::filesystem::canonical(path, error).string();
  if (error)
  {
    throw Error("The OpenCL driver \"" + path + "\" cannot be loaded: " + error.message() + ".");
  }
  const std::lock_guard<std::mutex> lock(this->Mutex);
  if (std::find(this->Libraries.begin(), this->Libraries.end(), library) != this->Libraries.end())
  {
    return;
  }
  const bool maySetProcessor = MaySetKernelProcessor();
  // These functions set environment variables, which drivers read when they start.
  PrepareKernelCache();
  LimitDeviceThreads();
  const FloatingPointTrapGuard guard;
  std::string problem;
  const std::vector<cl_platform_id> platforms = LoadPlatforms(library, problem);
  if (platforms.empty())
  {
    throw Error("\"" + path + "\" is not a usable OpenCL driver: " + problem + ".");
  }
  this->Libraries.push_back(library);
  this->Platforms.insert(this->Platforms.end(), platforms.begin(), platforms.end());
  for (cl_platform_id platform : platforms)
  {
    std::vector<cl::Device> devices;
    try
    {
      cl::Platform(platform).getDevices(CL_DEVICE_TYPE_ALL, &devices);
    }
    catch (const cl::Error&)
    {
      continue; // a platform without devices
    }
    for (const cl::Device& device : devices)
    {
      this->Processors[device()] = SetKernelProcessor(library, device, maySetProcessor);
    }
  }
}

std::vector<cl_platform_id> AddedDrivers::GetPlatforms()
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return this->Platforms;
}

std::size_t AddedDrivers::GetCount()
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return this->Libraries.size();
}

bool AddedDrivers::Has(cl_platform_id platform)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return std::find(this->Platforms.begin(), this->Platforms.end(), platform) !=
    this->Platforms.end();
}

KernelProcessor AddedDrivers::GetProcessor(cl_device_id device)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  const auto found = this->Processors.find(device);
  return found != this->Processors.end() ? found->second : KernelProcessor();
}

} // namespace deformvolume
