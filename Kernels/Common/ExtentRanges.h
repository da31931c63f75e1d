// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeExtentRanges_h
#define DeformVolumeExtentRanges_h

#include "Extent.h"
#include "PointRanges.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace deformvolume
{

/// Above this number of rows it is as fast to process all points.
constexpr std::int64_t MostRows = 32768;

/// Returns the index ranges of all rows of the boxes in the extent `whole`, where x varies fastest.
/// Empty if there are more than MostRows rows.
inline std::optional<PointRanges> FindRows(const std::vector<Extent>& boxes, const Extent& whole)
{
  std::int64_t rows = 0;
  for (const Extent& box : boxes)
  {
    rows += GetSize(box, 1) * GetSize(box, 2);
  }
  if (rows > MostRows)
  {
    return {};
  }
  PointRanges ranges;
  ranges.reserve(static_cast<std::size_t>(rows));
  for (const Extent& box : boxes)
  {
    for (std::int64_t z = box[4]; z <= box[5]; ++z)
    {
      for (std::int64_t y = box[2]; y <= box[3]; ++y)
      {
        const std::int64_t row =
          ((z - whole[4]) * GetSize(whole, 1) + y - whole[2]) * GetSize(whole, 0) - whole[0];
        ranges.push_back({ { static_cast<std::size_t>(row + box[0]),
          static_cast<std::size_t>(row + box[1]) + 1 } });
      }
    }
  }
  return ranges;
}

} // namespace deformvolume

#endif
