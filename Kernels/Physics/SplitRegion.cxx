// SPDX-License-Identifier: BSD-3-Clause
#include "SplitRegion.h"

#include "ParallelFor.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace deformvolume
{
namespace
{

constexpr std::size_t TetrahedraAtOnce = 16384;

SnappedPoint RoundPoint(const glm::dvec3& point)
{
  return SnappedPoint(std::llround(point.x), std::llround(point.y), std::llround(point.z));
}

// Let g be the centroid of a face, and a and b the nodes opposite to this face in its two
// tetrahedra. The centroids of the tetrahedra are g + (a - g) / 4 and g + (b - g) / 4. A point of
// the segment between them is g + t (a - g) / 4, which lies in the first tetrahedron, plus (1 - t)
// (b - g) / 4. Of the two tetrahedra take the one whose opposite node is farther from g. The point
// lies in the box of this tetrahedron, enlarged by a quarter of its longest side. Two more steps
// allow for rounding.
SnappedBox GetEnlargedBox(
  const std::vector<glm::dvec3>& positions, const Tetrahedron& tetrahedron, const MeshSteps& steps)
{
  constexpr double rounding = 2.0;
  const auto corner = [&](std::size_t i) -> const glm::dvec3&
  { return positions[static_cast<std::size_t>(tetrahedron[i])]; };
  const glm::dvec3 low =
    steps.Get(glm::min(glm::min(corner(0), corner(1)), glm::min(corner(2), corner(3))));
  const glm::dvec3 high =
    steps.Get(glm::max(glm::max(corner(0), corner(1)), glm::max(corner(2), corner(3))));
  const glm::dvec3 size = high - low;
  const double margin = 0.25 * std::max(size.x, std::max(size.y, size.z)) + rounding;
  // All points of the segment lie within the mesh, so the box is clamped to the mesh.
  SnappedBox box;
  box.Min = SnappedPoint(glm::max(low - margin, 0.0));
  box.Max = SnappedPoint(glm::min(high + margin, static_cast<double>(MeshSteps::Length)));
  return box;
}

// Returns the tetrahedra for which isChosen(t) is true, in ascending order.
template <typename IsChosen>
std::vector<std::size_t> SelectNumbers(std::size_t count, IsChosen&& isChosen)
{
  return CollectItems<std::size_t>(count, TetrahedraAtOnce,
    [&](std::size_t t, std::vector<std::size_t>& chosen)
    {
      if (isChosen(t))
      {
        chosen.push_back(t);
      }
    });
}

} // namespace

SplitRegion::SplitRegion(const std::vector<glm::dvec3>& positions,
  const std::vector<Tetrahedron>& tetrahedra, const MeshSteps& steps,
  const SheetCrossings& crossings)
{
  const std::vector<std::size_t> near = SelectNumbers(tetrahedra.size(),
    [&](std::size_t t)
    { return crossings.MayIntersect(GetEnlargedBox(positions, tetrahedra[t], steps)); });
  std::vector<unsigned char> isNodeOfNear(positions.size(), 0);
  for (const std::size_t t : near)
  {
    for (const std::int32_t node : tetrahedra[t])
    {
      isNodeOfNear[static_cast<std::size_t>(node)] = 1;
    }
  }
  if (!near.empty())
  {
    const auto hasNode = [&](std::int32_t node)
    { return isNodeOfNear[static_cast<std::size_t>(node)]; };
    this->Numbers = SelectNumbers(tetrahedra.size(),
      [&](std::size_t t)
      {
        const Tetrahedron& nodes = tetrahedra[t];
        return (hasNode(nodes[0]) | hasNode(nodes[1]) | hasNode(nodes[2]) | hasNode(nodes[3])) != 0;
      });
  }
  this->NumberNodes(tetrahedra, positions.size());
  this->Near.assign(this->Numbers.size(), 0);
  auto next = near.begin();
  for (std::size_t t = 0; t < this->Numbers.size() && next != near.end(); ++t)
  {
    if (this->Numbers[t] == *next)
    {
      this->Near[t] = 1;
      ++next;
    }
  }
  this->Centroids.resize(this->Numbers.size());
  ParallelForItems(this->Numbers.size(), TetrahedraAtOnce,
    [&](std::size_t t)
    {
      glm::dvec3 sum(0.0);
      for (const std::int32_t node : tetrahedra[this->Numbers[t]])
      {
        sum += steps.Get(positions[static_cast<std::size_t>(node)]);
      }
      this->Centroids[t] = RoundPoint(0.25 * sum);
    });
}

std::size_t SplitRegion::Find(std::size_t number) const
{
  const auto found = std::lower_bound(this->Numbers.begin(), this->Numbers.end(), number);
  return found != this->Numbers.end() && *found == number
    ? static_cast<std::size_t>(found - this->Numbers.begin())
    : this->Numbers.size();
}

void SplitRegion::NumberNodes(const std::vector<Tetrahedron>& tetrahedra, std::size_t numberOfNodes)
{
  constexpr std::int32_t absent = -1;
  std::vector<std::int32_t> numbers(numberOfNodes, absent);
  for (const std::size_t t : this->Numbers)
  {
    for (const std::int32_t node : tetrahedra[t])
    {
      numbers[static_cast<std::size_t>(node)] = 0;
    }
  }
  for (std::size_t node = 0; node < numberOfNodes; ++node)
  {
    if (numbers[node] != absent)
    {
      numbers[node] = static_cast<std::int32_t>(this->Nodes.size());
      this->Nodes.push_back(static_cast<std::int32_t>(node));
    }
  }
  this->Tetrahedra.reserve(this->Numbers.size());
  for (const std::size_t t : this->Numbers)
  {
    Tetrahedron local = tetrahedra[t];
    for (std::int32_t& node : local)
    {
      node = numbers[static_cast<std::size_t>(node)];
    }
    this->Tetrahedra.push_back(local);
  }
}

} // namespace deformvolume
