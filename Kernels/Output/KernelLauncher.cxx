// SPDX-License-Identifier: BSD-3-Clause
#include "KernelLauncher.h"

#include "Error.h"

#include <algorithm>

namespace deformvolume
{
namespace
{

double GetSeconds(const std::vector<cl::Event>& events)
{
  double nanoseconds = 0.0;
  for (const cl::Event& event : events)
  {
    nanoseconds += static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
      event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
  }
  return nanoseconds * 1e-9;
}

} // namespace

void KernelLauncher::Start()
{
  this->Mapping.clear();
  this->Resampling.clear();
  this->Last = cl::Event();
  this->Done = 0;
  this->Expected = 1;
  this->Reported = 0.0;
}

void KernelLauncher::ExpectAtLeast(std::size_t launches)
{
  this->Expected = std::max(this->Expected, this->Done + launches);
}

void KernelLauncher::Launch(
  const cl::Kernel& kernel, const cl::NDRange& items, const cl::NDRange& group)
{
  this->Resampling.push_back(this->GetContext().Launch(this->GetQueue(), kernel, items, group));
}

void KernelLauncher::AddMapping(const cl::Event& launch)
{
  if (launch())
  {
    this->Mapping.push_back(launch);
  }
}

void KernelLauncher::LaunchAndReport(const DeformRequest& request, const cl::Kernel& kernel,
  const cl::NDRange& items, const cl::NDRange& group)
{
  const cl::CommandQueue& queue = this->GetQueue();
  this->Launch(kernel, items, group);
  queue.flush();
  if (this->Last())
  {
    this->Last.wait();
  }
  this->Last = this->Resampling.back();
  ++this->Done;
  // The expected number may grow later.
  constexpr double most = 0.99;
  this->Reported = std::max(this->Reported,
    std::min(most, static_cast<double>(this->Done) / static_cast<double>(this->Expected)));
  if (request.Progress && !request.Progress(this->Reported))
  {
    queue.finish();
    throw Aborted();
  }
}

void KernelLauncher::AddTimes(DeformReport& report)
{
  report.MappingTime += GetSeconds(this->Mapping);
  report.ResamplingTime += GetSeconds(this->Resampling);
  this->Start();
}

} // namespace deformvolume
