// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeAddedDrivers_h
#define DeformVolumeAddedDrivers_h

#include "DriverLibrary.h"

#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace deformvolume
{

/// The drivers that AddDriver() has loaded. Their objects work with every loader, since each begins
/// with a pointer to the functions of its driver.
class AddedDrivers
{
public:
  static AddedDrivers& Get();

  /// Throws Error as AddDriver() does.
  void Add(const std::string& path);
  std::vector<cl_platform_id> GetPlatforms();
  std::size_t GetCount(); // of drivers
  bool Has(cl_platform_id platform);

private:
  std::mutex Mutex;
  std::vector<std::string> Libraries;
  std::vector<cl_platform_id> Platforms;
};

} // namespace deformvolume

#endif
