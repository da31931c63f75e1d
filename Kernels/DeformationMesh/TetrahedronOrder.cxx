// SPDX-License-Identifier: BSD-3-Clause
#include "TetrahedronOrder.h"

#include "CoincidentPoints.h"
#include "DisjointSets.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace deformvolume
{

namespace
{

// Returns a negative number if a is lower than b, a positive one if it is higher, else 0.
int ComparePositions(const glm::dvec3& a, const glm::dvec3& b)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    if (a[axis] != b[axis])
    {
      return a[axis] < b[axis] ? -1 : 1;
    }
  }
  return 0;
}

} // namespace

TetrahedronOrder::TetrahedronOrder(
  const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra)
  : Points(points)
  , Tetrahedra(tetrahedra)
{
}

void TetrahedronOrder::RankBodies() const
{
  const auto at = [&](std::int32_t node) -> const glm::dvec3&
  { return this->Points[static_cast<std::size_t>(node)]; };
  const std::vector<std::int32_t> places = FindCoincidentPoints(this->Points);
  const auto getPlace = [&](std::int32_t node) { return places[static_cast<std::size_t>(node)]; };
  DisjointSets<std::int32_t> bodies(this->Points.size());
  for (const Tetrahedron& nodes : this->Tetrahedra)
  {
    for (const std::int32_t node : nodes)
    {
      bodies.Unite(getPlace(nodes[0]), getPlace(node));
    }
  }
  // A body has the number of one of its nodes.
  std::vector<std::int32_t> order;
  std::vector<double> volumes(this->Points.size(), 0.0);
  std::vector<std::int32_t> lowest(this->Points.size(), -1);
  for (const Tetrahedron& nodes : this->Tetrahedra)
  {
    const auto body = static_cast<std::size_t>(bodies.Find(getPlace(nodes[0])));
    if (lowest[body] < 0)
    {
      order.push_back(static_cast<std::int32_t>(body));
      lowest[body] = nodes[0];
    }
    const glm::dvec3& last = at(nodes[3]);
    volumes[body] +=
      std::abs(glm::dot(at(nodes[0]) - last, glm::cross(at(nodes[1]) - last, at(nodes[2]) - last)));
    for (const std::int32_t node : nodes)
    {
      lowest[body] = ComparePositions(at(node), at(lowest[body])) < 0 ? node : lowest[body];
    }
  }
  std::sort(order.begin(), order.end(),
    [&](std::int32_t a, std::int32_t b)
    {
      // The order of the tetrahedra, and the axes of the points, change the last bits of a volume.
      const auto first = static_cast<float>(volumes[static_cast<std::size_t>(a)]);
      const auto second = static_cast<float>(volumes[static_cast<std::size_t>(b)]);
      return first != second ? first < second
                             : ComparePositions(at(lowest[static_cast<std::size_t>(a)]),
                                 at(lowest[static_cast<std::size_t>(b)])) < 0;
    });
  std::vector<std::int32_t> ranks(this->Points.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank)
  {
    ranks[static_cast<std::size_t>(order[rank])] = static_cast<std::int32_t>(rank);
  }
  this->Ranks.reserve(this->Tetrahedra.size());
  for (const Tetrahedron& nodes : this->Tetrahedra)
  {
    this->Ranks.push_back(ranks[static_cast<std::size_t>(bodies.Find(getPlace(nodes[0])))]);
  }
}

bool TetrahedronOrder::AreInOneBody(std::int32_t a, std::int32_t b) const
{
  const auto first = static_cast<std::size_t>(a);
  const auto second = static_cast<std::size_t>(b);
  const Tetrahedron& nodes = this->Tetrahedra[first];
  const Tetrahedron& others = this->Tetrahedra[second];
  if (std::find_first_of(nodes.begin(), nodes.end(), others.begin(), others.end()) != nodes.end())
  {
    return true;
  }
  std::call_once(this->Once, [this] { this->RankBodies(); });
  return this->Ranks[first] == this->Ranks[second];
}

bool TetrahedronOrder::ComesBefore(std::int32_t a, std::int32_t b) const
{
  const auto first = static_cast<std::size_t>(a);
  const auto second = static_cast<std::size_t>(b);
  if (!this->AreInOneBody(a, b))
  {
    return this->Ranks[first] < this->Ranks[second];
  }
  for (std::size_t node = 0; node < 4; ++node)
  {
    const int compared =
      ComparePositions(this->Points[static_cast<std::size_t>(this->Tetrahedra[first][node])],
        this->Points[static_cast<std::size_t>(this->Tetrahedra[second][node])]);
    if (compared != 0)
    {
      return compared < 0;
    }
  }
  return a < b;
}

} // namespace deformvolume
