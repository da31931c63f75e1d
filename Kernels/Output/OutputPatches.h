// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputPatches_h
#define DeformVolumeOutputPatches_h

#include "DeformRequest.h"
#include "VolumeArray.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Counts the covered voxels of patches (see ChangeTracker) of a request's output, on the host,
/// in the memory of the request: for a few patches this is faster than launching a kernel. patches:
/// in ascending order.
std::uint64_t CountCoveredInPatches(
  const DeformRequest& request, const std::vector<std::uint32_t>& patches);

/// Sets all voxels of patches to the background of the arrays, and their coverage to 0, on the
/// host. arrays: of the volume.
void ClearPatches(const DeformRequest& request, const std::vector<VolumeArray>& arrays,
  const std::vector<std::uint32_t>& patches);

/// Copies patches of the last output to the memory of the request, if that is different memory.
void CopyPatches(const DeformRequest& request, const std::vector<VolumeArray>& arrays,
  const std::vector<std::uint32_t>& patches);

} // namespace deformvolume

#endif
