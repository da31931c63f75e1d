// SPDX-License-Identifier: BSD-3-Clause
#include "SlabLoop.h"

#include "DeviceVolume.h"
#include "HostMemory.h"
#include "SlabResampler.h"
#include "SlabSizes.h"
#include "WorkDevice.h"

#include <chrono>

namespace deformvolume
{

void MakeSlabs(SlabResampler& resampler, WorkDevice& device, const DeviceVolume& volume,
  const DeformRequest& request, std::uint64_t spare, DeformReport& report)
{
  using Clock = std::chrono::steady_clock;
  const std::vector<VolumeArray>& arrays = volume.GetArrays().Get();
  SlabPlan plan;
  plan.Slabs = SplitIntoSlabs(
    request.OutputExtent, arrays, volume.GetVoxelGrid(), device.GetAllocationLimit());
  const std::uint64_t bytes = GetOutputBytesPerVoxel(device.GetContext(), arrays, request) *
    static_cast<std::uint64_t>(GetNumberOfPoints(plan.Slabs.front()));
  const bool stays =
    request.MayStayOnDevice && !device.GetDevice().IsProcessor && plan.Slabs.size() == 1;
  // Staged copies are finished by the host, so they cannot overlap with the next slab.
  plan.Overlapped =
    bytes > 0 && plan.Slabs.size() > 1 && spare >= bytes && !device.GetContext().GetStagedCopies();
  // Also after an exception, nothing may write to the memory of the request any more.
  const SlabResampler::FinishGuard finish(resampler);
  const QueueGuard reads(device.GetReadQueue());
  resampler.Begin(request, plan, report);
  for (std::size_t slab = 0; slab < plan.Slabs.size(); ++slab)
  {
    resampler.Make(request, plan, slab, report);
    OutputMemory& target = resampler.GetTarget(plan.GetTarget(slab));
    if (stays)
    {
      report.DeviceOutputs = target.KeepOnDevice(device.GetReadQueue());
      continue;
    }
    const Clock::time_point begin = Clock::now();
    target.Read(device.GetReadQueue(), target.GetExtent());
    if (!plan.Overlapped || slab + 1 == plan.Slabs.size())
    {
      resampler.FinishReading();
    }
    report.TransferTime += std::chrono::duration<double>(Clock::now() - begin).count();
  }
}

} // namespace deformvolume
