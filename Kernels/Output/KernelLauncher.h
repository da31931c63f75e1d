// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelLauncher_h
#define DeformVolumeKernelLauncher_h

#include "DeformRequest.h"
#include "WorkDevice.h"

#include <cstddef>
#include <vector>

namespace deformvolume
{

/// The launches of kernels of a deformation: their times, and the progress by their number.
class KernelLauncher
{
public:
  explicit KernelLauncher(WorkDevice& device)
    : Device(device)
  {
  }

  /// Resets times and progress for a new deformation.
  void Start();

  WorkDevice& GetDevice() { return this->Device; }
  OpenCLContext& GetContext() { return this->Device.GetContext(); }
  const cl::CommandQueue& GetQueue() { return this->Device.GetQueue(); }

  /// Enqueues a kernel.
  void Launch(const cl::Kernel& kernel, const cl::NDRange& items, const cl::NDRange& group);
  /// Enqueues a kernel, waits for the previous call of LaunchAndReport(), so that the device always
  /// has work, and reports progress. Throws Aborted if the progress callback returns false.
  void LaunchAndReport(const DeformRequest& request, const cl::Kernel& kernel,
    const cl::NDRange& items, const cl::NDRange& group);

  ///@{
  /// Set the expected number of further launches; add to it; or set a lower limit.
  void Expect(std::size_t launches) { this->Expected = this->Done + launches; }
  void ExpectMore(std::size_t launches) { this->Expected += launches; }
  void ExpectAtLeast(std::size_t launches);
  ///@}

  /// Adds a launch that maps vertices, unless null. All other launches count as resampling.
  void AddMapping(const cl::Event& launch);

  /// Adds the times of all launches, which must be finished, and resets them.
  void AddTimes(DeformReport& report);

private:
  WorkDevice& Device;
  std::vector<cl::Event> Mapping;
  std::vector<cl::Event> Resampling;
  cl::Event Last; // of LaunchAndReport()
  std::size_t Done = 0;
  std::size_t Expected = 1; // estimated total, including Done
  double Reported = 0.0;    // the last progress
};

} // namespace deformvolume

#endif
