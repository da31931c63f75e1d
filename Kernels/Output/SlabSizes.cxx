// SPDX-License-Identifier: BSD-3-Clause
#include "SlabSizes.h"

#include "HostMemory.h"
#include "OutputWinners.h"

#include <algorithm>
#include <limits>

namespace deformvolume
{

std::uint64_t CountWords(std::uint64_t voxels)
{
  return (voxels + 31) / 32;
}

std::vector<Extent> SplitIntoSlabs(const Extent& output, const std::vector<VolumeArray>& arrays,
  const VoxelGrid& voxelGrid, std::uint64_t allocationLimit)
{
  std::uint64_t widest = GetWinnerSize(voxelGrid);
  for (const VolumeArray& array : arrays)
  {
    widest = std::max<std::uint64_t>(widest, GetTupleSize(array));
  }
  const std::uint64_t voxels =
    static_cast<std::uint64_t>(GetSize(output, 0)) * static_cast<std::uint64_t>(GetSize(output, 1));
  const std::uint64_t plane = voxels * widest;
  CheckAllocation(
    plane, allocationLimit, "The values of a slice of the output", "Use smaller output bounds");
  // Resampling by lanes and columns counts the voxels of a slab with 32 bits.
  constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max();
  const std::uint64_t planes =
    std::max<std::uint64_t>(std::min(allocationLimit / plane, most / voxels), 1);
  std::vector<Extent> slabs;
  for (std::int64_t z = output[4]; z <= output[5];)
  {
    Extent slab = output;
    slab[4] = static_cast<int>(z);
    slab[5] = static_cast<int>(
      std::min<std::int64_t>(output[5], z + static_cast<std::int64_t>(planes) - 1));
    slabs.push_back(slab);
    z = std::int64_t{ slab[5] } + 1;
  }
  return slabs;
}

std::uint64_t GetOutputBytesPerVoxel(const OpenCLContext& context,
  const std::vector<VolumeArray>& arrays, const DeformRequest& request)
{
  std::uint64_t bytes = CanWorkInPlace(context, request.Coverage, 1) ? 0 : 1;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    if (!CanWorkInPlace(context, request.Outputs[i], GetElementSize(arrays[i].Type)))
    {
      bytes += GetTupleSize(arrays[i]);
    }
  }
  return bytes;
}

} // namespace deformvolume
