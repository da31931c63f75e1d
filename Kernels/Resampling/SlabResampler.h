// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSlabResampler_h
#define DeformVolumeSlabResampler_h

#include "DeformRequest.h"
#include "Extent.h"
#include "OutputMemory.h"

#include <cstddef>
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
  /// Returns target 0 or 1.
  virtual OutputMemory& GetTarget(std::size_t target) = 0;
  /// Waits until all copies of targets are finished. Throws cl::Error if a copy failed.
  void FinishReading()
  {
    this->GetTarget(0).FinishReading();
    this->GetTarget(1).FinishReading();
  }
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
