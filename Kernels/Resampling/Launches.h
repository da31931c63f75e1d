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

/// The launches of a deformation: how long they take, and how far it is by their number.
class Launches
{
public:
  explicit Launches(WorkDevice& device)
    : Device(device)
  {
  }

  /// Of a new deformation nothing was launched yet.
  void Start();

  /// Enqueues a kernel that resamples, then waits for the launch before, so that the device always
  /// has work, and reports the progress. Throws Aborted where the request says so.
  void Run(const DeformRequest& request, const cl::Kernel& kernel, const cl::NDRange& items,
    const cl::NDRange& group);

  ///@{
  /// So many launches are to come; or so many more than were expected; or no fewer.
  void Expect(std::size_t launches) { this->Expected = this->Done + launches; }
  void ExpectMore(std::size_t launches) { this->Expected += launches; }
  void ExpectAtLeast(std::size_t launches);
  ///@}

  /// Of launches that map vertices, and of those that resample; what is launched elsewhere is added
  /// there.
  std::vector<cl::Event>& GetMappingEvents() { return this->MappingEvents; }
  std::vector<cl::Event>& GetResamplingEvents() { return this->ResamplingEvents; }

  /// Adds the times of all launches, which have ended, and forgets them.
  void AddTimes(DeformReport& report);

private:
  WorkDevice& Device;
  std::vector<cl::Event> MappingEvents;
  std::vector<cl::Event> ResamplingEvents;
  cl::Event Last;
  std::size_t Done = 0;
  std::size_t Expected = 1; // with those that are done, as far as is known
};

} // namespace deformvolume

#endif
