// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSlabResampler_h
#define DeformVolumeSlabResampler_h

#include "DeformRequest.h"
#include "Extent.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace deformvolume
{

/// The division of an output into slabs.
struct SlabPlan
{
  std::vector<Extent> Slabs;
  /// Whether two slabs fit into memory, and the driver copies one to the caller while the device
  /// makes the other.
  bool Overlapped = false;

  /// Returns the target in which a slab is made, 0 or 1.
  std::size_t GetTarget(std::size_t slab) const { return this->Overlapped ? slab % 2 : 0; }
};

/// Interface of the resamplers, which make the output of a request slab by slab.
class SlabResampler
{
public:
  virtual ~SlabResampler() = default;

  /// Begins a new output. Throws an Error if it cannot be made.
  virtual void Begin(const DeformRequest& request, const SlabPlan& plan, DeformReport& report) = 0;
  /// Makes a slab in its target, after the previous slab there was copied to the memory of the
  /// request.
  virtual void Make(
    const DeformRequest& request, const SlabPlan& plan, std::size_t slab, DeformReport& report) = 0;
  /// Begins to copy a target to the memory of the request, in a separate queue. FinishReading() may
  /// have to do the copy.
  virtual void Read(const DeformRequest& request, std::size_t target) = 0;
  /// Leaves a target, which must be the whole output, on the device.
  virtual std::vector<std::shared_ptr<DeviceOutput>> KeepOnDevice(
    const DeformRequest& request, std::size_t target) = 0;
  /// Waits until all copies are finished. Throws cl::Error if a copy failed.
  virtual void FinishReading() = 0;
  /// Waits in any case, also after a failure, and releases the memory of the request. Does not
  /// throw.
  virtual void Finish() noexcept = 0;

  /// Calls Finish() when a scope is left, also by an exception.
  class FinishGuard
  {
  public:
    explicit FinishGuard(SlabResampler& resampler)
      : Resampler(resampler)
    {
    }
    ~FinishGuard() { this->Resampler.Finish(); }
    FinishGuard(const FinishGuard&) = delete;
    FinishGuard& operator=(const FinishGuard&) = delete;

  private:
    SlabResampler& Resampler;
  };
};

} // namespace deformvolume

#endif
