// SPDX-License-Identifier: BSD-3-Clause
// Guesses from the latest solutions of a linear system.
#include "FiniteElementCase.h"
#include "FiniteElements.h"
#include "RowParts.h"
#include "SolutionHistory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

using namespace deformvolume;

namespace
{

using Vectors = std::vector<glm::dvec3>;

// The tangent of a block. The nodes at one end are not free.
struct System
{
  explicit System(double modulus = 1e4)
    : Lattice({ 3, 3, 4 }, 0.01, ElasticMaterial{ modulus, 0.3, 1000.0 })
    , Elements(this->Time, this->Lattice.Body)
  {
    this->Matrix.SetPattern(this->Time, MakeNodePattern(this->Time, this->Lattice.Body));
    this->Elements.SetPattern(this->Time, this->Matrix.GetPattern());
    const std::size_t nodes = this->Lattice.Body.Points.size();
    this->Elements.AssembleTangent(
      this->Time, Vectors(nodes, glm::dvec3(0.0)), false, this->Matrix);
    for (const glm::dvec3& point : this->Lattice.Body.Points)
    {
      this->IsFree.push_back(point.z > 0.0 ? 1 : 0);
    }
  }

  Vectors MakeVector(std::mt19937& random) const
  {
    std::uniform_real_distribution<double> component(-1.0, 1.0);
    Vectors vector;
    for (const unsigned char isFree : this->IsFree)
    {
      vector.push_back(
        double(isFree) * glm::dvec3(component(random), component(random), component(random)));
    }
    return vector;
  }
  Vectors Multiply(const Vectors& vector) const
  {
    Vectors product(vector.size());
    this->Matrix.Multiply(0, vector.size(), this->IsFree.data(), vector.data(), product.data());
    return product;
  }
  // Adds a solution with the residual 0.
  void Add(SolutionHistory& history, const Vectors& solution)
  {
    const Vectors right = this->Multiply(solution);
    Vectors guess;
    Vectors residual;
    history.Guess(this->Time, this->Matrix, this->IsFree, right, guess, residual);
    history.Add(solution, right, Vectors(right.size(), glm::dvec3(0.0)));
  }

  AbortCheck Time{ nullptr };
  QuadraticLattice Lattice;
  FiniteElements Elements;
  BlockMatrix Matrix;
  std::vector<unsigned char> IsFree;
};

double Length(const Vectors& vector)
{
  AbortCheck abortCheck(nullptr);
  return std::sqrt(SumOfProducts(abortCheck, vector, vector));
}

Vectors Combine(double a, const Vectors& first, double b, const Vectors& second)
{
  Vectors result;
  for (std::size_t i = 0; i < first.size(); ++i)
  {
    result.push_back(a * first[i] + b * second[i]);
  }
  return result;
}

} // namespace

TEST(SolutionHistory, GuessesAreCombinationsOfSolutions)
{
  System system;
  SolutionHistory history;
  std::mt19937 random(1);
  const Vectors zero(system.IsFree.size(), glm::dvec3(0.0));
  Vectors guess;
  Vectors residual;
  const Vectors right = system.Multiply(system.MakeVector(random));
  history.Guess(system.Time, system.Matrix, system.IsFree, right, guess, residual);
  EXPECT_EQ(guess, zero);
  EXPECT_EQ(residual, right);

  std::vector<Vectors> solutions;
  for (int i = 0; i < 4; ++i)
  {
    solutions.push_back(system.MakeVector(random));
    system.Add(history, solutions.back());
  }
  // A combination of the last three solutions.
  const Vectors wanted =
    Combine(1.0, Combine(0.5, solutions[1], -2.0, solutions[2]), 3.0, solutions[3]);
  history.Guess(
    system.Time, system.Matrix, system.IsFree, system.Multiply(wanted), guess, residual);
  EXPECT_LT(Length(Combine(1.0, guess, -1.0, wanted)), 1e-12 * Length(wanted));
  EXPECT_LT(Length(residual), 1e-12 * Length(system.Multiply(wanted)));
  // The first solution was discarded: the residual is orthogonal to the other solutions.
  const Vectors rest = system.Multiply(solutions[0]);
  history.Guess(system.Time, system.Matrix, system.IsFree, rest, guess, residual);
  EXPECT_GT(Length(residual), 0.1 * Length(rest));
  for (int i = 1; i < 4; ++i)
  {
    EXPECT_LT(std::abs(SumOfProducts(system.Time, residual, solutions[i])),
      1e-12 * Length(rest) * Length(solutions[i]));
  }
  history.Clear();
  history.Guess(system.Time, system.Matrix, system.IsFree, rest, guess, residual);
  EXPECT_EQ(guess, zero);
}

TEST(SolutionHistory, SkipsDependentSolutions)
{
  System system;
  SolutionHistory history;
  std::mt19937 random(2);
  const Vectors solution = system.MakeVector(random);
  const Vectors zero(system.IsFree.size(), glm::dvec3(0.0));
  for (const Vectors& added :
    { solution, Combine(2.0, solution, 1e-9, system.MakeVector(random)), zero })
  {
    system.Add(history, added);
  }
  const Vectors right = system.MakeVector(random);
  Vectors guess;
  Vectors residual;
  history.Guess(system.Time, system.Matrix, system.IsFree, right, guess, residual);
  const double factor = SumOfProducts(system.Time, solution, right) /
    SumOfProducts(system.Time, solution, system.Multiply(solution));
  EXPECT_LT(Length(Combine(1.0, guess, -factor, solution)), 1e-8 * Length(guess));
  EXPECT_LT(Length(Combine(1.0, Combine(1.0, right, -1.0, residual), -1.0, system.Multiply(guess))),
    1e-12 * Length(right));
}

TEST(SolutionHistory, ProductsFollowAChangedMatrix)
{
  System soft;
  System stiff(7e4);
  SolutionHistory history;
  std::mt19937 random(3);
  const Vectors solution = soft.MakeVector(random);
  soft.Add(history, solution);
  history.ForgetProducts();
  const Vectors right = stiff.Multiply(solution);
  Vectors guess;
  Vectors residual;
  history.Guess(stiff.Time, stiff.Matrix, stiff.IsFree, right, guess, residual);
  EXPECT_LT(Length(Combine(1.0, guess, -1.0, solution)), 1e-12 * Length(solution));
  EXPECT_LT(Length(residual), 1e-12 * Length(right));
}
