// SPDX-License-Identifier: BSD-3-Clause
// Bodies, loads and helper functions that the tests of finite elements share.
#ifndef FiniteElementCase_h
#define FiniteElementCase_h

#include "CaughtError.h"
#include "FiniteElementModel.h"
#include "LatticeBody.h"
#include "MidSideNodes.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

constexpr double NoNumber = std::numeric_limits<double>::quiet_NaN();

inline deformvolume::ElasticMaterial MakeMaterial(double youngModulus, double poissonRatio)
{
  deformvolume::ElasticMaterial material;
  material.YoungModulus = youngModulus;
  material.PoissonRatio = poissonRatio;
  return material;
}

inline double LargestOf(const glm::dvec3& vector)
{
  const glm::dvec3 sizes = glm::abs(vector);
  return std::max({ sizes.x, sizes.y, sizes.z });
}

inline double LargestOf(const std::vector<glm::dvec3>& vectors)
{
  double largest = 0.0;
  for (const glm::dvec3& vector : vectors)
  {
    largest = std::max(largest, LargestOf(vector));
  }
  return largest;
}

inline double LargestDifference(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b)
{
  double largest = a.size() == b.size() ? 0.0 : 1e300;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
  {
    largest = std::max(largest, LargestOf(a[i] - b[i]));
  }
  return largest;
}

inline glm::dmat3 MakeRotation(double angle, const glm::dvec3& axis)
{
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), angle, glm::normalize(axis)));
}

/// Returns the displacements of an affine map.
inline std::vector<glm::dvec3> MapPoints(
  const deformvolume::ElasticBody& body, const glm::dmat3& matrix, const glm::dvec3& offset)
{
  std::vector<glm::dvec3> displacements;
  for (const glm::dvec3& point : body.Points)
  {
    displacements.push_back(matrix * point + offset - point);
  }
  return displacements;
}

/// A lattice of ten-node tetrahedra. isFixed: the corners to fix.
struct QuadraticLattice : LatticeBody
{
  QuadraticLattice(const Place& nodes, double spacing,
    const deformvolume::ElasticMaterial& material,
    const std::function<bool(const Place&)>& isFixed = nullptr)
    : LatticeBody(nodes, spacing, material)
  {
    if (isFixed)
    {
      this->Fix(isFixed);
    }
    deformvolume::AddMidSideNodes(this->Body);
  }
};

/// Returns the nodes at whose positions a function is true.
template <typename Choose>
std::vector<std::int32_t> FindNodes(const deformvolume::ElasticBody& body, Choose&& isChosen)
{
  std::vector<std::int32_t> nodes;
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    if (isChosen(body.Points[node]))
    {
      nodes.push_back(static_cast<std::int32_t>(node));
    }
  }
  return nodes;
}

/// Returns the node forces of a traction, in N/m^2, on the faces whose corners satisfy a function.
/// On straight faces, only mid-side nodes have forces.
template <typename Choose>
std::vector<glm::dvec3> LoadFaces(
  const deformvolume::ElasticBody& body, Choose&& isOnFace, const glm::dvec3& traction)
{
  std::vector<glm::dvec3> forces(body.Points.size(), glm::dvec3(0.0));
  for (std::size_t t = 0; t < body.Tetrahedra.size(); ++t)
  {
    const auto at = [&](std::size_t i) -> const glm::dvec3&
    { return body.Points[static_cast<std::size_t>(body.Tetrahedra[t][i])]; };
    for (std::size_t apex = 0; apex < 4; ++apex)
    {
      const std::size_t a = (apex + 1) % 4;
      const std::size_t b = (apex + 2) % 4;
      const std::size_t c = (apex + 3) % 4;
      if (!isOnFace(at(a)) || !isOnFace(at(b)) || !isOnFace(at(c)))
      {
        continue;
      }
      const double area = 0.5 * glm::length(glm::cross(at(b) - at(a), at(c) - at(a)));
      for (std::size_t edge = 0; edge < 6; ++edge)
      {
        const auto& ends = deformvolume::TetrahedronEdges[edge];
        if (ends[0] != apex && ends[1] != apex)
        {
          forces[static_cast<std::size_t>(body.MidSides[t][edge])] += traction * area / 3.0;
        }
      }
    }
  }
  return forces;
}

/// Returns the mean of displacements, weighted by the forces on the nodes.
inline glm::dvec3 GetLoadedMean(
  const std::vector<glm::dvec3>& forces, const std::vector<glm::dvec3>& displacements)
{
  glm::dvec3 sum(0.0);
  double weights = 0.0;
  for (std::size_t node = 0; node < forces.size(); ++node)
  {
    const double weight = glm::length(forces[node]);
    sum += weight * displacements[node];
    weights += weight;
  }
  return sum / weights;
}

inline deformvolume::EquilibriumRequest MakeConverged()
{
  deformvolume::EquilibriumRequest request;
  request.Mode = deformvolume::EquilibriumMode::Converged;
  return request;
}

#endif
