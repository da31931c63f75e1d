// SPDX-License-Identifier: BSD-3-Clause
#include "PointMap.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <cmath>

namespace deformvolume
{

namespace
{

constexpr int MostSteps = 60;
constexpr double ShortestStep = 1.0 / 1024.0;
// A map with a smaller determinant of its derivative counts as not invertible.
constexpr double LeastDeterminant = 1e-12;

bool IsRegular(const glm::dmat3& gradient)
{
  return std::abs(glm::determinant(gradient)) > LeastDeterminant;
}

} // namespace

PointMap::~PointMap() = default;

bool PointMap::Solve(const glm::dvec3& point, const glm::dvec3& start, Image& image) const
{
  glm::dvec3 position = start;
  Image here;
  if (!this->Map(position, here))
  {
    return false;
  }
  glm::dvec3 miss = here.Point - point;
  const auto tryStep = [&](const glm::dvec3& step)
  {
    Image there;
    const bool isNearer =
      this->Map(position - step, there) && glm::length(there.Point - point) < glm::length(miss);
    if (isNearer)
    {
      position -= step;
      here = there;
      miss = here.Point - point;
    }
    return isNearer;
  };
  const auto getSteps = [&] { return here.StepGradient.value_or(here.Gradient); };
  for (int i = 0; i < MostSteps && glm::length(miss) > this->SolutionTolerance; ++i)
  {
    bool done = false;
    if (IsRegular(getSteps()))
    {
      const glm::dvec3 step = glm::inverse(getSteps()) * miss;
      for (double part = 1.0; !done && part >= ShortestStep; part *= 0.5)
      {
        done = tryStep(part * step);
      }
    }
    if (!done && !tryStep(miss) && !tryStep(0.5 * miss))
    {
      return false;
    }
  }
  if (!(glm::length(miss) <= this->SolutionTolerance) || !IsRegular(getSteps()))
  {
    return false;
  }
  image.Point = position;
  image.Gradient = glm::inverse(IsRegular(here.Gradient) ? here.Gradient : getSteps());
  image.FadingDisplacement = here.FadingDisplacement;
  return true;
}

bool PointMap::Invert(const glm::dvec3& point, Image& image) const
{
  const bool isFound = this->InvertInside(point, image);
  if (this->Outside.AreDiscarded() || (isFound && glm::determinant(image.Gradient) > 0.0))
  {
    return isFound;
  }
  Image there;
  Image solved;
  const bool isSolved = this->Solve(point, point, solved) ||
    (this->Map(point, there) && this->Solve(point, point - (there.Point - point), solved));
  if (isSolved && (!isFound || glm::determinant(solved.Gradient) > 0.0))
  {
    image = solved;
  }
  return isFound || isSolved;
}

bool MovePoint(const PointMap* map, bool isInverse, const glm::dvec3& point, PointMap::Image& image)
{
  if (map && (isInverse ? map->Invert(point, image) : map->Map(point, image)))
  {
    return true;
  }
  image = { point };
  return !map;
}

} // namespace deformvolume
