// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeExtent_h
#define DeformVolumeExtent_h

#include <array>
#include <cstdint>

namespace deformvolume
{

/// An extent in structured indices: x min, x max, y min, y max, z min, z max. Both ends belong to
/// the extent.
using Extent = std::array<int, 6>;

/// An extent without points.
inline constexpr Extent EmptyExtent{ { 0, -1, 0, -1, 0, -1 } };

/// Number of points of an extent along an axis. 0 if the extent is empty.
inline std::int64_t GetSize(const Extent& extent, int axis)
{
  const std::int64_t size = static_cast<std::int64_t>(extent[2 * axis + 1]) - extent[2 * axis] + 1;
  return size > 0 ? size : 0;
}
/// Number of points of an extent. 0 if the extent is empty.
inline std::int64_t GetNumberOfPoints(const Extent& extent)
{
  return GetSize(extent, 0) * GetSize(extent, 1) * GetSize(extent, 2);
}
/// Number of cells of an extent. 0 if an axis has fewer than two points.
inline std::int64_t GetNumberOfCells(const Extent& extent)
{
  std::int64_t cells = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    cells *= GetSize(extent, axis) > 1 ? GetSize(extent, axis) - 1 : 0;
  }
  return cells;
}

/// Enlarges an extent, which may be empty, to contain another extent, which must not be empty.
inline void Include(Extent& extent, const Extent& other)
{
  const bool isFirst = GetNumberOfPoints(extent) == 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    int& low = extent[2 * axis];
    int& high = extent[2 * axis + 1];
    low = isFirst || other[2 * axis] < low ? other[2 * axis] : low;
    high = isFirst || other[2 * axis + 1] > high ? other[2 * axis + 1] : high;
  }
}

/// Calls body(x, y, z) for the points of an extent, x varying fastest.
template <typename Body>
void ForEachPoint(const Extent& extent, Body&& body)
{
  for (int z = extent[4]; z <= extent[5]; ++z)
  {
    for (int y = extent[2]; y <= extent[3]; ++y)
    {
      for (int x = extent[0]; x <= extent[1]; ++x)
      {
        body(x, y, z);
      }
    }
  }
}

} // namespace deformvolume

#endif
