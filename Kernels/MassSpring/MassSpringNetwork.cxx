// SPDX-License-Identifier: BSD-3-Clause
#include "MassSpringNetwork.h"

#include "MassSpringModel.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace deformvolume
{
namespace
{

constexpr std::size_t TetrahedraOfPart = 4096;
constexpr std::size_t PartsAtOnce = 8;

std::array<glm::dvec3, 4> GetCorners(const ElasticBody& body, const Tetrahedron& tetrahedron)
{
  std::array<glm::dvec3, 4> corners;
  std::transform(tetrahedron.begin(), tetrahedron.end(), corners.begin(),
    [&](std::int32_t node) { return body.Points[static_cast<std::size_t>(node)]; });
  return corners;
}

// The sum of the squared areas of the faces.
double GetSquaredAreas(const std::array<glm::dvec3, 4>& corners)
{
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i)
  {
    const glm::dvec3& a = corners[(i + 1) % 4];
    const glm::dvec3 normal = glm::cross(corners[(i + 2) % 4] - a, corners[(i + 3) % 4] - a);
    sum += 0.25 * glm::dot(normal, normal);
  }
  return sum;
}

double FindShortestEdge(Watch& watch, const ElasticBody& body)
{
  double shortest = std::numeric_limits<double>::infinity();
  ForItems(watch, body.Tetrahedra.size(),
    [&](std::size_t t)
    {
      const std::array<glm::dvec3, 4> corners = GetCorners(body, body.Tetrahedra[t]);
      for (std::size_t i = 0; i < 4; ++i)
      {
        for (std::size_t j = 0; j < i; ++j)
        {
          shortest = std::min(shortest, glm::distance(corners[i], corners[j]));
        }
      }
    });
  return shortest;
}

} // namespace

ElasticMaterial GetSpringMaterial(const ElasticMaterial& material)
{
  ElasticMaterial possible = material;
  possible.PoissonRatio = std::max(material.PoissonRatio, MassSpringModel::LeastPoissonRatio);
  return possible;
}

SpringStiffness GetSpringStiffness(
  const ElasticMaterial& material, double restVolume, const std::array<glm::dvec3, 4>& corners)
{
  const ElasticMaterial possible = GetSpringMaterial(material);
  const double mu = possible.GetShearModulus();
  // A rule for all shapes: 3/2 mu h^4 / V, where h^-2 is the sum of the squared inverse heights.
  // For the two shapes of a cube's tetrahedra it gives the springs of the isotropic lattice, and
  // for tetrahedra that are nearly flat it gives hardly any.
  const double squaredHeight = 9.0 * restVolume * restVolume / GetSquaredAreas(corners);
  SpringStiffness stiffness;
  stiffness.Edge = static_cast<float>(1.5 * mu * squaredHeight * squaredHeight / restVolume);
  stiffness.Volume = static_cast<float>(possible.GetLambda() - mu);
  return stiffness;
}

MassSpringNetwork::MassSpringNetwork(Watch& watch, const ElasticBody& body, int lanes, double scale)
  : Lanes(lanes)
  , NumberOfGroups((body.Tetrahedra.size() + static_cast<std::size_t>(lanes) - 1) /
      static_cast<std::size_t>(lanes))
  , Tetrahedra(this->NumberOfGroups * 4 * static_cast<std::size_t>(lanes), 0)
  , Materials(this->NumberOfGroups * 2 * static_cast<std::size_t>(lanes), 0.0F)
  , RestPoints(body.Points.size() * 3)
  , Begins(body.Points.size() + 1, 0)
  , Places(body.Tetrahedra.size() * 4)
  , Mobilities(body.Points.size(), 0.0F)
{
  const auto width = static_cast<std::size_t>(lanes);
  watch.Ask();
  const std::vector<double> volumes = GetVolumes(body);
  watch.Ask();
  this->Masses = GetNodeMasses(body, volumes);
  this->ShortestEdge = FindShortestEdge(watch, body);
  glm::dvec3 least = body.Points.front();
  glm::dvec3 most = least;
  for (const glm::dvec3& point : body.Points)
  {
    least = glm::min(least, point);
    most = glm::max(most, point);
  }
  this->Size = glm::distance(least, most);
  const glm::dvec3 middle = 0.5 * (least + most);
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      this->RestPoints[3 * node + static_cast<std::size_t>(axis)] =
        static_cast<float>(body.Points[node][axis] - middle[axis]);
    }
    if (this->Masses[node] > 0.0 && !body.IsFixed(node))
    {
      this->Mobilities[node] = static_cast<float>(1.0 / this->Masses[node]);
    }
  }
  const std::size_t tetrahedra = body.Tetrahedra.size();
  ForParts(watch, (tetrahedra + TetrahedraOfPart - 1) / TetrahedraOfPart, PartsAtOnce,
    [&](std::size_t part)
    {
      const std::size_t last = std::min(tetrahedra, (part + 1) * TetrahedraOfPart);
      for (std::size_t t = part * TetrahedraOfPart; t < last; ++t)
      {
        const SpringStiffness stiffness =
          GetSpringStiffness(body.GetMaterial(t), volumes[t], GetCorners(body, body.Tetrahedra[t]));
        const std::size_t group = t / width;
        const std::size_t lane = t % width;
        this->Materials[group * 2 * width + lane] = static_cast<float>(stiffness.Edge * scale);
        this->Materials[(group * 2 + 1) * width + lane] =
          static_cast<float>(stiffness.Volume * scale);
        for (std::size_t i = 0; i < 4; ++i)
        {
          this->Tetrahedra[(group * 4 + i) * width + lane] = body.Tetrahedra[t][i] * 3;
        }
      }
    });
  ForItems(watch, tetrahedra,
    [&](std::size_t t)
    {
      for (const std::int32_t node : body.Tetrahedra[t])
      {
        ++this->Begins[static_cast<std::size_t>(node) + 1];
      }
    });
  std::partial_sum(this->Begins.begin(), this->Begins.end(), this->Begins.begin());
  std::vector<std::uint32_t> next(this->Begins.begin(), this->Begins.end() - 1);
  ForItems(watch, tetrahedra,
    [&](std::size_t t)
    {
      for (std::size_t i = 0; i < 4; ++i)
      {
        const auto node = static_cast<std::size_t>(body.Tetrahedra[t][i]);
        this->Places[next[node]++] =
          static_cast<std::uint32_t>(((t / width * 4 + i) * 3) * width + t % width);
      }
    });
}

} // namespace deformvolume
