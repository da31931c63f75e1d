// SPDX-License-Identifier: BSD-3-Clause
// What the tests of corotational finite elements have in common.
#ifndef FiniteElementCase_h
#define FiniteElementCase_h

#include "FiniteElementModel.h"
#include "LatticeBody.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

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

/// What a call throws.
template <typename Call>
std::string GetError(Call&& call)
{
  try
  {
    call();
  }
  catch (const deformvolume::Error& error)
  {
    return error.what();
  }
  return "";
}

inline glm::dmat3 MakeRotation(double angle, const glm::dvec3& axis)
{
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), angle, glm::normalize(axis)));
}

/// The displacements of an affine map.
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

inline deformvolume::EquilibriumRequest MakeConverged()
{
  deformvolume::EquilibriumRequest request;
  request.Mode = deformvolume::EquilibriumMode::Converged;
  return request;
}

#endif
