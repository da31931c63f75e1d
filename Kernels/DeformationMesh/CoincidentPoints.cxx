// SPDX-License-Identifier: BSD-3-Clause
#include "CoincidentPoints.h"

#include "IndexBounds.h"

#include <cstddef>
#include <cstring>

namespace deformvolume
{

namespace
{

std::size_t GetHash(const glm::dvec3& point)
{
  std::uint64_t hash = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double value = point[axis] + 0.0; // -0 becomes 0, which equals it
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof(bits));
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15U;
    hash ^= hash >> 32;
  }
  return static_cast<std::size_t>(hash);
}

} // namespace

std::vector<std::int32_t> FindCoincidentPoints(const std::vector<glm::dvec3>& points)
{
  std::size_t size = 16;
  while (size < 2 * points.size())
  {
    size *= 2;
  }
  constexpr std::int32_t none = -1;
  std::vector<std::int32_t> table(size, none); // the first point at each position
  std::vector<std::int32_t> numbers(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const glm::dvec3& point = points[i];
    numbers[i] = static_cast<std::int32_t>(i);
    if (!IsFinite(point))
    {
      continue;
    }
    std::size_t place = GetHash(point) % size;
    while (table[place] != none && points[static_cast<std::size_t>(table[place])] != point)
    {
      place = (place + 1) % size;
    }
    if (table[place] == none)
    {
      table[place] = numbers[i];
    }
    numbers[i] = table[place];
  }
  return numbers;
}

} // namespace deformvolume
