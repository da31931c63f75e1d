// SPDX-License-Identifier: BSD-3-Clause
#include "ClosestFace.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace deformvolume
{

namespace
{

constexpr std::int32_t LargestLeaf = 4;
// Relative rounding error by which the squared distance to a triangle may be less than the squared
// distance to its bounding box.
constexpr double RoundingMargin = 1e-9;

double GetSquaredDistance(const glm::dvec3& point, const glm::dvec3& min, const glm::dvec3& max)
{
  const glm::dvec3 offset = point - glm::clamp(point, min, max);
  return glm::dot(offset, offset);
}

// Returns the barycentric weights of the point of a triangle that is closest to another point. The
// signs of dot products decide whether the closest point is a corner, on an edge or inside.
glm::dvec3 FindWeights(const glm::dvec3& point, const ClosestFace::Triangle& triangle)
{
  const glm::dvec3 ab = triangle[1] - triangle[0];
  const glm::dvec3 ac = triangle[2] - triangle[0];
  const glm::dvec3 ap = point - triangle[0];
  const double abAlongA = glm::dot(ab, ap);
  const double acAlongA = glm::dot(ac, ap);
  if (abAlongA <= 0.0 && acAlongA <= 0.0)
  {
    return glm::dvec3(1.0, 0.0, 0.0);
  }
  const glm::dvec3 bp = point - triangle[1];
  const double abAlongB = glm::dot(ab, bp);
  const double acAlongB = glm::dot(ac, bp);
  if (abAlongB >= 0.0 && acAlongB <= abAlongB)
  {
    return glm::dvec3(0.0, 1.0, 0.0);
  }
  const double c = abAlongA * acAlongB - abAlongB * acAlongA;
  if (c <= 0.0 && abAlongA >= 0.0 && abAlongB <= 0.0)
  {
    const double along = abAlongA / (abAlongA - abAlongB);
    return glm::dvec3(1.0 - along, along, 0.0);
  }
  const glm::dvec3 cp = point - triangle[2];
  const double abAlongC = glm::dot(ab, cp);
  const double acAlongC = glm::dot(ac, cp);
  if (acAlongC >= 0.0 && abAlongC <= acAlongC)
  {
    return glm::dvec3(0.0, 0.0, 1.0);
  }
  const double b = abAlongC * acAlongA - abAlongA * acAlongC;
  if (b <= 0.0 && acAlongA >= 0.0 && acAlongC <= 0.0)
  {
    const double along = acAlongA / (acAlongA - acAlongC);
    return glm::dvec3(1.0 - along, 0.0, along);
  }
  const double a = abAlongB * acAlongC - abAlongC * acAlongB;
  const double beyondB = acAlongB - abAlongB;
  const double beyondC = abAlongC - acAlongC;
  if (a <= 0.0 && beyondB >= 0.0 && beyondC >= 0.0)
  {
    const double along = beyondB / (beyondB + beyondC);
    return glm::dvec3(0.0, 1.0 - along, along);
  }
  const double scale = 1.0 / (a + b + c);
  return glm::dvec3(1.0 - (b + c) * scale, b * scale, c * scale);
}

} // namespace

ClosestFace::ClosestFace(std::vector<Triangle> triangles)
  : Triangles(std::move(triangles))
{
  std::vector<glm::dvec3> centers;
  centers.reserve(this->Triangles.size());
  for (const Triangle& triangle : this->Triangles)
  {
    this->Order.push_back(static_cast<std::int32_t>(centers.size()));
    centers.push_back(triangle[0] + triangle[1] + triangle[2]);
  }
  if (!this->Order.empty())
  {
    this->Build(0, static_cast<std::int32_t>(this->Order.size()), centers);
  }
}

void ClosestFace::Build(
  std::int32_t begin, std::int32_t end, const std::vector<glm::dvec3>& centers)
{
  const std::size_t index = this->Nodes.size();
  Node& node = this->Nodes.emplace_back();
  node.Begin = begin;
  node.End = end;
  node.Min = node.Max = this->Triangles[static_cast<std::size_t>(this->Order[begin])][0];
  glm::dvec3 low = centers[static_cast<std::size_t>(this->Order[begin])];
  glm::dvec3 high = low;
  for (std::int32_t i = begin; i < end; ++i)
  {
    const auto face = static_cast<std::size_t>(this->Order[i]);
    for (const glm::dvec3& corner : this->Triangles[face])
    {
      node.Min = glm::min(node.Min, corner);
      node.Max = glm::max(node.Max, corner);
    }
    low = glm::min(low, centers[face]);
    high = glm::max(high, centers[face]);
  }
  if (end - begin <= LargestLeaf)
  {
    return;
  }
  node.End = 0;
  const glm::dvec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::int32_t middle = begin + (end - begin) / 2;
  std::nth_element(this->Order.begin() + begin, this->Order.begin() + middle,
    this->Order.begin() + end,
    [&](std::int32_t a, std::int32_t b)
    {
      const double atA = centers[static_cast<std::size_t>(a)][axis];
      const double atB = centers[static_cast<std::size_t>(b)][axis];
      return atA != atB ? atA < atB : a < b;
    });
  this->Build(begin, middle, centers);
  this->Nodes[index].Upper = static_cast<std::int32_t>(this->Nodes.size());
  this->Build(middle, end, centers);
}

void ClosestFace::Look(const glm::dvec3& point, std::int32_t face, Result& best) const
{
  const Triangle& triangle = this->Triangles[static_cast<std::size_t>(face)];
  const glm::dvec3 weights = FindWeights(point, triangle);
  // Differences avoid cancellation of large coordinates.
  const glm::dvec3 offset = (point - triangle[0]) - weights.y * (triangle[1] - triangle[0]) -
    weights.z * (triangle[2] - triangle[0]);
  const double squared = glm::dot(offset, offset);
  if (squared < best.SquaredDistance || (squared == best.SquaredDistance && face < best.Face))
  {
    best.Face = face;
    best.SquaredDistance = squared;
    best.Weights = weights;
  }
}

ClosestFace::Result ClosestFace::Find(const glm::dvec3& point, std::int32_t nearby) const
{
  Result best;
  if (this->Nodes.empty())
  {
    return best;
  }
  if (nearby >= 0)
  {
    this->Look(point, nearby, best);
  }
  struct Entry
  {
    std::int32_t Node;
    double SquaredDistance;
  };
  // The depth of the tree is at most 31.
  Entry stack[64];
  int depth = 0;
  stack[depth++] = { 0, 0.0 };
  while (depth > 0)
  {
    const Entry entry = stack[--depth];
    const auto isTooFar = [&](double squared)
    { return squared > best.SquaredDistance * (1.0 + RoundingMargin); };
    if (isTooFar(entry.SquaredDistance))
    {
      continue;
    }
    const Node& node = this->Nodes[static_cast<std::size_t>(entry.Node)];
    if (node.End > 0)
    {
      for (std::int32_t i = node.Begin; i < node.End; ++i)
      {
        this->Look(point, this->Order[static_cast<std::size_t>(i)], best);
      }
      continue;
    }
    const auto enter = [&](std::int32_t child)
    {
      const Node& box = this->Nodes[static_cast<std::size_t>(child)];
      return Entry{ child, GetSquaredDistance(point, box.Min, box.Max) };
    };
    Entry near = enter(entry.Node + 1);
    Entry far = enter(node.Upper);
    if (far.SquaredDistance < near.SquaredDistance)
    {
      std::swap(near, far);
    }
    if (!isTooFar(far.SquaredDistance))
    {
      stack[depth++] = far;
    }
    if (!isTooFar(near.SquaredDistance))
    {
      stack[depth++] = near;
    }
  }
  return best;
}

} // namespace deformvolume
