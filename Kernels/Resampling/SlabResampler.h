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

/// The slabs that an output is made in.
struct SlabPlan
{
  std::vector<Extent> Slabs;
  /// Whether there is memory for two, and the driver copies one to the caller while the device
  /// works on the other.
  bool Overlapped = false;

  /// Which memory a slab is made in, 0 or 1.
  std::size_t GetTarget(std::size_t slab) const { return this->Overlapped ? slab % 2 : 0; }
};

/// A way to make the output of a request, one slab after the other.
class SlabResampler
{
public:
  virtual ~SlabResampler() = default;

  /// Begins a new output. Throws an Error where it cannot be made.
  virtual void Begin(const DeformRequest& request, const SlabPlan& plan, DeformReport& report) = 0;
  /// Makes a slab in its target, after what was there is in the memory of the request.
  virtual void Make(
    const DeformRequest& request, const SlabPlan& plan, std::size_t slab, DeformReport& report) = 0;
  /// Begins to copy a target to the memory of the request, in a queue of its own; FinishReading()
  /// may have to make the copy.
  virtual void Read(const DeformRequest& request, std::size_t target) = 0;
  /// Leaves a target on the device that is the whole output.
  virtual std::vector<std::shared_ptr<DeviceOutput>> Leave(
    const DeformRequest& request, std::size_t target) = 0;
  /// Waits until all that is read is there. Throws cl::Error where it did not get there.
  virtual void FinishReading() = 0;
  /// Waits, whatever has happened, and lets go of the memory of the request. Throws nothing.
  virtual void Finish() noexcept = 0;

  /// Finishes, however a scope is left.
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
