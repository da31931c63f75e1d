// SPDX-License-Identifier: BSD-3-Clause
#include "EquilibriumSolver.h"

#include "Error.h"
#include "RowParts.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

namespace deformvolume
{

namespace
{

// Counts Newton steps that bring the body no closer to equilibrium while tetrahedra are inverted.
// With a load that is far too large nearly all steps are such, and each takes thousands of
// conjugate gradient iterations.
class StalledSteps
{
public:
  bool AreTooMany(double residual, bool isInverted)
  {
    // Bodies that did reach an equilibrium needed up to 13 such steps, with loads that stretched
    // them to seven times their length.
    constexpr int tooMany = 15;
    constexpr double leastGain = 0.9;
    if (residual < leastGain * this->Least)
    {
      this->Least = residual;
      this->Number = 0;
    }
    else if (isInverted)
    {
      ++this->Number;
    }
    return this->Number >= tooMany;
  }

private:
  double Least = std::numeric_limits<double>::infinity();
  int Number = 0;
};

} // namespace

EquilibriumSolver::EquilibriumSolver(AbortCheck& abortCheck, const ElasticBody& body)
  : Body(body)
  , Pieces(FindBodyPieces(body, &abortCheck))
  , ActivePieces(static_cast<std::size_t>(Pieces.NumberOfPieces), true)
  , Sliding(body)
  , Elements(abortCheck, body)
  , Tangent(this->Body.Points, this->Elements, this->Sliding)
{
  this->Last.Displacements.assign(body.Points.size(), glm::dvec3(0.0));
  this->Reactions = this->Last.Displacements;
  this->Tangent.SetPattern(abortCheck, MakeNodePattern(abortCheck, body));
  this->Elements.SetPattern(abortCheck, this->Tangent.GetMatrix().GetPattern());
  this->UpdateScale(abortCheck);
}

void EquilibriumSolver::UpdateScale(AbortCheck& abortCheck)
{
  this->Volumes.resize(this->Body.Tetrahedra.size());
  ForItemsInParallel(abortCheck, this->Volumes.size(),
    [&](std::size_t t)
    { this->Volumes[t] = QuadraticTetrahedron::GetGaussVolumes(this->Body, t); });
  double total = 0.0;
  for (const auto& volumes : this->Volumes)
  {
    total = std::accumulate(volumes.begin(), volumes.end(), total);
  }
  // A node has about six tetrahedra of its own: h is the side of a cube of their mean volume.
  constexpr double tetrahedraOfCell = 6.0;
  this->MeanEdge = std::cbrt(tetrahedraOfCell * total / static_cast<double>(this->Volumes.size()));
  this->LeastModulus = this->Body.Materials.front().YoungModulus;
  for (const ElasticMaterial& material : this->Body.Materials)
  {
    this->LeastModulus = std::min(this->LeastModulus, material.YoungModulus);
  }
}

double EquilibriumSolver::FindRounding(const std::vector<glm::dvec3>& displacements) const
{
  // The rounding errors of deformation gradients grow with the displacements. Poisson's ratios near
  // 0.5 multiply those of the forces by some hundreds.
  constexpr double rounding = 1e-13;
  double farthest = 0.0;
  for (const glm::dvec3& displacement : displacements)
  {
    farthest = std::max(farthest, LargestComponent(displacement));
  }
  return rounding * this->LeastModulus * this->MeanEdge * (this->MeanEdge + farthest);
}

bool EquilibriumSolver::IsWithinRounding(
  const EquilibriumProblem& problem, const State& state, double wanted) const
{
  std::vector<double> moduli(problem.IsFree.size(), 0.0);
  for (std::size_t t = 0; t < this->Body.Tetrahedra.size(); ++t)
  {
    this->Body.ForNodes(t,
      [&](std::int32_t node)
      {
        double& modulus = moduli[static_cast<std::size_t>(node)];
        modulus = std::max(modulus, this->Body.GetMaterial(t).YoungModulus);
      });
  }
  const double rounding = this->FindRounding(state.Displacements) / this->LeastModulus;
  for (std::size_t node = 0; node < moduli.size(); ++node)
  {
    const glm::dvec3 left = this->Sliding.Project(node, problem.Loads[node] - state.Forces[node]);
    if (problem.IsFree[node] != 0 &&
      LargestComponent(left) > std::max(wanted, rounding * moduli[node]))
    {
      return false;
    }
  }
  return true;
}

void EquilibriumSolver::SetMaterials(const std::vector<ElasticMaterial>& materials)
{
  this->Body.Materials = materials;
  this->Elements.SetMaterials(this->Body);
  AbortCheck abortCheck(nullptr);
  this->UpdateScale(abortCheck);
  this->Forget();
}

void EquilibriumSolver::SetMaterialModel(MaterialModel model)
{
  if (model != this->Elements.GetMaterialModel())
  {
    this->Elements.SetMaterialModel(model);
    this->Forget();
  }
}

void EquilibriumSolver::SetDisplacements(const std::vector<glm::dvec3>& displacements)
{
  this->Last.Displacements = displacements;
  this->RigidPieces.clear();
  this->LastingDents.clear();
  this->HasStalled = false;
  this->Forget();
}

std::vector<glm::dvec3> EquilibriumSolver::GetStart() const
{
  // From the tangled body, smaller loads would not reach an equilibrium either.
  return this->HasStalled
    ? std::vector<glm::dvec3>(this->Last.Displacements.size(), glm::dvec3(0.0))
    : this->Last.Displacements;
}

void EquilibriumSolver::Forget()
{
  this->HasForces = false;
  this->HasLookedForDents = false;
  this->HasTangent = false;
  this->ClampedSteps = 0;
  this->Tangent.Forget();
}

std::vector<glm::dvec3> EquilibriumSolver::GetForces() const
{
  std::vector<glm::dvec3> forces;
  AbortCheck abortCheck(nullptr);
  this->Elements.FindForces(abortCheck, this->Last.Displacements, forces);
  return forces;
}

std::vector<ElementResults> EquilibriumSolver::GetElementResults() const
{
  return this->Elements.GetResults(this->Last.Displacements);
}

void EquilibriumSolver::Evaluate(
  AbortCheck& abortCheck, const EquilibriumProblem& problem, State& state) const
{
  state.Sums = this->Elements.FindForces(abortCheck, state.Displacements, state.Forces);
  this->FindPotential(abortCheck, problem, state);
}

void EquilibriumSolver::FindPotential(
  AbortCheck& abortCheck, const EquilibriumProblem& problem, State& state) const
{
  state.Potential = state.Sums.Energy -
    SumOfParts(abortCheck, problem.Loads.size(),
      [&](std::size_t begin, std::size_t end)
      {
        double sum = 0.0;
        for (std::size_t node = begin; node < end; ++node)
        {
          sum += glm::dot(problem.Loads[node], state.Displacements[node]);
        }
        return sum;
      });
}

void EquilibriumSolver::UpdateTangent(
  AbortCheck& abortCheck, const EquilibriumProblem& problem, const State& state)
{
  if (this->HasTangent && problem.IsInteractive)
  {
    return;
  }
  this->Tangent.Update(abortCheck, state.Displacements, this->ClampedSteps > 0);
  this->HasTangent = true;
  this->IsTangentOld = false;
}

void EquilibriumSolver::MoveToNeighbors(AbortCheck& abortCheck, const EquilibriumProblem& problem,
  const std::vector<unsigned char>& isChosen, const State& state, State& moved) const
{
  const BlockPattern& pattern = this->Tangent.GetMatrix().GetPattern();
  moved.Displacements = state.Displacements;
  ForRows(abortCheck, isChosen.size(),
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t node = begin; node < end; ++node)
      {
        if (isChosen[node] == 0 || problem.IsFree[node] == 0)
        {
          continue;
        }
        glm::dvec3 sum(0.0);
        for (std::int32_t block = pattern.Rows[node]; block < pattern.Rows[node + 1]; ++block)
        {
          sum += state.Displacements[static_cast<std::size_t>(
            pattern.Columns[static_cast<std::size_t>(block)])];
        }
        // Do not count the node itself, which is in the row as well.
        const double neighbors = pattern.Rows[node + 1] - pattern.Rows[node] - 1;
        moved.Displacements[node] =
          this->Sliding.Project(node, (sum - state.Displacements[node]) / neighbors);
      }
    });
  this->Evaluate(abortCheck, problem, moved);
}

void EquilibriumSolver::Untangle(
  AbortCheck& abortCheck, const EquilibriumProblem& problem, State& state)
{
  // Continue only while the energy falls by at least this fraction of the strain energy.
  constexpr double leastFall = 0.01;
  std::vector<unsigned char> isInverted;
  while (state.Sums.Inverted > 0)
  {
    this->Elements.FindInvertedNodes(abortCheck, state.Displacements, isInverted);
    this->MoveToNeighbors(abortCheck, problem, isInverted, state, this->Trial);
    if (!(this->Trial.Potential < state.Potential - leastFall * state.Sums.Energy))
    {
      return;
    }
    std::swap(state, this->Trial);
    this->HasTangent = false;
  }
}

double EquilibriumSolver::ChooseTolerance(const EquilibriumProblem& problem, double wanted)
{
  constexpr double share = 0.3;
  return problem.IsInteractive ? std::clamp(share * wanted, problem.Limits.LinearTolerance, share)
                               : problem.Limits.LinearTolerance;
}

bool EquilibriumSolver::SolveLinear(AbortCheck& abortCheck, const EquilibriumProblem& problem,
  const State& state, double tolerance, EquilibriumReport& report)
{
  for (std::size_t node = 0; node < problem.IsFree.size(); ++node)
  {
    // Held nodes and nodes of frozen pieces do not move, so their residual is 0.
    this->RightHandSide[node] = problem.IsFree[node] != 0
      ? this->RightHandSide[node] + problem.Loads[node] - state.Forces[node]
      : glm::dvec3(0.0);
  }
  this->Sliding.Project(this->RightHandSide);
  const ConjugateGradients::Result result =
    this->Tangent.Solve(abortCheck, problem.IsFree, this->RightHandSide,
      { problem.Limits.LinearIterations, tolerance }, report.NewtonSteps == 0, this->Direction);
  report.LinearIterations += result.Iterations;
  ++report.NewtonSteps;
  return !result.IsIndefinite;
}

bool EquilibriumSolver::Clamp()
{
  constexpr int steps = 3;
  const bool wasClamped = this->ClampedSteps > 0;
  this->ClampedSteps = steps;
  this->HasTangent = this->HasTangent && wasClamped;
  return !wasClamped;
}

bool EquilibriumSolver::MoveHeldNodes(AbortCheck& abortCheck, const EquilibriumProblem& problem,
  State& state, EquilibriumReport& report)
{
  const std::size_t nodes = problem.IsFree.size();
  std::vector<glm::dvec3> moves(nodes, glm::dvec3(0.0));
  bool isMoved = false;
  for (std::size_t i = 0; i < problem.HeldNodes.size(); ++i)
  {
    const auto node = static_cast<std::size_t>(problem.HeldNodes[i]);
    moves[node] = problem.Targets[i] - state.Displacements[node];
    isMoved = isMoved || LargestComponent(moves[node]) > 0.0;
  }
  if (!isMoved)
  {
    return false;
  }
  bool isPositive = false;
  do
  {
    this->UpdateTangent(abortCheck, problem, state);
    ForRows(abortCheck, nodes,
      [&](std::size_t begin, std::size_t end)
      {
        this->Tangent.GetMatrix().Multiply(
          begin, end, problem.IsFree.data(), moves.data(), this->RightHandSide.data());
        for (std::size_t node = begin; node < end; ++node)
        {
          this->RightHandSide[node] = -this->RightHandSide[node];
        }
      });
    isPositive =
      this->SolveLinear(abortCheck, problem, state, problem.Limits.LinearTolerance, report);
  } while (!isPositive && this->Clamp());
  State guess;
  guess.Displacements = state.Displacements;
  for (std::size_t node = 0; node < nodes; ++node)
  {
    state.Displacements[node] += moves[node];
    guess.Displacements[node] += moves[node] + this->Direction[node];
  }
  // Set the prescribed displacements exactly, without rounding.
  for (std::size_t i = 0; i < problem.HeldNodes.size(); ++i)
  {
    const auto node = static_cast<std::size_t>(problem.HeldNodes[i]);
    state.Displacements[node] = problem.Targets[i];
    guess.Displacements[node] = problem.Targets[i];
  }
  const std::int64_t inverted = state.Sums.Inverted;
  this->Evaluate(abortCheck, problem, guess);
  if (guess.Sums.Inverted > inverted || !std::isfinite(guess.Potential))
  {
    // The linear response inverts tetrahedra. Moving only the held nodes may give a lower energy.
    this->Evaluate(abortCheck, problem, state);
    if (state.Potential <= guess.Potential || !std::isfinite(guess.Potential))
    {
      this->HasTangent = false;
      return true;
    }
  }
  std::swap(state, guess);
  return true;
}

bool EquilibriumSolver::Search(
  AbortCheck& abortCheck, const EquilibriumProblem& problem, State& state)
{
  constexpr int halvings = 30;
  constexpr double leastFall = 1e-4;
  // The rounding errors of sums of energies.
  constexpr double rounding = 1e-13;
  constexpr double roundingOfTerms = 1e-15;
  const std::size_t nodes = problem.IsFree.size();
  double slope = 0.0;
  for (std::size_t node = 0; node < nodes; ++node)
  {
    slope -= glm::dot(this->RightHandSide[node], this->Direction[node]);
  }
  const double slack = rounding * (state.Sums.Energy + std::abs(state.Potential)) +
    roundingOfTerms * state.Sums.SizeOfTerms;
  const double residual = FindResiduals(problem, this->Sliding, state.Forces).Largest;
  double length = 1.0;
  for (int halving = 0; halving < halvings; ++halving, length *= 0.5)
  {
    this->Trial.Displacements.resize(nodes);
    for (std::size_t node = 0; node < nodes; ++node)
    {
      this->Trial.Displacements[node] = state.Displacements[node] + length * this->Direction[node];
    }
    this->Evaluate(abortCheck, problem, this->Trial);
    if (!(this->Trial.Potential <= state.Potential + leastFall * length * slope + slack))
    {
      continue;
    }
    // If rounding hides whether the energy falls, compare the unbalanced forces instead.
    if (-slope * length <= slack &&
      !(FindResiduals(problem, this->Sliding, this->Trial.Forces).Largest < residual))
    {
      return false;
    }
    std::swap(state, this->Trial);
    return true;
  }
  return false;
}

bool EquilibriumSolver::Step(AbortCheck& abortCheck, const EquilibriumProblem& problem,
  double tolerance, State& state, EquilibriumReport& report)
{
  do
  {
    this->UpdateTangent(abortCheck, problem, state);
    this->RightHandSide.assign(problem.IsFree.size(), glm::dvec3(0.0));
    const bool isPositive = this->SolveLinear(abortCheck, problem, state, tolerance, report);
    if ((isPositive || this->ClampedSteps > 0) && this->Search(abortCheck, problem, state))
    {
      this->ClampedSteps = std::max(0, this->ClampedSteps - 1);
      return true;
    }
  } while (this->Clamp());
  return false;
}

EquilibriumReport EquilibriumSolver::Solve(const EquilibriumRequest& request)
{
  const EquilibriumProblem problem =
    MakeProblem(request, this->Body, this->Pieces, this->Volumes, this->Sliding);
  AbortCheck abortCheck(request.Progress);
  abortCheck.Check();
  this->UseHeldPieces(problem);
  try
  {
    return this->FindEquilibrium(abortCheck, request, problem);
  }
  catch (...)
  {
    this->Forget();
    throw;
  }
}

void EquilibriumSolver::UseHeldPieces(const EquilibriumProblem& problem)
{
  if (this->ActivePieces == problem.Supports.IsHeld)
  {
    return;
  }
  this->ActivePieces = problem.Supports.IsHeld;
  this->Elements.SetActivePieces(this->Body, this->Pieces, this->ActivePieces);
  this->Forget();
}

void EquilibriumSolver::MoveFrozenPieces(
  const EquilibriumProblem& problem, const std::vector<bool>& isFree, State& state) const
{
  const bool areAny = std::find(isFree.begin(), isFree.end(), true) != isFree.end();
  if (areAny && isFree != this->RigidPieces)
  {
    MakePiecesRigid(this->Body, this->Pieces, isFree, state.Displacements);
  }
  if (problem.Supports.Following.empty())
  {
    return;
  }
  std::vector<unsigned char> isSettled = problem.IsFree;
  for (const std::int32_t node : problem.HeldNodes)
  {
    isSettled[static_cast<std::size_t>(node)] = 1;
  }
  MoveFollowing(
    this->Body, this->Pieces, problem.Supports.Following, isSettled, state.Displacements);
}

bool EquilibriumSolver::Iterate(AbortCheck& abortCheck, const EquilibriumProblem& problem,
  double tolerance, State& state, EquilibriumReport& report)
{
  double before = 0.0;
  StalledSteps stalledSteps;
  bool hasStalled = false;
  for (;;)
  {
    const Residuals residuals = FindResiduals(problem, this->Sliding, state.Forces);
    if (!std::isfinite(residuals.Largest) || !std::isfinite(state.Potential))
    {
      throw Error(
        "The forces in the body are infinite or not a number: a load or the displacement of "
        "a handle is too large. The displacements are unchanged.");
    }
    report.Residual = residuals.Largest;
    report.RelativeResidual =
      residuals.Reference > 0.0 ? residuals.Largest / residuals.Reference : 0.0;
    const double wanted =
      std::max(tolerance * residuals.Reference, this->FindRounding(state.Displacements));
    report.IsConverged = residuals.Largest <= wanted;
    // Reuse a tangent of another state only while it reduces the residual by at least this factor.
    constexpr double leastGain = 0.2;
    if (before > 0.0 && residuals.Largest > leastGain * before)
    {
      this->HasTangent = false;
    }
    before = residuals.Largest;
    hasStalled =
      !report.IsConverged && stalledSteps.AreTooMany(residuals.Largest, state.Sums.Inverted > 0);
    if (report.IsConverged || hasStalled || report.NewtonSteps >= problem.Limits.NewtonSteps)
    {
      break;
    }
    if (!this->Step(
          abortCheck, problem, ChooseTolerance(problem, wanted / residuals.Largest), state, report))
    {
      // Beside soft tissue, the rounding errors of bone can be greater than the forces of the
      // tissue allow.
      report.IsConverged = this->IsWithinRounding(problem, state, wanted);
      break;
    }
  }
  return hasStalled;
}

void EquilibriumSolver::RemoveDents(AbortCheck& abortCheck, const EquilibriumProblem& problem,
  double tolerance, State& state, EquilibriumReport& report)
{
  const std::vector<unsigned char> isInverted =
    FindInvertedSplits(abortCheck, this->Body, state.Displacements);
  if (std::find(isInverted.begin(), isInverted.end(), 1) == isInverted.end() ||
    isInverted == this->LastingDents)
  {
    return;
  }
  std::vector<unsigned char> isChosen(problem.IsFree.size(), 0);
  for (std::size_t t = 0; t < isInverted.size(); ++t)
  {
    this->Body.ForNodes(
      t, [&](std::int32_t node) { isChosen[static_cast<std::size_t>(node)] |= isInverted[t]; });
  }
  State other;
  this->MoveToNeighbors(abortCheck, problem, isChosen, state, other);
  if (!std::isfinite(other.Potential) ||
    !std::isfinite(FindResiduals(problem, this->Sliding, other.Forces).Largest))
  {
    return;
  }
  EquilibriumReport after = report;
  this->HasTangent = false;
  this->Iterate(abortCheck, problem, tolerance, other, after);
  if (after.IsConverged && other.Potential < state.Potential)
  {
    std::swap(state, other);
    report = after;
    return;
  }
  report.NewtonSteps = after.NewtonSteps;
  report.LinearIterations = after.LinearIterations;
  this->HasTangent = false;
  this->ClampedSteps = 0;
  this->LastingDents = isInverted;
}

EquilibriumReport EquilibriumSolver::FindEquilibrium(
  AbortCheck& abortCheck, const EquilibriumRequest& request, const EquilibriumProblem& problem)
{
  const EquilibriumLimits& limits = problem.Limits;
  EquilibriumReport report;
  const std::vector<bool>& isHeld = problem.Supports.IsHeld;
  report.NumberOfFrozenPieces =
    static_cast<std::int32_t>(std::count(isHeld.begin(), isHeld.end(), false));
  report.NumberOfFollowingPieces = static_cast<std::int32_t>(problem.Supports.Following.size());
  if (report.NumberOfFrozenPieces > 0)
  {
    const auto first = std::find(isHeld.begin(), isHeld.end(), false) - isHeld.begin();
    const std::int32_t tetrahedron =
      this->Pieces.Tetrahedra[this->Pieces.Begins[static_cast<std::size_t>(first)]];
    report.FrozenNodes = this->Body.Tetrahedra[static_cast<std::size_t>(tetrahedron)];
  }
  this->RightHandSide.resize(problem.IsFree.size());
  State state = this->Last;
  if (this->HasStalled)
  {
    state.Displacements = this->GetStart();
  }
  if (this->HasForces)
  {
    this->FindPotential(abortCheck, problem, state);
  }
  else
  {
    // The displacements were set, or the planes differ from those of the last call.
    for (std::size_t node = 0; node < problem.IsFree.size(); ++node)
    {
      if (problem.IsFree[node] != 0)
      {
        state.Displacements[node] = this->Sliding.Project(node, state.Displacements[node]);
      }
    }
    this->Evaluate(abortCheck, problem, state);
  }
  // Do not untangle tetrahedra that were already inverted after the last call.
  const std::int64_t inverted = this->HasForces ? state.Sums.Inverted : 0;
  const bool isMoved = this->MoveHeldNodes(abortCheck, problem, state, report);
  if (state.Sums.Inverted > inverted)
  {
    this->Untangle(abortCheck, problem, state);
  }
  // Frames of an animation follow each other, so frames in which the body moves need not be solved
  // accurately.
  constexpr double toleranceOfFrames = 1e-2;
  const double tolerance =
    problem.IsInteractive && isMoved && request.Limits.RelativeTolerance == 0.0
    ? toleranceOfFrames
    : limits.RelativeTolerance;
  const bool hasStalled = this->Iterate(abortCheck, problem, tolerance, state, report);
  const bool looksForDents = !problem.IsInteractive && report.IsConverged;
  if (looksForDents && (report.NewtonSteps > 0 || !this->HasLookedForDents))
  {
    this->RemoveDents(abortCheck, problem, tolerance, state, report);
  }
  if (report.NewtonSteps > 1 && this->IsTangentOld)
  {
    // A tangent of an earlier call took several steps: a new one is cheaper in the next call.
    this->HasTangent = false;
  }
  this->IsTangentOld = true;
  std::vector<bool> isFree = FindFreePieces(problem.Supports);
  this->MoveFrozenPieces(problem, isFree, state);
  report.StrainEnergy = state.Sums.Energy;
  this->Reactions = FindReactions(problem, this->Sliding, state.Forces);
  const std::vector<unsigned char> isInverted =
    FindInvertedSplits(abortCheck, this->Body, state.Displacements);
  report.NumberOfInvertedTetrahedra = std::count(isInverted.begin(), isInverted.end(), 1);
  std::swap(this->Last, state);
  this->RigidPieces = std::move(isFree);
  this->HasForces = true;
  this->HasLookedForDents = looksForDents;
  this->HasStalled = hasStalled;
  if (hasStalled)
  {
    this->Forget();
  }
  return report;
}

} // namespace deformvolume
