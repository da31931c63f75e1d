// SPDX-License-Identifier: BSD-3-Clause
#include "Processors.h"

#include "ControlGroups.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include <sched.h>
#include <unistd.h>

namespace deformvolume
{

namespace
{

constexpr double UNLIMITED = std::numeric_limits<double>::infinity();

int GetMachineProcessors()
{
  return std::max(1, static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN)));
}

// Number of processors in the affinity mask of this process. All processors if the mask cannot be
// read, as on machines with more processors than a cpu_set_t holds.
int GetBoundProcessors()
{
  cpu_set_t set;
  return sched_getaffinity(0, sizeof(set), &set) == 0 ? std::max(1, CPU_COUNT(&set))
                                                      : GetMachineProcessors();
}

// Converts a CPU quota (time per period) to a number of processors.
double GetQuota(double quota, double period)
{
  return quota > 0.0 && period > 0.0 ? quota / period : UNLIMITED;
}

double GetQuota(const std::string& root)
{
  double least = UNLIMITED;
  for (const std::string& folder : FindControlGroups(root))
  {
    // "quota period", or "max period" without a limit.
    std::ifstream file(folder + "/cpu.max");
    double quota = 0.0;
    double period = 0.0;
    if (file >> quota >> period)
    {
      least = std::min(least, GetQuota(quota, period));
    }
  }
  return least;
}

int LimitByQuota(int processors, double quota)
{
  return quota < static_cast<double>(processors) ? static_cast<int>(std::ceil(quota)) : processors;
}

std::atomic<int> Processes{ 1 };

} // namespace

int GetProcessorShare(int processes, const std::string& root)
{
  const int share =
    std::max(1, std::min(GetBoundProcessors(), GetMachineProcessors() / std::max(1, processes)));
  return LimitByQuota(share, GetQuota(root) / std::max(1, processes));
}

int GetProcessorShare()
{
  // This function is called whenever threads start. Therefore the files are read only once.
  static const double quota = GetQuota("");
  static const int bound = GetBoundProcessors();
  static const int machine = GetMachineProcessors();
  const int processes = Processes;
  return LimitByQuota(std::max(1, std::min(bound, machine / processes)), quota / processes);
}

void SetProcessesHere(int processes)
{
  Processes = std::max(1, processes);
}

} // namespace deformvolume
