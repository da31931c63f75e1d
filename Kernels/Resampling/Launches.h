// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLaunches_h
#define DeformVolumeLaunches_h

#include "DeformRequest.h"
#include "OpenCLContext.h"

#include <cstddef>
#include <vector>

namespace deformvolume
{

class WorkDevice;

/// The launches of a deformation: their times and the progress by their number.
class Launches
{
public:
  explicit Launches(WorkDevice& device)
    : Device(device)
  {
  }

  /// Resets times and progress for a new deformation.
  void Start();

  /// Enqueues a resampling kernel, waits for the previous launch, so that the device always has
  /// work, and reports progress. Throws Aborted if the progress callback returns false.
  void Run(const DeformRequest& request, const cl::Kernel& kernel, const cl::NDRange& items,
    const cl::NDRange& group);

  ///@{
  /// Set the expected number of further launches; add to it; or set a lower limit.
  void Expect(std::size_t launches) { this->Expected = this->Done + launches; }
  void ExpectMore(std::size_t launches) { this->Expected += launches; }
  void ExpectAtLeast(std::size_t launches);
  ///@}

  /// The events of launches that map vertices, and of launches that resample. Other classes add the
  /// events of their launches.
  std::vector<cl::Event>& GetMappingEvents() { return this->MappingEvents; }
  std::vector<cl::Event>& GetResamplingEvents() { return this->ResamplingEvents; }

  /// Adds the times of all launches, which must be finished, and resets them.
  void AddTimes(DeformReport& report);

private:
  WorkDevice& Device;
  std::vector<cl::Event> MappingEvents;
  std::vector<cl::Event> ResamplingEvents;
  cl::Event Last;
  std::size_t Done = 0;
  std::size_t Expected = 1; // estimated total, including Done
  double Reported = 0.0;    // the last progress
};

} // namespace deformvolume

#endif
