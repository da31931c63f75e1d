// SPDX-License-Identifier: BSD-3-Clause
#include "LinearizedNetwork.h"

#include <Eigen/Eigenvalues>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

namespace deformvolume
{
namespace
{

// Displacements are at most this part of the shortest edge, so that forces are linear in them.
constexpr double Smallness = 1e-4;

double Dot(const std::vector<double>& a, const std::vector<double>& b)
{
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// a += factor b
void Add(std::vector<double>& a, double factor, const std::vector<double>& b)
{
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    a[i] += factor * b[i];
  }
}

void Scale(std::vector<double>& a, double factor)
{
  for (double& value : a)
  {
    value *= factor;
  }
}

// The forces on the nodes of a body that is under the same stress everywhere, which are 0 inside.
// stress: its columns.
std::vector<double> GetStressForces(const ElasticBody& body, const glm::dmat3& stress)
{
  std::vector<double> forces(body.Points.size() * 3, 0.0);
  for (const Tetrahedron& tetrahedron : body.Tetrahedra)
  {
    const auto point = [&](std::size_t i) -> const glm::dvec3&
    { return body.Points[static_cast<std::size_t>(tetrahedron[i])]; };
    for (std::size_t i = 0; i < 4; ++i)
    {
      // A third of the area of the other nodes' face acts on each of them, and so all of it, turned
      // round, on this one.
      const glm::dvec3& a = point((i + 1) % 4);
      const glm::dvec3 area =
        0.5 * glm::cross(point((i + 2) % 4) - a, point((i + 3) % 4) - a) / 3.0;
      const double side = glm::dot(area, point(i) - a) > 0.0 ? 1.0 : -1.0;
      const glm::dvec3 force = stress * (side * area);
      for (int axis = 0; axis < 3; ++axis)
      {
        forces[3 * static_cast<std::size_t>(tetrahedron[i]) + static_cast<std::size_t>(axis)] +=
          force[axis];
      }
    }
  }
  return forces;
}

// The displacements of nodes whose positions are given, by a strain.
std::vector<double> Strain(const std::vector<float>& points, const glm::dmat3& strain)
{
  std::vector<double> displacements(points.size());
  for (std::size_t i = 0; i < points.size(); i += 3)
  {
    const glm::dvec3 moved = strain * glm::dvec3(points[i], points[i + 1], points[i + 2]);
    for (int axis = 0; axis < 3; ++axis)
    {
      displacements[i + static_cast<std::size_t>(axis)] = moved[axis];
    }
  }
  return displacements;
}

// The strain of a bar that is pulled along a direction.
glm::dmat3 GetBarStrain(const glm::dvec3& direction, double poissonRatio)
{
  const glm::dvec3 unit = glm::normalize(direction);
  return glm::dmat3(-poissonRatio) + (1.0 + poissonRatio) * glm::outerProduct(unit, unit);
}

glm::dvec3 GetAxis(int axis)
{
  glm::dvec3 direction(0.0);
  direction[axis] = 1.0;
  return direction;
}

} // namespace

std::vector<double> LinearizedNetwork::Apply(const std::vector<double>& displacements) const
{
  double largest = 0.0;
  for (const double value : displacements)
  {
    largest = std::max(largest, std::abs(value));
  }
  std::vector<double> result(displacements.size(), 0.0);
  if (largest == 0.0)
  {
    return result;
  }
  const double factor = Smallness * this->Network.ShortestEdge / largest;
  std::vector<float> small(displacements.size());
  std::transform(displacements.begin(), displacements.end(), small.begin(),
    [&](double value) { return static_cast<float>(value * factor); });
  this->State.SetDisplacements(small);
  const std::vector<float> forces = this->State.ComputeForces();
  std::transform(forces.begin(), forces.end(), result.begin(),
    [&](float force) { return -static_cast<double>(force) / factor; });
  std::fill(small.begin(), small.end(), 0.0F);
  this->State.SetDisplacements(small);
  return result;
}

double LinearizedNetwork::FindLargestFrequency() const
{
  // The method of Lanczos, for the largest eigenvalue of the stiffness by the masses.
  constexpr int mostSteps = 100;
  constexpr double precision = 1e-4;
  const std::size_t size = this->Network.Mobilities.size() * 3;
  std::vector<double> roots(size); // of the mobilities
  std::vector<double> current(size);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (std::size_t i = 0; i < size; ++i)
  {
    roots[i] = std::sqrt(static_cast<double>(this->Network.Mobilities[i / 3]));
    current[i] = roots[i] > 0.0 ? uniform(random) : 0.0;
  }
  double length = std::sqrt(Dot(current, current));
  std::vector<double> previous(size, 0.0);
  std::vector<double> diagonal;
  std::vector<double> offDiagonal;
  double largest = 0.0;
  while (length > 0.0 && diagonal.size() < mostSteps)
  {
    Scale(current, 1.0 / length);
    std::vector<double> next(size);
    std::transform(current.begin(), current.end(), roots.begin(), next.begin(),
      [](double value, double root) { return value * root; });
    next = this->Apply(next);
    std::transform(next.begin(), next.end(), roots.begin(), next.begin(),
      [](double value, double root) { return value * root; });
    diagonal.push_back(Dot(next, current));
    Add(next, -diagonal.back(), current);
    Add(next, -(offDiagonal.empty() ? 0.0 : offDiagonal.back()), previous);
    previous.swap(current);
    current.swap(next);
    length = std::sqrt(Dot(current, current));
    const auto rows = static_cast<Eigen::Index>(diagonal.size());
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(diagonal.data(), rows),
      Eigen::Map<const Eigen::VectorXd>(offDiagonal.data(), rows - 1));
    largest = solver.eigenvalues()[rows - 1];
    const double uncertainty = length * std::abs(solver.eigenvectors()(rows - 1, rows - 1));
    if (uncertainty <= precision * largest)
    {
      // It may be that much larger.
      largest += uncertainty;
      break;
    }
    offDiagonal.push_back(length);
  }
  return std::sqrt(std::max(largest, 0.0));
}

bool LinearizedNetwork::IsAsTheMaterial(
  const ElasticBody& body, const std::vector<double>& volumes) const
{
  // What single precision finds of a lattice that is.
  constexpr double roundOff = 1e-3;
  const ElasticMaterial& material = body.Materials.front();
  const double volume = std::accumulate(volumes.begin(), volumes.end(), 0.0);
  const auto isRight = [&](const glm::dvec3& direction)
  {
    const std::vector<double> displacements =
      Strain(this->Network.RestPoints, GetBarStrain(direction, material.PoissonRatio));
    const double energy = 0.5 * Dot(displacements, this->Apply(displacements));
    const double wanted = 0.5 * material.YoungModulus * volume;
    return std::abs(energy - wanted) < roundOff * wanted;
  };
  for (const glm::dvec3& direction :
    { glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1), glm::dvec3(1, 1, 1),
      glm::dvec3(-1, 1, 1), glm::dvec3(1, -1, 1), glm::dvec3(1, 1, -1) })
  {
    if (!isRight(direction))
    {
      return false;
    }
  }
  // Nodes inside are in equilibrium where the body is strained.
  const glm::dmat3 strain = GetBarStrain(GetAxis(0), material.PoissonRatio);
  const std::vector<double> forces = this->Apply(Strain(this->Network.RestPoints, strain));
  const std::vector<double> surface = GetStressForces(body, glm::dmat3(1.0));
  const double size = std::sqrt(Dot(surface, surface));
  double inside = 0.0;
  for (std::size_t i = 0; i < forces.size(); i += 3)
  {
    const glm::dvec3 area(surface[i], surface[i + 1], surface[i + 2]);
    if (glm::length(area) < 1e-9 * size)
    {
      inside +=
        forces[i] * forces[i] + forces[i + 1] * forces[i + 1] + forces[i + 2] * forces[i + 2];
    }
  }
  return inside < roundOff * roundOff * Dot(forces, forces);
}

double LinearizedNetwork::FindCompliance(
  const ElasticBody& body, const std::vector<double>& volumes, int axis) const
{
  // A stress on the surface, and what it does; conjugate gradients.
  constexpr int mostSteps = 500;
  constexpr double precision = 3e-3;
  const glm::dmat3 stress = glm::outerProduct(GetAxis(axis), GetAxis(axis));
  const ElasticMaterial& material = body.Materials.front();
  const std::vector<double> forces = GetStressForces(body, stress);
  std::vector<double> displacements = Strain(this->Network.RestPoints,
    GetBarStrain(GetAxis(axis), material.PoissonRatio) / material.YoungModulus);
  std::vector<double> residual = forces;
  Add(residual, -1.0, this->Apply(displacements));
  std::vector<double> direction = residual;
  double squared = Dot(residual, residual);
  const double wanted = precision * precision * Dot(forces, forces);
  for (int step = 0; step < mostSteps && squared > wanted; ++step)
  {
    const std::vector<double> product = this->Apply(direction);
    const double length = squared / Dot(direction, product);
    Add(displacements, length, direction);
    Add(residual, -length, product);
    const double before = squared;
    squared = Dot(residual, residual);
    Scale(direction, squared / before);
    Add(direction, 1.0, residual);
  }
  return Dot(forces, displacements) / std::accumulate(volumes.begin(), volumes.end(), 0.0);
}

double LinearizedNetwork::FindStiffness(const ElasticBody& body) const
{
  const std::vector<double> volumes = GetVolumes(body);
  if (this->IsAsTheMaterial(body, volumes))
  {
    return 1.0;
  }
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    sum += this->FindCompliance(body, volumes, axis);
  }
  return 3.0 / (sum * body.Materials.front().YoungModulus);
}

} // namespace deformvolume
