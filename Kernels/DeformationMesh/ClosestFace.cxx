// SPDX-License-Identifier: BSD-3-Clause
#include "ClosestFace.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <cstddef>
#include <utility>

namespace deformvolume
{

namespace
{

// Relative rounding error of squared distances to a triangle and to its bounding box.
constexpr double RoundingMargin = 1e-9;

double GetSquaredDistance(const glm::dvec3& point, const IndexBounds& box)
{
  const glm::dvec3 offset = point - glm::clamp(point, box.Min, box.Max);
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
  , Tree(this->Triangles, [](const Triangle& triangle) { return GetBox(triangle); })
{
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
  if (nearby >= 0)
  {
    this->Look(point, nearby, best);
  }
  this->Tree.VisitNearest([&](const IndexBounds& box) { return GetSquaredDistance(point, box); },
    [&](double squared) { return squared > best.SquaredDistance * (1.0 + RoundingMargin); },
    [&](std::size_t face) { this->Look(point, static_cast<std::int32_t>(face), best); });
  return best;
}

ClosestFace::Result ClosestFace::FindFirst(const glm::dvec3& point) const
{
  Result first = this->Find(point);
  const double most = first.SquaredDistance * (1.0 + RoundingMargin);
  this->Tree.VisitNearest([&](const IndexBounds& box) { return GetSquaredDistance(point, box); },
    [&](double squared) { return squared > most; },
    [&](std::size_t face)
    {
      Result other;
      this->Look(point, static_cast<std::int32_t>(face), other);
      if (other.SquaredDistance <= most && other.Face < first.Face)
      {
        first = other;
      }
    });
  return first;
}

} // namespace deformvolume
