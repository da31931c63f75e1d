// SPDX-License-Identifier: BSD-3-Clause
#include "MassSpringNetwork.h"

#include "CountedLists.h"
#include "MassSpringModel.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace deformvolume
{
namespace
{

constexpr std::size_t TetrahedraOfPart = 4096;
constexpr std::size_t PartsAtOnce = 8;

constexpr double Tolerance = 1e-3;

using Corners = std::array<glm::dvec3, 4>;

bool IsAbout(double length, double wanted)
{
  return std::abs(length - wanted) <= Tolerance * wanted;
}

// Whether the edges from one corner have the length `from`, and the other edges the length
// `between`.
bool HasEdges(const Corners& corners, std::size_t corner, double from, double between)
{
  for (std::size_t i = 0; i < 4; ++i)
  {
    for (std::size_t j = 0; j < i; ++j)
    {
      const double wanted = i == corner || j == corner ? from : between;
      if (!IsAbout(glm::distance(corners[i], corners[j]), wanted))
      {
        return false;
      }
    }
  }
  return true;
}

bool IsFifth(const Corners& corners, double edge)
{
  const double diagonal = std::sqrt(2.0) * edge;
  bool isFifth = HasEdges(corners, 0, diagonal, diagonal);
  for (std::size_t i = 0; i < 4 && !isFifth; ++i)
  {
    isFifth = HasEdges(corners, i, edge, diagonal);
  }
  return isFifth;
}

// The largest frequency of a body is at most that of its fastest tetrahedron alone, with the part
// of the mass that this tetrahedron gives to its nodes. For a tetrahedron at a cube corner the
// angular frequency is at most sqrt(24 lambda / rho) / h: sqrt(24 mu / rho) / h from the springs,
// and the rest from the volume. The tetrahedron in the middle of a cube is slower.
double FindStableTimeStep(const ElasticBody& body, double cubeEdge)
{
  double fastest = 0.0;
  for (const ElasticMaterial& material : body.Materials)
  {
    fastest = std::max(fastest, 24.0 * GetSpringMaterial(material).GetLambda() / material.Density);
  }
  return 2.0 * cubeEdge / std::sqrt(fastest);
}

} // namespace

double FindCubeEdge(AbortCheck& abortCheck, const ElasticBody& body)
{
  const Corners first = body.GetCorners(0);
  // Both kinds of tetrahedra have a face diagonal as their longest edge.
  double longest = 0.0;
  for (std::size_t i = 1; i < 4; ++i)
  {
    for (std::size_t j = 0; j < i; ++j)
    {
      longest = std::max(longest, glm::distance(first[i], first[j]));
    }
  }
  const double edge = longest / std::sqrt(2.0);
  ForItems(abortCheck, body.Tetrahedra.size(),
    [&](std::size_t t)
    {
      if (!IsFifth(body.GetCorners(t), edge))
      {
        throw Error("The tetrahedron with the points " + ListNodes(body.Tetrahedra[t]) +
          " is not a fifth of a cube" +
          (t == 0 ? std::string() : " of the same size as those before it") +
          ". Springs simulate an elastic material only on lattices of equal cubes with five "
          "tetrahedra each: use "
          "vtkLatticeTetrahedraSource with EqualSpacing, or vtkFiniteElementDeformation, which "
          "takes any mesh.");
      }
    });
  return edge;
}

ElasticMaterial GetSpringMaterial(const ElasticMaterial& material)
{
  ElasticMaterial possible = material;
  possible.PoissonRatio = std::max(material.PoissonRatio, MassSpringModel::LeastPoissonRatio);
  return possible;
}

SpringStiffness GetSpringStiffness(
  const ElasticMaterial& material, double restVolume, double cubeEdge)
{
  const ElasticMaterial possible = GetSpringMaterial(material);
  const double mu = possible.GetShearModulus();
  SpringStiffness stiffness;
  // mu h / 4 for a tetrahedron at a corner, mu h / 2 for the one in the middle. A cube edge is
  // shared by four corner tetrahedra. A face diagonal is shared by two cubes, with two corner
  // tetrahedra and a middle one each.
  stiffness.Edge = static_cast<float>(1.5 * mu * restVolume / (cubeEdge * cubeEdge));
  stiffness.Volume = static_cast<float>(possible.GetLambda() - mu);
  return stiffness;
}

MassSpringNetwork::MassSpringNetwork(
  AbortCheck& abortCheck, const ElasticBody& body, int lanes, double cubeEdge)
  : Lanes(lanes)
  , NumberOfPackets((body.Tetrahedra.size() + static_cast<std::size_t>(lanes) - 1) /
      static_cast<std::size_t>(lanes))
  , Tetrahedra(this->NumberOfPackets * 4 * static_cast<std::size_t>(lanes), 0)
  , Materials(this->NumberOfPackets * 2 * static_cast<std::size_t>(lanes), 0.0F)
  , RestPoints(body.Points.size() * 3)
  , Mobilities(body.Points.size(), 0.0F)
  , StableTimeStep(FindStableTimeStep(body, cubeEdge))
{
  const auto width = static_cast<std::size_t>(lanes);
  abortCheck.Check();
  const std::vector<double> volumes = GetVolumes(body);
  abortCheck.Check();
  this->Masses = GetNodeMasses(body, volumes);
  // Points that no tetrahedron uses may be far away.
  glm::dvec3 least = body.Points[static_cast<std::size_t>(body.Tetrahedra.front()[0])];
  glm::dvec3 most = least;
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    if (this->Masses[node] > 0.0)
    {
      least = glm::min(least, body.Points[node]);
      most = glm::max(most, body.Points[node]);
    }
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
  ForParts(abortCheck, (tetrahedra + TetrahedraOfPart - 1) / TetrahedraOfPart, PartsAtOnce,
    [&](std::size_t part)
    {
      const std::size_t last = std::min(tetrahedra, (part + 1) * TetrahedraOfPart);
      for (std::size_t t = part * TetrahedraOfPart; t < last; ++t)
      {
        const SpringStiffness stiffness =
          GetSpringStiffness(body.GetMaterial(t), volumes[t], cubeEdge);
        const std::size_t packet = t / width;
        const std::size_t lane = t % width;
        this->Materials[packet * 2 * width + lane] = stiffness.Edge;
        this->Materials[(packet * 2 + 1) * width + lane] = stiffness.Volume;
        for (std::size_t i = 0; i < 4; ++i)
        {
          this->Tetrahedra[(packet * 4 + i) * width + lane] = body.Tetrahedra[t][i] * 3;
        }
      }
    });
  MakeLists(
    body.Points.size(),
    [&](const auto& take)
    {
      ForItems(abortCheck, tetrahedra,
        [&](std::size_t t)
        {
          for (std::size_t i = 0; i < 4; ++i)
          {
            take(static_cast<std::size_t>(body.Tetrahedra[t][i]),
              static_cast<std::uint32_t>(((t / width * 4 + i) * 3) * width + t % width));
          }
        });
    },
    this->Begins, this->ForceIndices);
}

} // namespace deformvolume
