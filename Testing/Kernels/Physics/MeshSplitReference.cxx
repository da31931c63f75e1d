// SPDX-License-Identifier: BSD-3-Clause
#include "MeshSplitReference.h"

#include <algorithm>
#include <map>
#include <set>

namespace physicsTesting
{

using namespace deformvolume;

namespace
{

using Vector = std::array<long double, 3>;

Vector Subtract(const glm::dvec3& a, const glm::dvec3& b)
{
  return { { static_cast<long double>(a.x) - b.x, static_cast<long double>(a.y) - b.y,
    static_cast<long double>(a.z) - b.z } };
}

int GetOrientation(
  const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d)
{
  const Vector u = Subtract(b, a);
  const Vector v = Subtract(c, a);
  const Vector w = Subtract(d, a);
  const long double determinant = u[0] * (v[1] * w[2] - v[2] * w[1]) +
    u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
  return (determinant > 0.0L ? 1 : 0) - (determinant < 0.0L ? 1 : 0);
}

// Whether the segment from p to q crosses the triangle: 1, 0, or -1 if the segment touches its
// border or plane.
int Crosses(const glm::dvec3& p, const glm::dvec3& q, const std::array<glm::dvec3, 3>& t)
{
  const int above = GetOrientation(t[0], t[1], t[2], p);
  const int below = GetOrientation(t[0], t[1], t[2], q);
  const int sides[3] = { GetOrientation(p, q, t[0], t[1]), GetOrientation(p, q, t[1], t[2]),
    GetOrientation(p, q, t[2], t[0]) };
  if (above * below > 0)
  {
    return 0;
  }
  const bool isApart =
    *std::min_element(sides, sides + 3) < 0 && *std::max_element(sides, sides + 3) > 0;
  if (isApart)
  {
    return 0;
  }
  return above * below * sides[0] * sides[1] * sides[2] == 0 ? -1 : 1;
}

struct SlowSplit
{
  const std::vector<glm::dvec3>& Positions;
  const std::vector<Tetrahedron>& Tetrahedra;
  const std::vector<glm::dvec3>& Points;
  const SheetTriangles& Triangles;

  glm::dvec3 GetCentroid(std::size_t t) const
  {
    glm::dvec3 sum(0.0);
    for (const std::int32_t node : this->Tetrahedra[t])
    {
      sum += this->Positions[static_cast<std::size_t>(node)];
    }
    return 0.25 * sum;
  }

  // How often the sheet crosses the segment between two centroids, or -1 if that is undecided.
  int Count(std::size_t a, std::size_t b) const
  {
    int count = 0;
    for (const auto& triangle : this->Triangles)
    {
      std::array<glm::dvec3, 3> corners;
      std::transform(triangle.begin(), triangle.end(), corners.begin(),
        [&](std::int64_t point) { return this->Points[static_cast<std::size_t>(point)]; });
      const int crosses = Crosses(this->GetCentroid(a), this->GetCentroid(b), corners);
      if (crosses < 0)
      {
        return -1;
      }
      count += crosses;
    }
    return count;
  }

  // The nodes that two tetrahedra share.
  std::set<std::int32_t> GetCommon(
    std::size_t a, std::size_t b, const std::vector<Tetrahedron>& in) const
  {
    std::set<std::int32_t> common;
    for (const std::int32_t node : in[a])
    {
      if (std::count(in[b].begin(), in[b].end(), node) > 0)
      {
        common.insert(node);
      }
    }
    return common;
  }
};

} // namespace

std::optional<MeshSplit> SplitMeshSlowly(const std::vector<glm::dvec3>& positions,
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<glm::dvec3>& points,
  const SheetTriangles& triangles, const std::vector<TetrahedronPair>& unparted)
{
  const SlowSplit slow{ positions, tetrahedra, points, triangles };
  MeshSplit split;
  split.Tetrahedra = tetrahedra;
  split.StillConnected = unparted;
  std::map<std::size_t, std::vector<std::size_t>>
    joined; // tetrahedra connected by faces that are not split
  std::set<std::int32_t> nodes;
  for (std::size_t a = 0; a < tetrahedra.size(); ++a)
  {
    for (std::size_t b = a + 1; b < tetrahedra.size(); ++b)
    {
      const std::set<std::int32_t> common = slow.GetCommon(a, b, tetrahedra);
      if (common.size() != 3)
      {
        continue;
      }
      const TetrahedronPair pair{ { static_cast<std::int32_t>(a), static_cast<std::int32_t>(b) } };
      if (std::count(unparted.begin(), unparted.end(), pair) > 0)
      {
        continue;
      }
      const int count = slow.Count(a, b);
      if (count < 0)
      {
        return std::nullopt;
      }
      if (count % 2 == 0)
      {
        joined[a].push_back(b);
        joined[b].push_back(a);
        continue;
      }
      nodes.insert(common.begin(), common.end());
      split.StillConnected.push_back(pair);
      ++split.NumberOfFaces;
    }
  }
  std::set<std::size_t> changed;
  for (const std::int32_t node : nodes)
  {
    std::set<std::size_t> rest;
    for (std::size_t t = 0; t < tetrahedra.size(); ++t)
    {
      if (std::count(tetrahedra[t].begin(), tetrahedra[t].end(), node) > 0)
      {
        rest.insert(t);
      }
    }
    for (std::int32_t name = node; !rest.empty();)
    {
      std::vector<std::size_t> part{ *rest.begin() };
      rest.erase(rest.begin());
      for (std::size_t i = 0; i < part.size(); ++i)
      {
        for (const std::size_t other : joined[part[i]])
        {
          if (rest.erase(other) > 0)
          {
            part.push_back(other);
          }
        }
      }
      for (const std::size_t t : part)
      {
        std::replace(split.Tetrahedra[t].begin(), split.Tetrahedra[t].end(), node, name);
        if (name != node)
        {
          changed.insert(t);
        }
      }
      if (!rest.empty())
      {
        name = static_cast<std::int32_t>(positions.size() + split.Origins.size());
        split.Origins.push_back(node);
      }
    }
  }
  split.Changed.assign(changed.begin(), changed.end());
  split.StillConnected.erase(
    std::remove_if(split.StillConnected.begin(), split.StillConnected.end(),
      [&](const TetrahedronPair& pair)
      {
        return slow
                 .GetCommon(static_cast<std::size_t>(pair[0]), static_cast<std::size_t>(pair[1]),
                   split.Tetrahedra)
                 .size() < 3;
      }),
    split.StillConnected.end());
  std::sort(split.StillConnected.begin(), split.StillConnected.end());
  return split;
}

} // namespace physicsTesting
