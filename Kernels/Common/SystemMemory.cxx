// SPDX-License-Identifier: BSD-3-Clause
#include "SystemMemory.h"

#include "ControlGroups.h"

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

namespace deformvolume
{

namespace
{

constexpr std::int64_t NoLimit = std::numeric_limits<std::int64_t>::max();

// The names of a version's files and of what can be reclaimed.
struct Names
{
  std::initializer_list<const char*> Limits;
  const char* Usage;
  std::vector<std::string> Reclaimable;
};

// What a group has left. all: the memory of the system, which a group that may have as much does
// not limit: its use is then no matter, and it takes the system time to find that.
std::int64_t GetLeft(const std::string& folder, const Names& names, std::int64_t all)
{
  std::int64_t limit = NoLimit;
  for (const char* name : names.Limits)
  {
    limit = std::min(limit, ReadNumber(folder + "/" + name).value_or(NoLimit));
  }
  if (limit >= all)
  {
    return NoLimit;
  }
  const std::int64_t usage = ReadNumber(folder + "/" + names.Usage).value_or(0);
  const std::int64_t reclaimable = ReadSum(folder + "/memory.stat", names.Reclaimable).value_or(0);
  return limit - std::max<std::int64_t>(0, usage - reclaimable);
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
  // The first line; it stays, but for tests.
  static const auto ownTotal = ReadSum("/proc/meminfo", { "MemTotal:" });
  const auto total = root.empty() ? ownTotal : ReadSum(system, { "MemTotal:" });
  const std::int64_t all = total ? *total * kibibyte : NoLimit;
  // A process seldom changes its groups, and this is asked for at each update.
  static const ControlGroups ownGroups = FindControlGroups("memory");
  const ControlGroups groups = root.empty() ? ownGroups : FindControlGroups("memory", root);
  const Names unified{ { "memory.max", "memory.high" }, "memory.current",
    { "inactive_file", "active_file", "slab_reclaimable" } };
  for (const std::string& folder : groups.Unified)
  {
    left = std::min(left, GetLeft(folder, unified, all));
  }
  // A group without a limit has one that is near the largest number.
  const Names legacy{ { "memory.limit_in_bytes" }, "memory.usage_in_bytes",
    { "total_inactive_file", "total_active_file" } };
  for (const std::string& folder : groups.Legacy)
  {
    left = std::min(left, GetLeft(folder, legacy, all));
  }
  return left == NoLimit ? 0 : static_cast<std::uint64_t>(std::max<std::int64_t>(1, left));
}

} // namespace deformvolume
