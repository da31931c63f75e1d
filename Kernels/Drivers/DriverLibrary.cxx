// SPDX-License-Identifier: BSD-3-Clause
#include "DriverLibrary.h"

#include <CL/cl_ext.h>

#include <dlfcn.h>

namespace deformvolume
{
namespace
{

using AddressFunction = void*(CL_API_CALL*)(const char*);

/// Finds the function that lists the platforms of a driver. Some drivers export it; others return
/// it from clGetExtensionFunctionAddress.
clIcdGetPlatformIDsKHR_fn FindPlatformFunction(void* library)
{
  void* found = nullptr;
  void* const ask = dlsym(library, "clGetExtensionFunctionAddress");
  if (ask)
  {
    found = reinterpret_cast<AddressFunction>(ask)("clIcdGetPlatformIDsKHR");
  }
  if (!found)
  {
    found = dlsym(library, "clIcdGetPlatformIDsKHR");
  }
  return reinterpret_cast<clIcdGetPlatformIDsKHR_fn>(found);
}

} // namespace

std::vector<cl_platform_id> LoadPlatforms(const std::string& library, std::string& problem)
{
  void* const handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle)
  {
    const char* const reason = dlerror();
    problem = reason ? reason : "it cannot be loaded";
    return {};
  }
  // The library is never unloaded, since drivers leave threads behind.
  const clIcdGetPlatformIDsKHR_fn list = FindPlatformFunction(handle);
  if (!list)
  {
    problem = "it has no function clIcdGetPlatformIDsKHR";
    return {};
  }
  cl_uint count = 0;
  const cl_int error = list(0, nullptr, &count);
  std::vector<cl_platform_id> platforms(error == CL_SUCCESS ? count : 0);
  if (platforms.empty() || list(count, platforms.data(), nullptr) != CL_SUCCESS)
  {
    problem = "it has no platform";
    return {};
  }
  return platforms;
}

} // namespace deformvolume
