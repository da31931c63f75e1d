// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeAddedDrivers_h
#define DeformVolumeAddedDrivers_h

#include "DriverLibrary.h"
#include "KernelProcessor.h"

#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace deformvolume
{

/// The drivers that AddDriver() has loaded. Their objects work with every OpenCL loader, since each
/// object begins with a pointer to the function table of its driver (cl_khr_icd).
class AddedDrivers
{
public:
  static AddedDrivers& Get();

  /// Throws Error as AddDriver() does.
  void Add(const std::string& path);
  std::vector<cl_platform_id> GetPlatforms();
  /// Number of drivers.
  std::size_t GetCount();
  bool Has(cl_platform_id platform);
  /// Returns the processor for which kernels are compiled on a device.
  KernelProcessor GetProcessor(cl_device_id device);

private:
  std::mutex Mutex;
  std::vector<std::string> Libraries;
  std::vector<cl_platform_id> Platforms;
  std::map<cl_device_id, KernelProcessor> Processors;
};

} // namespace deformvolume

#endif
