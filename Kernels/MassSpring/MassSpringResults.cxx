// SPDX-License-Identifier: BSD-3-Clause
#include "MassSpringResults.h"

#include "IndexBounds.h"
#include "MassSpringNetwork.h"
#include "ParallelFor.h"

#include <glm/geometric.hpp>

#include <cmath>

namespace deformvolume
{
namespace
{

constexpr std::size_t TetrahedraAtOnce = 1024;

// The stress of springs is the sum of force times edge vector (virial stress), divided by the
// volume.
ElementResults FindResults(const std::array<glm::dvec3, 4>& rest,
  const std::array<glm::dvec3, 4>& now, const ElasticMaterial& material, double cubeEdge)
{
  constexpr int components[6][2] = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 1, 2 }, { 0, 2 } };
  ElementResults results;
  const double restVolume = GetDeterminant(rest) / 6.0;
  results.Determinant = GetDeterminant(now) / 6.0 / restVolume;
  const SpringStiffness stiffness = GetSpringStiffness(material, std::abs(restVolume), cubeEdge);
  const double growth = results.Determinant - 1.0;
  const double bulk = static_cast<double>(stiffness.Volume);
  results.StrainEnergyDensity = 0.5 * bulk * growth * growth;
  const bool hasStress = !IsFlat(results.Determinant);
  for (std::size_t i = 0; i < 3 && hasStress; ++i)
  {
    results.Stress[i] = bulk * growth;
  }
  for (std::size_t a = 0; a < 4; ++a)
  {
    for (std::size_t b = 0; b < a; ++b)
    {
      const glm::dvec3 edge = now[a] - now[b];
      const double length = glm::length(edge);
      const double lengthening = length - glm::distance(rest[a], rest[b]);
      const double force = static_cast<double>(stiffness.Edge) * lengthening;
      results.StrainEnergyDensity += 0.5 * force * lengthening / std::abs(restVolume);
      for (std::size_t i = 0; i < 6 && length > 0.0 && hasStress; ++i)
      {
        results.Stress[i] += force * edge[components[i][0]] * edge[components[i][1]] /
          (length * results.Determinant * std::abs(restVolume));
      }
    }
  }
  return results;
}

} // namespace

std::vector<ElementResults> ComputeMassSpringResults(
  const ElasticBody& body, const std::vector<float>& displacements, double cubeEdge)
{
  std::vector<ElementResults> results(body.Tetrahedra.size());
  ParallelForItems(results.size(), TetrahedraAtOnce,
    [&](std::size_t t)
    {
      const std::array<glm::dvec3, 4> rest = body.GetCorners(t);
      std::array<glm::dvec3, 4> now;
      for (std::size_t i = 0; i < 4; ++i)
      {
        now[i] = rest[i] + GetVector(displacements.data(), body.Tetrahedra[t][i]);
      }
      results[t] = FindResults(rest, now, body.GetMaterial(t), cubeEdge);
    });
  return results;
}

} // namespace deformvolume
