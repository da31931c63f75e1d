// SPDX-License-Identifier: BSD-3-Clause
#include "PointOrder.h"

#include "BoxPyramid.h"
#include "MortonCurve.h"
#include "ParallelFor.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace deformvolume
{

std::vector<std::int64_t> SortBySpace(const std::vector<glm::dvec3>& points)
{
  constexpr int bits = 6; // 262,144 cells: few for a counting sort, and small enough for caches
  constexpr std::size_t pointsPerPart = 16384;
  BoxPyramid::Box box;
  for (const glm::dvec3& point : points)
  {
    box.Add(point);
  }
  const glm::dvec3 scale =
    1.0 / glm::max(box.Max - box.Min, glm::dvec3(std::numeric_limits<double>::min()));
  std::vector<std::uint32_t> cells(points.size());
  ParallelForParts(points.size(), pointsPerPart,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        cells[i] = static_cast<std::uint32_t>(GetMortonNumber(scale * (points[i] - box.Min), bits));
      }
    });
  std::vector<std::size_t> next((std::size_t{ 1 } << (3 * bits)) + 1, 0);
  for (const std::uint32_t cell : cells)
  {
    ++next[cell + 1];
  }
  for (std::size_t cell = 1; cell < next.size(); ++cell)
  {
    next[cell] += next[cell - 1];
  }
  std::vector<std::int64_t> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    order[next[cells[i]]++] = static_cast<std::int64_t>(i);
  }
  return order;
}

} // namespace deformvolume
