// SPDX-License-Identifier: BSD-3-Clause
#include "LinearizedNetwork.h"

#include <Eigen/Cholesky>
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

// The strain of which one component is 1: xx yy zz xy yz xz.
glm::dmat3 GetUnitStrain(std::size_t component)
{
  constexpr int axes[6][2] = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 1, 2 }, { 0, 2 } };
  const int i = axes[component][0];
  const int j = axes[component][1];
  glm::dmat3 strain(0.0);
  strain[i][j] += 0.5;
  strain[j][i] += 0.5;
  return strain;
}

// What single precision finds of lattices that are as their material.
constexpr double RoundOff = 1e-3;

// Whether a stiffness is that of a material.
bool IsOf(const ElasticMaterial& material, const std::array<std::array<double, 6>, 6>& stiffness)
{
  const double lambda = material.GetLambda();
  const double mu = material.GetShearModulus();
  for (std::size_t i = 0; i < 6; ++i)
  {
    for (std::size_t j = 0; j < 6; ++j)
    {
      double wanted = i < 3 && j < 3 ? lambda : 0.0;
      wanted += i != j ? 0.0 : i < 3 ? 2.0 * mu : mu;
      if (!(std::abs(stiffness[i][j] - wanted) < RoundOff * (lambda + 2.0 * mu)))
      {
        return false;
      }
    }
  }
  return true;
}

// Whether the forces of nodes inside a body are 0.
bool AreAtTheSurface(const std::vector<double>& forces, const ElasticBody& body)
{
  const std::vector<double> surface = GetStressForces(body, glm::dmat3(1.0));
  const double size = std::sqrt(Dot(surface, surface));
  double inside = 0.0;
  for (std::size_t i = 0; i < forces.size(); i += 3)
  {
    if (glm::length(glm::dvec3(surface[i], surface[i + 1], surface[i + 2])) < 1e-9 * size)
    {
      inside +=
        forces[i] * forces[i] + forces[i + 1] * forces[i + 1] + forces[i + 2] * forces[i + 2];
    }
  }
  return inside < RoundOff * RoundOff * Dot(forces, forces);
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
  this->Asked.Ask();
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

LinearizedNetwork::AffineResponse LinearizedNetwork::FindAffineResponse(double volume) const
{
  AffineResponse response;
  for (std::size_t i = 0; i < 6; ++i)
  {
    response.Displacements[i] = Strain(this->Network.RestPoints, GetUnitStrain(i));
    response.Forces[i] = this->Apply(response.Displacements[i]);
  }
  for (std::size_t i = 0; i < 6; ++i)
  {
    for (std::size_t j = 0; j < 6; ++j)
    {
      response.Stiffness[i][j] = Dot(response.Displacements[i], response.Forces[j]) / volume;
    }
  }
  return response;
}

double LinearizedNetwork::FindCompliance(
  const ElasticBody& body, const AffineResponse& response, double volume, int axis) const
{
  // A stress on the surface, and what it does, beginning with the strain that fits best; conjugate
  // gradients. How far the body yields grows with each step, and settles long before the last node
  // is in equilibrium.
  constexpr int mostSteps = 300;
  constexpr int stepsBetweenLooks = 10;
  constexpr double precision = 1e-3;
  Eigen::Matrix<double, 6, 6> stiffness;
  for (int i = 0; i < 36; ++i)
  {
    stiffness(i / 6, i % 6) =
      response.Stiffness[static_cast<std::size_t>(i / 6)][static_cast<std::size_t>(i % 6)];
  }
  const Eigen::Matrix<double, 6, 1> strain =
    stiffness.ldlt().solve(Eigen::Matrix<double, 6, 1>::Unit(axis));
  const std::vector<double> forces =
    GetStressForces(body, GetUnitStrain(static_cast<std::size_t>(axis)));
  std::vector<double> displacements(forces.size(), 0.0);
  std::vector<double> residual = forces;
  for (std::size_t i = 0; i < 6; ++i)
  {
    Add(displacements, strain[static_cast<Eigen::Index>(i)], response.Displacements[i]);
    Add(residual, -strain[static_cast<Eigen::Index>(i)], response.Forces[i]);
  }
  std::vector<double> direction = residual;
  double squared = Dot(residual, residual);
  const double wanted = precision * precision * Dot(forces, forces);
  double yield = Dot(forces, displacements);
  for (int step = 1; step <= mostSteps && squared > wanted; ++step)
  {
    const std::vector<double> product = this->Apply(direction);
    const double length = squared / Dot(direction, product);
    Add(displacements, length, direction);
    Add(residual, -length, product);
    const double before = squared;
    squared = Dot(residual, residual);
    Scale(direction, squared / before);
    Add(direction, 1.0, residual);
    if (step % stepsBetweenLooks == 0)
    {
      const double last = yield;
      yield = Dot(forces, displacements);
      if (std::abs(yield - last) < precision * std::abs(yield))
      {
        break;
      }
    }
  }
  return Dot(forces, displacements) / volume;
}

double LinearizedNetwork::FindStiffness(const ElasticBody& body) const
{
  const std::vector<double> volumes = GetVolumes(body);
  const double volume = std::accumulate(volumes.begin(), volumes.end(), 0.0);
  const AffineResponse response = this->FindAffineResponse(volume);
  const ElasticMaterial material = GetSpringMaterial(body.Materials.front());
  if (IsOf(material, response.Stiffness) && AreAtTheSurface(response.Forces.front(), body))
  {
    return 1.0;
  }
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    sum += this->FindCompliance(body, response, volume, axis);
  }
  return 3.0 / (sum * material.YoungModulus);
}

} // namespace deformvolume
