// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePointRanges_h
#define DeformVolumePointRanges_h

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace deformvolume
{

/// Ranges of point or mask indices: the first index of each range, and one past the last. Ranges
/// may overlap, and may be in any order.
using PointRanges = std::vector<std::array<std::size_t, 2>>;

/// Sets marked[n] to 1 for each block n of blockSize points that contains a point of the ranges.
inline void MarkBlocks(
  const PointRanges& ranges, std::size_t blockSize, std::vector<unsigned char>& marked)
{
  for (const auto& range : ranges)
  {
    const std::size_t end = std::min((range[1] + blockSize - 1) / blockSize, marked.size());
    for (std::size_t block = range[0] / blockSize; block < end; ++block)
    {
      marked[block] = 1;
    }
  }
}

} // namespace deformvolume

#endif
