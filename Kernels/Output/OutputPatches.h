// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputPatches_h
#define DeformVolumeOutputPatches_h

#include "DeformRequest.h"
#include "VolumeArray.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The voxels of some patches (see IncrementalUpdate) of a request's output that the deformed
/// volume covers. By the host, in the memory of the request: for a few patches that takes less time
/// than the launch of a kernel. patches: in ascending order.
std::uint64_t CountCoveredInPatches(
  const DeformRequest& request, const std::vector<std::uint32_t>& patches);

/// Gives all voxels of the patches the arrays' background, and covers none, by the host as well.
/// arrays: those of the volume.
void ClearPatches(const DeformRequest& request, const std::vector<VolumeArray>& arrays,
  const std::vector<std::uint32_t>& patches);

/// Copies patches of the last output to the request's memory, where that is another.
void CopyPatches(const DeformRequest& request, const std::vector<VolumeArray>& arrays,
  const std::vector<std::uint32_t>& patches);

} // namespace deformvolume

#endif
