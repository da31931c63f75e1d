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

/// Makes the whole output of a request, in slabs that the device can allocate. Copies them to the
/// memory of the request, unless the output may stay on the device and has a single slab. spare:
/// device memory, in bytes, that may be used in addition to one slab.
void MakeSlabs(SlabResampler& resampler, WorkDevice& device, const DeviceVolume& volume,
  const DeformRequest& request, std::uint64_t spare, DeformReport& report);

} // namespace deformvolume

#endif
