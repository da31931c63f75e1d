// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceThreads_h
#define DeformVolumeDeviceThreads_h

namespace deformvolume
{

/// Limits the threads of PoCL to the share of this process (GetProcessorShare()), unless the
/// environment variable POCL_MAX_PTHREAD_COUNT is set. Call this before PoCL starts.
void LimitDeviceThreads();

} // namespace deformvolume

#endif
