// SPDX-License-Identifier: BSD-3-Clause
#include "EquilibriumProblem.h"

#include "Error.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace deformvolume
{
namespace
{

// What is 0 in the limits of a request is chosen by the mode.
EquilibriumLimits ChooseLimits(const EquilibriumRequest& request)
{
  EquilibriumLimits limits = request.Limits;
  const auto choose = [&](auto& value, auto interactive, auto converged)
  {
    if (!(value >= 0 && std::isfinite(static_cast<double>(value))))
    {
      throw Error("A limit of the solver is less than 0 or not finite.");
    }
    if (value == 0)
    {
      value = request.Mode == EquilibriumMode::Interactive ? interactive : converged;
    }
  };
  choose(limits.NewtonSteps, 2, 200);
  choose(limits.LinearIterations, 500, 5000);
  choose(limits.LinearTolerance, 3e-3, 1e-6);
  choose(limits.RelativeTolerance, 1e-3, 1e-6);
  choose(limits.AbsoluteTolerance, 1e-6, 1e-11);
  return limits;
}

} // namespace

double LargestComponent(const glm::dvec3& vector)
{
  const glm::dvec3 sizes = glm::abs(vector);
  return std::max({ sizes.x, sizes.y, sizes.z });
}

EquilibriumProblem MakeProblem(const EquilibriumRequest& request, const ElasticBody& body,
  const BodyPieces& pieces, const std::vector<double>& volumes, std::vector<double> masses)
{
  CheckLoads(body, request.Loads);
  CheckHeldNodes(body, request.Held);
  const std::size_t nodes = body.Points.size();
  std::vector<unsigned char> isNotFree(body.Fixed);
  isNotFree.resize(nodes, 0);
  std::vector<glm::dvec3> targets(nodes, glm::dvec3(0.0));
  for (const HeldNode& held : request.Held)
  {
    isNotFree[static_cast<std::size_t>(held.Node)] = 1;
    targets[static_cast<std::size_t>(held.Node)] = held.Displacement;
  }
  EquilibriumProblem problem;
  problem.Limits = ChooseLimits(request);
  problem.IsInteractive = request.Mode == EquilibriumMode::Interactive;
  problem.Supports = FindSupports(body, pieces, isNotFree);
  const std::vector<bool>& isHeld = problem.Supports.IsHeld;
  if (std::count(isHeld.begin(), isHeld.end(), true) == 0)
  {
    throw Error("No constraints: nothing holds the body. Fix or hold at least three nodes that do "
                "not lie on a line, of tetrahedra that are connected by faces.");
  }
  std::vector<unsigned char> isOfHeldPiece(nodes, 0);
  for (std::size_t node = 0; node < nodes; ++node)
  {
    const std::int32_t piece = pieces.PieceOfNode[node];
    isOfHeldPiece[node] = piece >= 0 && isHeld[static_cast<std::size_t>(piece)] ? 1 : 0;
  }
  for (const auto& [node, piece] : pieces.SharedNodes)
  {
    isOfHeldPiece[static_cast<std::size_t>(node)] |=
      isHeld[static_cast<std::size_t>(piece)] ? 1 : 0;
  }
  // What is not held bears no load, also at the nodes that it shares.
  for (std::size_t piece = 0; piece < isHeld.size(); ++piece)
  {
    for (std::size_t i = pieces.Begins[piece]; i < pieces.Begins[piece + 1] && !isHeld[piece]; ++i)
    {
      const auto t = static_cast<std::size_t>(pieces.Tetrahedra[i]);
      for (const std::int32_t node : body.Tetrahedra[t])
      {
        masses[static_cast<std::size_t>(node)] -= 0.25 * volumes[t] * body.GetMaterial(t).Density;
      }
    }
  }
  problem.IsFree.assign(nodes, 0);
  problem.Loads.assign(nodes, glm::dvec3(0.0));
  for (std::size_t node = 0; node < nodes; ++node)
  {
    if (isNotFree[node] != 0 && pieces.PieceOfNode[node] >= 0)
    {
      problem.HeldNodes.push_back(static_cast<std::int32_t>(node));
      problem.Targets.push_back(targets[node]);
    }
    if (isOfHeldPiece[node] == 0)
    {
      continue;
    }
    problem.IsFree[node] = isNotFree[node] == 0 ? 1 : 0;
    problem.Loads[node] = request.Loads.Gravity * masses[node];
    if (!request.Loads.Forces.empty())
    {
      problem.Loads[node] += request.Loads.Forces[node];
    }
  }
  return problem;
}

Residuals FindResiduals(const EquilibriumProblem& problem, const std::vector<glm::dvec3>& forces)
{
  Residuals residuals;
  for (std::size_t node = 0; node < problem.IsFree.size(); ++node)
  {
    if (problem.IsFree[node] != 0)
    {
      residuals.Largest =
        std::max(residuals.Largest, LargestComponent(problem.Loads[node] - forces[node]));
      residuals.Reference = std::max(residuals.Reference, LargestComponent(problem.Loads[node]));
    }
  }
  for (const std::int32_t node : problem.HeldNodes)
  {
    const auto i = static_cast<std::size_t>(node);
    residuals.Reference =
      std::max(residuals.Reference, LargestComponent(problem.Loads[i] - forces[i]));
  }
  return residuals;
}

} // namespace deformvolume
