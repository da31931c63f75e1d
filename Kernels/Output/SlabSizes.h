// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSlabSizes_h
#define DeformVolumeSlabSizes_h

#include "DeformRequest.h"
#include "Extent.h"
#include "VolumeArray.h"
#include "VoxelGrid.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

class OpenCLContext;

/// Splits an output into slabs that the device can allocate. Throws an Error if not even one plane
/// fits.
std::vector<Extent> SplitIntoSlabs(const Extent& output, const std::vector<VolumeArray>& arrays,
  const VoxelGrid& voxelGrid, std::uint64_t allocationLimit);

/// Returns the number of 32-bit words of coverage stored as bits.
std::uint64_t CountWords(std::uint64_t voxels);

/// Returns the device memory per output voxel of the request, in bytes: of the arrays and the
/// coverage that are not written in place.
std::uint64_t GetOutputBytesPerVoxel(const OpenCLContext& context,
  const std::vector<VolumeArray>& arrays, const DeformRequest& request);

} // namespace deformvolume

#endif
