// SPDX-License-Identifier: BSD-3-Clause
#include "TangentSolver.h"

#include "RowParts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace deformvolume
{
namespace
{

// With fewer free nodes, block Jacobi is enough.
constexpr std::ptrdiff_t LeastNumberForLevels = 300;

// After more iterations, a hierarchy of doubles is faster.
constexpr int MostIterationsWithFloats = 300;

} // namespace

void TangentSolver::Forget()
{
  this->IsFree.clear();
  this->IsPreconditioned = false;
  this->AreDoubles = false;
  this->History.Clear();
}

void TangentSolver::Update(
  AbortCheck& abortCheck, const std::vector<glm::dvec3>& displacements, bool isClamped)
{
  this->IsPreconditioned = false;
  this->AreLevelsNew = false;
  this->IsClamped = isClamped;
  this->History.ForgetProducts();
  this->Elements.AssembleTangent(abortCheck, displacements, isClamped, this->Matrix);
  this->Sliding.Constrain(this->Matrix);
  this->Shape = displacements;
}

std::vector<glm::dvec3> TangentSolver::FindPositions() const
{
  std::vector<glm::dvec3> positions = this->Points;
  for (std::size_t node = 0; node < positions.size(); ++node)
  {
    positions[node] += this->Shape[node];
  }
  return positions;
}

Preconditioner& TangentSolver::Precondition(
  AbortCheck& abortCheck, const std::vector<unsigned char>& isFree)
{
  const bool isNew = this->IsFree != isFree;
  this->HasLevels = std::count(isFree.begin(), isFree.end(), 1) >= LeastNumberForLevels;
  const bool isCurrent = !isNew && this->IsPreconditioned;
  this->IsFree = isFree;
  this->IsPreconditioned = true;
  if (!this->HasLevels)
  {
    if (!isCurrent)
    {
      this->Jacobi.Build(abortCheck, this->Matrix, isFree);
    }
    return this->Jacobi;
  }
  if (isNew)
  {
    this->Levels = Multigrid<float>();
    this->LevelsOfDoubles = Multigrid<double>();
    this->CostOfLevels = 0.0;
    this->AreLevelsNew = true;
  }
  const auto prepare = [&](auto& levels) -> Preconditioner&
  {
    if (isNew)
    {
      levels.Build(abortCheck, this->Matrix, isFree, this->FindPositions());
    }
    if (!isCurrent)
    {
      levels.SetPositions(abortCheck, this->Matrix.GetPattern(), this->FindPositions());
    }
    return levels;
  };
  return this->AreDoubles ? prepare(this->LevelsOfDoubles) : prepare(this->Levels);
}

void TangentSolver::JudgeLevels(int iterations, double digits)
{
  // Building the hierarchy takes about as long as some tens of iterations.
  constexpr int fewIterations = 30;
  constexpr double manyTimes = 2.5;
  const double cost = iterations / std::max(0.1, digits);
  if (!this->HasLevels)
  {
    return;
  }
  if (this->CostOfLevels == 0.0)
  {
    this->CostOfLevels = std::max(1.0, cost);
  }
  else if (iterations > fewIterations && cost > manyTimes * this->CostOfLevels)
  {
    this->IsFree.clear();
  }
}

ConjugateGradients::Result TangentSolver::Solve(AbortCheck& abortCheck,
  const std::vector<unsigned char>& isFree, const std::vector<glm::dvec3>& rightHandSide,
  const Limits& limits, bool usesHistory, std::vector<glm::dvec3>& solution)
{
  const double squared = SumOfProducts(abortCheck, rightHandSide, rightHandSide);
  const double wanted = limits.Tolerance * limits.Tolerance * squared;
  if (this->IsFree != isFree)
  {
    this->History.Clear(); // stored solutions are for other free nodes
  }
  double begin = squared;
  if (usesHistory)
  {
    this->History.Guess(abortCheck, this->Matrix, isFree, rightHandSide, solution, this->Residual);
    begin = SumOfProducts(abortCheck, this->Residual, this->Residual);
  }
  if (!usesHistory || !(begin < squared))
  {
    solution.assign(rightHandSide.size(), glm::dvec3(0.0));
    this->Residual = rightHandSide;
    begin = squared;
  }
  ConjugateGradients::Result result;
  for (bool isSolved = false; !isSolved;)
  {
    Preconditioner& preconditioner = this->Precondition(abortCheck, isFree);
    const bool areFloats = this->HasLevels && !this->AreDoubles;
    const int left = limits.Iterations - result.Iterations;
    const int most = areFloats ? std::min(left, MostIterationsWithFloats) : left;
    const ConjugateGradients::Result part = this->Gradients.Solve(
      abortCheck, this->Matrix, isFree, preconditioner, { most, wanted }, solution, this->Residual);
    const bool isSlow = part.Iterations == most && most < left &&
      SumOfProducts(abortCheck, this->Residual, this->Residual) > wanted;
    result = { result.Iterations + part.Iterations, part.IsIndefinite };
    isSolved = !areFloats || !(isSlow || (part.IsIndefinite && this->IsClamped));
    if (!isSolved)
    {
      // The hierarchy belongs to another shape. If not, single precision is not enough: for slender
      // bodies, and if stiffnesses differ by more than 10^6.
      this->AreDoubles = this->AreLevelsNew;
      this->IsFree.clear();
    }
  }
  this->Sliding.Project(solution);
  if (result.IsIndefinite)
  {
    if (this->AreLevelsNew)
    {
      this->IsFree.clear(); // rebuild the hierarchy from a positive definite matrix
    }
    return result;
  }
  if (usesHistory)
  {
    this->History.Add(solution, rightHandSide, this->Residual);
  }
  this->JudgeLevels(
    result.Iterations, begin > 0.0 && wanted > 0.0 ? 0.5 * std::log10(begin / wanted) : 0.0);
  return result;
}

} // namespace deformvolume
