// SPDX-License-Identifier: BSD-3-Clause
#include "Sheet.h"

#include "Error.h"
#include "ExactVectors.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

namespace deformvolume
{
namespace
{

constexpr double FarthestPoint = 2147483648.0; // voxels

bool ComesFirst(const SnappedPoint& a, const SnappedPoint& b)
{
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

std::int64_t GetLength(const SnappedPoint& a, const SnappedPoint& b)
{
  const SnappedPoint size = glm::abs(b - a);
  return std::max(size.x, std::max(size.y, size.z));
}

// The result does not depend on the order of the two ends. Division rounds towards zero, so that
// differences with equal absolute values are halved in the same way.
SnappedPoint GetMiddle(const SnappedPoint& a, const SnappedPoint& b)
{
  const SnappedPoint& first = ComesFirst(a, b) ? a : b;
  const SnappedPoint& second = ComesFirst(a, b) ? b : a;
  return first + (second - first) / std::int64_t{ 2 };
}

// Returns the index of the longest edge. Edge k leads from point k to the next point.
int FindLongestEdge(const SnappedTriangle& triangle)
{
  int longest = 0;
  for (int k = 1; k < 3; ++k)
  {
    if (GetLength(triangle[k], triangle[(k + 1) % 3]) >
      GetLength(triangle[longest], triangle[(longest + 1) % 3]))
    {
      longest = k;
    }
  }
  return longest;
}

} // namespace

Sheet::Sheet(const std::vector<glm::dvec3>& points, const std::vector<Triangle>& triangles)
{
  this->Triangles.reserve(triangles.size());
  for (const Triangle& triangle : triangles)
  {
    SnappedTriangle snapped;
    for (int k = 0; k < 3; ++k)
    {
      if (triangle[k] < 0 || triangle[k] >= static_cast<std::int64_t>(points.size()))
      {
        throw Error("A triangle of the sheet has point " + std::to_string(triangle[k]) +
          ", but there are " + std::to_string(points.size()) + " points. Correct the triangle.");
      }
      const glm::dvec3& point = points[static_cast<std::size_t>(triangle[k])];
      for (int axis = 0; axis < 3; ++axis)
      {
        // False for not-a-number, too.
        if (!(std::abs(point[axis]) <= FarthestPoint))
        {
          throw Error("Point " + std::to_string(triangle[k]) +
            " of the sheet is not finite, or more than 2^31 voxels away from index 0 of the "
            "volume. Correct the point.");
        }
      }
      snapped[k] = Snap(point);
      this->Box.Add(snapped[k]);
    }
    this->Triangles.push_back(snapped);
  }
}

bool Sheet::IsClosed() const
{
  std::vector<std::pair<SnappedPoint, SnappedPoint>> edges;
  edges.reserve(3 * this->Triangles.size());
  for (const SnappedTriangle& triangle : this->Triangles)
  {
    for (int k = 0; k < 3; ++k)
    {
      const SnappedPoint& a = triangle[k];
      const SnappedPoint& b = triangle[(k + 1) % 3];
      if (a != b)
      {
        edges.emplace_back(ComesFirst(a, b) ? a : b, ComesFirst(a, b) ? b : a);
      }
    }
  }
  std::sort(edges.begin(), edges.end(),
    [](const auto& a, const auto& b)
    { return a.first == b.first ? ComesFirst(a.second, b.second) : ComesFirst(a.first, b.first); });
  for (std::size_t begin = 0; begin < edges.size();)
  {
    std::size_t end = begin;
    while (end < edges.size() && edges[end] == edges[begin])
    {
      ++end;
    }
    if ((end - begin) % 2 != 0)
    {
      return false;
    }
    begin = end;
  }
  return true;
}

Sheet Sheet::Orient() const
{
  // A number for each position, and the triangles at each edge between two positions.
  using Coordinates = std::array<std::int64_t, 3>;
  std::map<Coordinates, int> numbers;
  std::map<std::array<int, 2>, std::vector<std::size_t>> edges;
  std::vector<std::array<int, 3>> corners;
  Sheet oriented = *this;
  oriented.Triangles.clear();
  std::set<std::array<int, 3>> known;
  for (const SnappedTriangle& triangle : this->Triangles)
  {
    std::array<int, 3> corner;
    for (std::size_t k = 0; k < 3; ++k)
    {
      const SnappedPoint& p = triangle[k];
      corner[k] =
        numbers.emplace(Coordinates{ { p.x, p.y, p.z } }, static_cast<int>(numbers.size()))
          .first->second;
    }
    // Leave out triangles with two equal corners, and repeated ones, which would connect others.
    std::array<int, 3> sorted = corner;
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2] || !known.insert(sorted).second)
    {
      continue;
    }
    corners.push_back(corner);
    oriented.Triangles.push_back(triangle);
    for (std::size_t k = 0; k < 3; ++k)
    {
      const auto ends = std::minmax(corner[k], corner[(k + 1) % 3]);
      edges[{ { ends.first, ends.second } }].push_back(corners.size() - 1);
    }
  }
  const auto goesFrom = [&corners](std::size_t triangle, int a, int b)
  {
    const std::array<int, 3>& c = corners[triangle];
    return (c[0] == a && c[1] == b) || (c[1] == a && c[2] == b) || (c[2] == a && c[0] == b);
  };
  std::vector<bool> isKnown(corners.size());
  for (std::size_t first = 0; first < corners.size(); ++first)
  {
    std::vector<std::size_t> rest;
    if (!isKnown[first])
    {
      rest.push_back(first);
      isKnown[first] = true;
    }
    while (!rest.empty())
    {
      const std::size_t triangle = rest.back();
      rest.pop_back();
      const std::array<int, 3> c = corners[triangle];
      for (std::size_t k = 0; k < 3; ++k)
      {
        const int a = c[k];
        const int b = c[(k + 1) % 3];
        const auto ends = std::minmax(a, b);
        const std::vector<std::size_t>& both = edges[{ { ends.first, ends.second } }];
        const std::size_t other = both.front() == triangle ? both.back() : both.front();
        if (both.size() != 2 || isKnown[other])
        {
          continue;
        }
        isKnown[other] = true;
        rest.push_back(other);
        if (goesFrom(other, a, b))
        {
          std::swap(corners[other][1], corners[other][2]);
          std::swap(oriented.Triangles[other][1], oriented.Triangles[other][2]);
        }
      }
    }
  }
  return oriented;
}

std::vector<SnappedTriangle> Sheet::Divide(const SnappedBox& within) const
{
  std::vector<SnappedTriangle> divided;
  std::vector<SnappedTriangle> rest;
  for (const SnappedTriangle& triangle : this->Triangles)
  {
    rest.push_back(triangle);
    while (!rest.empty())
    {
      const SnappedTriangle next = rest.back();
      rest.pop_back();
      if (!deformvolume::GetBox(next).Overlaps(within))
      {
        continue;
      }
      const int edge = FindLongestEdge(next);
      const SnappedPoint& a = next[edge];
      const SnappedPoint& b = next[(edge + 1) % 3];
      const SnappedPoint& c = next[(edge + 2) % 3];
      if (GetLength(a, b) > LongestTriangle)
      {
        const SnappedPoint middle = GetMiddle(a, b);
        rest.push_back({ { a, middle, c } });
        rest.push_back({ { middle, b, c } });
      }
      else if (FindSign(Cross(b - a, c - a)) != 0)
      {
        divided.push_back(next);
      }
    }
  }
  return divided;
}

} // namespace deformvolume
