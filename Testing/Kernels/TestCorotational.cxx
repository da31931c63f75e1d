// SPDX-License-Identifier: BSD-3-Clause
// Corotational finite elements: misuse, then what has a closed form.
#include "CorotationalModel.h"
#include "LatticeBody.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <string>
#include <vector>

using namespace deformvolume;

namespace
{

using Place = LatticeBody::Place;

ElasticMaterial MakeMaterial(double youngModulus, double poissonRatio)
{
  ElasticMaterial material;
  material.YoungModulus = youngModulus;
  material.PoissonRatio = poissonRatio;
  return material;
}

double LargestOf(const glm::dvec3& vector)
{
  const glm::dvec3 sizes = glm::abs(vector);
  return std::max({ sizes.x, sizes.y, sizes.z });
}

double LargestOf(const std::vector<glm::dvec3>& vectors)
{
  double largest = 0.0;
  for (const glm::dvec3& vector : vectors)
  {
    largest = std::max(largest, LargestOf(vector));
  }
  return largest;
}

// What a call throws.
template <typename Call>
std::string GetError(Call&& call)
{
  try
  {
    call();
  }
  catch (const Error& error)
  {
    return error.what();
  }
  return "";
}

glm::dmat3 MakeRotation(double angle, const glm::dvec3& axis)
{
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), angle, glm::normalize(axis)));
}

std::vector<glm::dvec3> MapPoints(
  const ElasticBody& body, const glm::dmat3& matrix, const glm::dvec3& offset)
{
  std::vector<glm::dvec3> displacements;
  for (const glm::dvec3& point : body.Points)
  {
    displacements.push_back(matrix * point + offset - point);
  }
  return displacements;
}

CorotationalRequest MakeConverged()
{
  CorotationalRequest request;
  request.Mode = CorotationalMode::Converged;
  return request;
}

} // namespace

TEST(Corotational, RigidRotation)
{
  // A stiffness of E h^2 = 2800 N.
  LatticeBody lattice({ 5, 5, 5 }, 0.1, MakeMaterial(2.8e5, 0.3));
  CorotationalModel model;
  model.SetBody(lattice.Body);
  model.SetDisplacements(
    MapPoints(lattice.Body, MakeRotation(2.0, { 1.0, 2.0, -0.5 }), glm::dvec3(0.7, -0.3, 1.1)));
  EXPECT_LT(LargestOf(model.GetForces()), 2e-11 * 10);
  printf("rigid %g\n", LargestOf(model.GetForces()));
}

TEST(Corotational, Patch)
{
  LatticeBody lattice({ 5, 5, 5 }, 0.25, MakeMaterial(1e4, 0.3));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.04, 0.04);
  const auto isOutside = [](const Place& place)
  { return std::any_of(place.begin(), place.end(), [](std::int32_t i) { return i % 4 == 0; }); };
  lattice.ForNodes(
    [&](const Place& place, std::int32_t node)
    {
      if (!isOutside(place))
      {
        lattice.Body.Points[static_cast<std::size_t>(node)] +=
          glm::dvec3(jitter(random), jitter(random), jitter(random));
      }
    });
  const glm::dmat3 stretch(1.2, 0.05, 0.0, 0.1, 0.9, 0.03, -0.04, 0.02, 1.1);
  const std::vector<glm::dvec3> wanted = MapPoints(
    lattice.Body, MakeRotation(1.0, { 1.0, -1.0, 0.3 }) * stretch, glm::dvec3(0.2, 0.1, -0.3));
  CorotationalRequest request = MakeConverged();
  lattice.ForNodes(
    [&](const Place& place, std::int32_t node)
    {
      if (isOutside(place))
      {
        request.Held.push_back({ node, wanted[static_cast<std::size_t>(node)] });
      }
    });
  CorotationalModel model;
  model.SetBody(lattice.Body);
  const CorotationalReport report = model.Solve(request);
  EXPECT_TRUE(report.IsConverged);
  double error = 0.0;
  for (std::size_t node = 0; node < wanted.size(); ++node)
  {
    error = std::max(error, LargestOf(model.GetDisplacements()[node] - wanted[node]));
  }
  EXPECT_LT(error, 1e-12);
  printf("patch error %g newton %d cg %d residual %g\n", error, report.NewtonSteps,
    report.LinearIterations, report.Residual);
}
