// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceThreads_h
#define DeformVolumeDeviceThreads_h

namespace deformvolume
{

/// Makes PoCL start no more threads than the share of this process (GetProcessorShare), unless the
/// environment variable POCL_MAX_PTHREAD_COUNT is set. To be called before there is a device.
void LimitDeviceThreads();

} // namespace deformvolume

#endif
