// SPDX-License-Identifier: BSD-3-Clause
#include "SystemMemory.h"

#include "ControlGroups.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <sys/resource.h>
#include <unistd.h>

namespace deformvolume
{

namespace
{

constexpr std::int64_t NoLimit = std::numeric_limits<std::int64_t>::max();

// Returns the memory that a control group has left. all: the memory of the system. Limits of at
// least `all` have no effect: then the usage, which is slow to read, is not needed.
std::int64_t GetAvailable(const std::string& folder, std::int64_t all)
{
  const std::int64_t limit = std::min(ReadNumber(folder + "/memory.max").value_or(NoLimit),
    ReadNumber(folder + "/memory.high").value_or(NoLimit));
  if (limit >= all)
  {
    return NoLimit;
  }
  const std::int64_t usage = ReadNumber(folder + "/memory.current").value_or(0);
  const std::int64_t reclaimable =
    ReadSum(folder + "/memory.stat", { "inactive_file", "active_file", "slab_reclaimable" })
      .value_or(0);
  return limit - std::max<std::int64_t>(0, usage - reclaimable);
}

// Returns the address space that this process has left (ulimit -v, which many batch systems set).
std::int64_t GetAddressSpace()
{
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
  {
    return NoLimit;
  }
  std::ifstream sizes("/proc/self/statm");
  std::int64_t pages = 0;
  if (!(sizes >> pages))
  {
    return NoLimit;
  }
  const auto all = std::min(limit.rlim_cur, static_cast<rlim_t>(NoLimit));
  return static_cast<std::int64_t>(all) - pages * sysconf(_SC_PAGESIZE);
}

} // namespace

std::uint64_t GetSystemMemory(const std::string& root)
{
  constexpr std::int64_t kibibyte = 1024;
  std::int64_t left = NoLimit;
  const std::string system = root + "/proc/meminfo";
  if (const auto available = ReadSum(system, { "MemAvailable:" }))
  {
    left = *available * kibibyte;
  }
  // The total does not change, except in tests.
  static const auto ownTotal = ReadSum("/proc/meminfo", { "MemTotal:" });
  const auto total = root.empty() ? ownTotal : ReadSum(system, { "MemTotal:" });
  const std::int64_t all = total ? *total * kibibyte : NoLimit;
  // Each update calls this function, and a process rarely changes its groups.
  // It is not destroyed, as a program may end with calls from destructors of its own.
  static const auto& ownGroups = *new std::vector<std::string>(FindControlGroups());
  const std::vector<std::string> groups = root.empty() ? ownGroups : FindControlGroups(root);
  for (const std::string& folder : groups)
  {
    left = std::min(left, GetAvailable(folder, all));
  }
  left = root.empty() ? std::min(left, GetAddressSpace()) : left;
  return left == NoLimit ? 0 : static_cast<std::uint64_t>(std::max<std::int64_t>(1, left));
}

} // namespace deformvolume
