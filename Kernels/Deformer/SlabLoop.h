// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSlabLoop_h
#define DeformVolumeSlabLoop_h

#include "DeformRequest.h"

#include <cstdint>

namespace deformvolume
{

class DeviceVolume;
class SlabResampler;
class WorkDevice;

/// Makes the whole output of a request, slab by slab as the device can allocate them, and brings it
/// to the memory of the request, unless it may stay on the device and is there in one slab. spare:
/// bytes of device memory that may be used beyond those of one slab.
void MakeSlabs(SlabResampler& resampler, WorkDevice& device, const DeviceVolume& volume,
  const DeformRequest& request, std::uint64_t spare, DeformReport& report);

} // namespace deformvolume

#endif
