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

// With fewer free nodes the inverses of the diagonal are enough.
constexpr std::ptrdiff_t LeastNumberForLevels = 1000;

} // namespace

void TangentSolver::Forget()
{
  this->Now = State();
  this->ShapeOfMatrix.reset();
  this->SourceOfLevels.reset();
  this->History.Clear();
}

void TangentSolver::Begin()
{
  this->Before = this->Now;
  this->History.Begin();
}

void TangentSolver::Undo()
{
  this->Now = this->Before;
  this->IsPreconditioned = false;
  this->History.Undo();
}

void TangentSolver::Restore(Watch& watch, const std::vector<unsigned char>& isFree, bool usesMatrix)
{
  if (this->Now.Levels && this->Now.Levels != this->SourceOfLevels && *this->Now.IsFree == isFree)
  {
    this->Assemble(watch, this->Now.Levels->Shape);
    this->BuildLevels(watch, this->Now.Levels);
  }
  if (usesMatrix)
  {
    this->Assemble(watch, this->Now.Shape);
  }
}

void TangentSolver::Update(Watch& watch, const std::vector<glm::dvec3>& displacements)
{
  // A call that was undone may have made it already.
  const bool isThere = this->ShapeOfMatrix && *this->ShapeOfMatrix == displacements;
  this->Assemble(watch,
    isThere ? this->ShapeOfMatrix : std::make_shared<const std::vector<glm::dvec3>>(displacements));
  this->Now.Shape = this->ShapeOfMatrix;
  this->IsPreconditioned = false;
  this->History.ForgetProducts();
}

void TangentSolver::Assemble(Watch& watch, const Displacements& displacements)
{
  if (this->ShapeOfMatrix == displacements)
  {
    return;
  }
  this->ShapeOfMatrix.reset();
  this->IsPreconditioned = false;
  this->Elements.AssembleTangent(watch, *displacements, this->Matrix);
  this->ShapeOfMatrix = displacements;
}

void TangentSolver::BuildLevels(Watch& watch, const std::shared_ptr<const LevelsSource>& source)
{
  this->SourceOfLevels.reset();
  this->IsPreconditioned = false;
  this->Levels.Build(watch, this->Matrix, *source->IsFree, this->FindPositions(*source->Shape));
  this->SourceOfLevels = source;
}

std::vector<glm::dvec3> TangentSolver::FindPositions(
  const std::vector<glm::dvec3>& displacements) const
{
  std::vector<glm::dvec3> positions = this->Points;
  for (std::size_t node = 0; node < positions.size(); ++node)
  {
    positions[node] += displacements[node];
  }
  return positions;
}

Preconditioner& TangentSolver::Precondition(Watch& watch, const std::vector<unsigned char>& isFree)
{
  const bool isNew = !this->Now.IsFree || *this->Now.IsFree != isFree;
  this->HasLevels = std::count(isFree.begin(), isFree.end(), 1) >= LeastNumberForLevels;
  if (isNew)
  {
    this->Now.IsFree = std::make_shared<const std::vector<unsigned char>>(isFree);
    this->Now.Levels.reset();
    this->IsPreconditioned = false;
  }
  if (!this->HasLevels)
  {
    if (!this->IsPreconditioned)
    {
      this->Jacobi.Build(watch, this->Matrix, isFree);
    }
  }
  else
  {
    if (isNew)
    {
      // A call that was undone may have built them already.
      const bool areThere = this->SourceOfLevels && *this->SourceOfLevels->IsFree == isFree &&
        *this->SourceOfLevels->Shape == *this->Now.Shape;
      if (!areThere)
      {
        this->BuildLevels(watch,
          std::make_shared<const LevelsSource>(LevelsSource{ this->Now.Shape, this->Now.IsFree }));
      }
      this->Now.Levels = this->SourceOfLevels;
      this->Now.CostOfLevels = 0.0;
    }
    if (!this->IsPreconditioned)
    {
      this->Levels.SetPositions(
        watch, this->Matrix.GetPattern(), this->FindPositions(*this->Now.Shape));
    }
  }
  this->IsPreconditioned = true;
  return this->HasLevels ? static_cast<Preconditioner&>(this->Levels) : this->Jacobi;
}

void TangentSolver::JudgeLevels(int iterations, double digits)
{
  // It takes about as long to build them as some tens of iterations.
  constexpr int fewIterations = 30;
  constexpr double manyTimes = 2.5;
  const double cost = iterations / std::max(0.1, digits);
  if (!this->HasLevels)
  {
    return;
  }
  if (this->Now.CostOfLevels == 0.0)
  {
    this->Now.CostOfLevels = std::max(1.0, cost);
  }
  else if (iterations > fewIterations && cost > manyTimes * this->Now.CostOfLevels)
  {
    this->Now.IsFree.reset();
  }
}

int TangentSolver::Solve(Watch& watch, const std::vector<unsigned char>& isFree,
  const std::vector<glm::dvec3>& rightHandSide, const Limits& limits, bool repeats,
  std::vector<glm::dvec3>& solution)
{
  const double squared = SumOfProducts(watch, rightHandSide, rightHandSide);
  const double wanted = limits.Tolerance * limits.Tolerance * squared;
  if (!this->Now.IsFree || *this->Now.IsFree != isFree)
  {
    this->History.Clear(); // of other nodes
  }
  Preconditioner& preconditioner = this->Precondition(watch, isFree);
  double begin = squared;
  if (repeats)
  {
    this->History.Guess(watch, this->Matrix, isFree, rightHandSide, solution, this->Residual);
    begin = SumOfProducts(watch, this->Residual, this->Residual);
  }
  if (!repeats || !(begin < squared))
  {
    solution.assign(rightHandSide.size(), glm::dvec3(0.0));
    this->Residual = rightHandSide;
    begin = squared;
  }
  const int iterations = this->Gradients.Solve(watch, this->Matrix, isFree, preconditioner,
    { limits.Iterations, wanted }, solution, this->Residual);
  if (repeats)
  {
    this->History.Add(solution, rightHandSide, this->Residual);
  }
  this->JudgeLevels(
    iterations, begin > 0.0 && wanted > 0.0 ? 0.5 * std::log10(begin / wanted) : 0.0);
  return iterations;
}

} // namespace deformvolume
