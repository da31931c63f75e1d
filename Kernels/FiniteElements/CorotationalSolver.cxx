// SPDX-License-Identifier: BSD-3-Clause
#include "CorotationalSolver.h"

#include "Error.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>

namespace deformvolume
{
namespace
{

// With fewer free nodes the inverses of the diagonal are enough.
constexpr std::ptrdiff_t LeastNumberForLevels = 1000;

double LargestComponent(const glm::dvec3& vector)
{
  const glm::dvec3 sizes = glm::abs(vector);
  return std::max({ sizes.x, sizes.y, sizes.z });
}

// What is 0 in the limits of a request is chosen by the mode.
CorotationalLimits ChooseLimits(const CorotationalRequest& request)
{
  CorotationalLimits limits = request.Limits;
  const auto choose = [&](auto& value, auto interactive, auto converged)
  {
    if (!(value >= 0 && std::isfinite(static_cast<double>(value))))
    {
      throw Error("A limit of the solver is less than 0 or not finite.");
    }
    if (value == 0)
    {
      value = request.Mode == CorotationalMode::Interactive ? interactive : converged;
    }
  };
  choose(limits.NewtonSteps, 2, 200);
  choose(limits.LinearIterations, 500, 5000);
  choose(limits.LinearTolerance, 1e-2, 1e-6);
  choose(limits.RelativeTolerance, 1e-3, 1e-6);
  choose(limits.AbsoluteTolerance, 1e-6, 1e-11);
  return limits;
}

} // namespace

CorotationalSolver::CorotationalSolver(const ElasticBody& body)
  : Body(body)
  , Pieces(FindPieces(body))
  , Elements(body)
{
  this->Last.Displacements.assign(body.Points.size(), glm::dvec3(0.0));
  this->Matrix.SetPattern(MakeNodePattern(body));
  this->Elements.SetPattern(this->Matrix.GetPattern());
  this->UpdateScale();
}

void CorotationalSolver::UpdateScale()
{
  const std::vector<double> volumes = GetVolumes(this->Body);
  this->Masses = GetNodeMasses(this->Body, volumes);
  double total = 0.0;
  for (const double volume : volumes)
  {
    total += volume;
  }
  // A cell of as many tetrahedra as a node has on average of its own.
  constexpr double tetrahedraOfCell = 6.0;
  const double size = std::cbrt(tetrahedraOfCell * total / static_cast<double>(volumes.size()));
  double modulus = this->Body.Materials.front().YoungModulus;
  for (const ElasticMaterial& material : this->Body.Materials)
  {
    modulus = std::min(modulus, material.YoungModulus);
  }
  this->ForceScale = modulus * size * size;
}

void CorotationalSolver::SetMaterials(const std::vector<ElasticMaterial>& materials)
{
  this->Body.Materials = materials;
  this->Elements.SetMaterials(this->Body);
  this->UpdateScale();
  this->HasForces = false;
  this->IsFreeInLevels.clear();
}

void CorotationalSolver::SetDisplacements(const std::vector<glm::dvec3>& displacements)
{
  this->Last.Displacements = displacements;
  this->HasForces = false;
  this->IsFreeInLevels.clear();
}

std::vector<glm::dvec3> CorotationalSolver::GetForces() const
{
  std::vector<glm::dvec3> forces;
  Watch watch(nullptr);
  this->Elements.FindForces(watch, this->Last.Displacements, forces);
  return forces;
}

std::vector<ElementResults> CorotationalSolver::GetElementResults() const
{
  return this->Elements.GetResults(this->Last.Displacements);
}

CorotationalSolver::Problem CorotationalSolver::MakeProblem(
  const CorotationalRequest& request) const
{
  CheckLoads(this->Body, request.Loads);
  CheckHeldNodes(this->Body, request.Held);
  const std::size_t nodes = this->Body.Points.size();
  std::vector<unsigned char> isNotFree(this->Body.Fixed);
  isNotFree.resize(nodes, 0);
  std::vector<glm::dvec3> targets(nodes, glm::dvec3(0.0));
  for (const HeldNode& held : request.Held)
  {
    isNotFree[static_cast<std::size_t>(held.Node)] = 1;
    targets[static_cast<std::size_t>(held.Node)] = held.Displacement;
  }
  const std::vector<bool> isHeld = FindHeldPieces(this->Body, this->Pieces, isNotFree);
  Problem problem;
  problem.FrozenPieces = static_cast<std::int32_t>(std::count(isHeld.begin(), isHeld.end(), false));
  if (problem.FrozenPieces == this->Pieces.NumberOfPieces)
  {
    throw Error("No constraints: nothing holds the body. Fix or hold at least three of its nodes "
                "that do not lie on a line.");
  }
  problem.IsFree.assign(nodes, 0);
  problem.Loads.assign(nodes, glm::dvec3(0.0));
  for (std::size_t node = 0; node < nodes; ++node)
  {
    const std::int32_t piece = this->Pieces.PieceOfNode[node];
    if (piece < 0 || !isHeld[static_cast<std::size_t>(piece)])
    {
      continue;
    }
    problem.Loads[node] = request.Loads.Gravity * this->Masses[node];
    if (!request.Loads.Forces.empty())
    {
      problem.Loads[node] += request.Loads.Forces[node];
    }
    if (isNotFree[node] != 0)
    {
      problem.HeldNodes.push_back(static_cast<std::int32_t>(node));
      problem.Targets.push_back(targets[node]);
    }
    else
    {
      problem.IsFree[node] = 1;
    }
  }
  return problem;
}

void CorotationalSolver::Evaluate(Watch& watch, const Problem& problem, State& state) const
{
  state.Sums = this->Elements.FindForces(watch, state.Displacements, state.Forces);
  this->FindPotential(watch, problem, state);
}

void CorotationalSolver::FindPotential(Watch& watch, const Problem& problem, State& state) const
{
  state.Potential = state.Sums.Energy -
    SumOfParts(watch, problem.Loads.size(),
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

CorotationalSolver::Residuals CorotationalSolver::FindResidual(
  const Problem& problem, const State& state) const
{
  Residuals residuals;
  for (std::size_t node = 0; node < problem.IsFree.size(); ++node)
  {
    if (problem.IsFree[node] != 0)
    {
      residuals.Largest =
        std::max(residuals.Largest, LargestComponent(problem.Loads[node] - state.Forces[node]));
      residuals.Reference = std::max(residuals.Reference, LargestComponent(problem.Loads[node]));
    }
  }
  for (const std::int32_t node : problem.HeldNodes)
  {
    const auto i = static_cast<std::size_t>(node);
    residuals.Reference =
      std::max(residuals.Reference, LargestComponent(problem.Loads[i] - state.Forces[i]));
  }
  return residuals;
}

Preconditioner& CorotationalSolver::Precondition(
  Watch& watch, const Problem& problem, const State& state)
{
  const auto number = std::count(problem.IsFree.begin(), problem.IsFree.end(), 1);
  if (number < LeastNumberForLevels)
  {
    this->Jacobi.Build(watch, this->Matrix, problem.IsFree);
    return this->Jacobi;
  }
  std::vector<glm::dvec3> positions = this->Body.Points;
  for (std::size_t node = 0; node < positions.size(); ++node)
  {
    positions[node] += state.Displacements[node];
  }
  if (this->IsFreeInLevels != problem.IsFree)
  {
    this->IsFreeInLevels.clear();
    this->Levels.Build(watch, this->Matrix, problem.IsFree, positions);
    this->CostOfLevels = 0.0;
    this->IsFreeInLevels = problem.IsFree;
  }
  this->Levels.SetPositions(watch, this->Matrix.GetPattern(), positions);
  return this->Levels;
}

void CorotationalSolver::JudgeLevels(int iterations, const CorotationalLimits& limits)
{
  // It takes about as long to build them as some tens of iterations.
  constexpr int fewIterations = 30;
  constexpr double manyTimes = 2.5;
  const double cost = iterations / std::max(0.1, -std::log10(limits.LinearTolerance));
  if (this->CostOfLevels == 0.0)
  {
    this->CostOfLevels = std::max(1.0, cost);
  }
  else if (iterations > fewIterations && cost > manyTimes * this->CostOfLevels)
  {
    this->IsFreeInLevels.clear();
  }
}

void CorotationalSolver::SolveLinear(Watch& watch, const Problem& problem,
  const CorotationalLimits& limits, const State& state, CorotationalReport& report)
{
  for (std::size_t node = 0; node < problem.IsFree.size(); ++node)
  {
    // Of frozen and held nodes the residual is none of our business.
    this->RightHandSide[node] = problem.IsFree[node] != 0
      ? this->RightHandSide[node] + problem.Loads[node] - state.Forces[node]
      : glm::dvec3(0.0);
  }
  const int iterations = this->Gradients.Solve(watch, this->Matrix, problem.IsFree,
    this->Precondition(watch, problem, state), this->RightHandSide,
    { limits.LinearIterations, limits.LinearTolerance }, this->Direction);
  this->JudgeLevels(iterations, limits);
  report.LinearIterations += iterations;
  ++report.NewtonSteps;
}

void CorotationalSolver::MoveHeldNodes(Watch& watch, const Problem& problem,
  const CorotationalLimits& limits, State& state, CorotationalReport& report)
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
    return;
  }
  this->Elements.AssembleTangent(watch, state.Displacements, this->Matrix);
  SumOfParts(watch, nodes,
    [&](std::size_t begin, std::size_t end)
    {
      this->Matrix.Multiply(
        begin, end, problem.IsFree.data(), moves.data(), this->RightHandSide.data());
      for (std::size_t node = begin; node < end; ++node)
      {
        this->RightHandSide[node] = -this->RightHandSide[node];
      }
      return 0.0;
    });
  this->SolveLinear(watch, problem, limits, state, report);
  State guess;
  guess.Displacements = state.Displacements;
  for (std::size_t node = 0; node < nodes; ++node)
  {
    state.Displacements[node] += moves[node];
    guess.Displacements[node] += moves[node] + this->Direction[node];
  }
  // Exactly where they are to be.
  for (std::size_t i = 0; i < problem.HeldNodes.size(); ++i)
  {
    const auto node = static_cast<std::size_t>(problem.HeldNodes[i]);
    state.Displacements[node] = problem.Targets[i];
    guess.Displacements[node] = problem.Targets[i];
  }
  const std::int64_t inverted = state.Sums.Inverted;
  this->Evaluate(watch, problem, guess);
  if (guess.Sums.Inverted > inverted || !std::isfinite(guess.Potential))
  {
    // The guess went too far; perhaps that the others stay is better.
    this->Evaluate(watch, problem, state);
    if (state.Potential <= guess.Potential || !std::isfinite(guess.Potential))
    {
      return;
    }
  }
  std::swap(state, guess);
}

bool CorotationalSolver::Step(Watch& watch, const Problem& problem,
  const CorotationalLimits& limits, State& state, CorotationalReport& report)
{
  constexpr int halvings = 30;
  constexpr double leastFall = 1e-4;
  // What rounding does to the sums of energies.
  constexpr double rounding = 1e-13;
  const std::size_t nodes = problem.IsFree.size();
  this->Elements.AssembleTangent(watch, state.Displacements, this->Matrix);
  this->RightHandSide.assign(nodes, glm::dvec3(0.0));
  this->SolveLinear(watch, problem, limits, state, report);
  double slope = 0.0;
  for (std::size_t node = 0; node < nodes; ++node)
  {
    slope -= glm::dot(this->RightHandSide[node], this->Direction[node]);
  }
  const double slack = rounding * (state.Sums.Energy + std::abs(state.Potential));
  const double residual = this->FindResidual(problem, state).Largest;
  double length = 1.0;
  for (int halving = 0; halving < halvings; ++halving, length *= 0.5)
  {
    this->Trial.Displacements.resize(nodes);
    for (std::size_t node = 0; node < nodes; ++node)
    {
      this->Trial.Displacements[node] = state.Displacements[node] + length * this->Direction[node];
    }
    this->Evaluate(watch, problem, this->Trial);
    if (!(this->Trial.Potential <= state.Potential + leastFall * length * slope + slack))
    {
      continue;
    }
    // Where rounding hides whether the energy falls, the forces tell.
    if (-slope * length <= slack && !(this->FindResidual(problem, this->Trial).Largest < residual))
    {
      return false;
    }
    std::swap(state, this->Trial);
    return true;
  }
  return false;
}

CorotationalReport CorotationalSolver::Solve(const CorotationalRequest& request)
{
  const CorotationalLimits limits = ChooseLimits(request);
  const Problem problem = this->MakeProblem(request);
  Watch watch(request.Progress);
  watch.Ask();
  CorotationalReport report;
  report.NumberOfFrozenPieces = problem.FrozenPieces;
  this->RightHandSide.resize(problem.IsFree.size());
  State state = this->Last;
  if (this->HasForces)
  {
    this->FindPotential(watch, problem, state);
  }
  else
  {
    this->Evaluate(watch, problem, state);
  }
  this->MoveHeldNodes(watch, problem, limits, state, report);
  for (;;)
  {
    const Residuals residuals = this->FindResidual(problem, state);
    if (!std::isfinite(residuals.Largest) || !std::isfinite(state.Potential))
    {
      throw Error("The forces in the body are no numbers any more: a load or the displacement of a "
                  "handle is too large. The displacements are those of before.");
    }
    report.Residual = residuals.Largest;
    report.RelativeResidual =
      residuals.Reference > 0.0 ? residuals.Largest / residuals.Reference : 0.0;
    report.IsConverged =
      residuals.Largest <= std::max(limits.RelativeTolerance * residuals.Reference,
                             limits.AbsoluteTolerance * this->ForceScale);
    if (report.IsConverged || report.NewtonSteps >= limits.NewtonSteps ||
      !this->Step(watch, problem, limits, state, report))
    {
      break;
    }
  }
  report.StrainEnergy = state.Sums.Energy;
  report.NumberOfInvertedTetrahedra = state.Sums.Inverted;
  std::swap(this->Last, state);
  this->HasForces = true;
  return report;
}

} // namespace deformvolume
