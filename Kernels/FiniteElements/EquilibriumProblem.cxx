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

// Replaces limits that are 0 by the defaults of the mode.
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
  return limits;
}

// Adds the weight of the tetrahedra of held pieces. It is distributed by the shape functions: each
// corner takes -1/20 of the weight of a straight tetrahedron, and each mid-side node 1/5.
void AddGravity(const glm::dvec3& gravity, const ElasticBody& body, const BodyPieces& pieces,
  const std::vector<bool>& isHeld, const GaussVolumes& volumes, std::vector<glm::dvec3>& loads)
{
  constexpr std::size_t points = QuadraticTetrahedron::NumberOfGaussPoints;
  std::array<std::array<double, QuadraticTetrahedron::NumberOfNodes>, points> shares;
  for (std::size_t point = 0; point < points; ++point)
  {
    shares[point] = QuadraticTetrahedron::GetShapeFunctions(point);
  }
  for (std::size_t t = 0; t < body.Tetrahedra.size(); ++t)
  {
    if (!isHeld[static_cast<std::size_t>(pieces.PieceOfTetrahedron[t])])
    {
      continue; // pieces that are not held bear no load, not even at shared nodes
    }
    const double density = body.GetMaterial(t).Density;
    std::size_t i = 0;
    body.ForNodes(t,
      [&](std::int32_t node)
      {
        double volume = 0.0;
        for (std::size_t point = 0; point < points; ++point)
        {
          volume += shares[point][i] * volumes[t][point];
        }
        loads[static_cast<std::size_t>(node)] += density * volume * gravity;
        ++i;
      });
  }
}

} // namespace

double LargestComponent(const glm::dvec3& vector)
{
  const glm::dvec3 sizes = glm::abs(vector);
  return std::max({ sizes.x, sizes.y, sizes.z });
}

EquilibriumProblem MakeProblem(const EquilibriumRequest& request, const ElasticBody& body,
  const BodyPieces& pieces, const GaussVolumes& volumes, const SlidingNodes& sliding)
{
  CheckLoads(body, request.Loads);
  CheckHeldNodes(body, request.Held);
  const std::size_t nodes = body.Points.size();
  std::vector<unsigned char> isConstrained(body.Fixed);
  isConstrained.resize(nodes, 0);
  std::vector<glm::dvec3> targets(request.Loads.FixedDisplacements);
  targets.resize(nodes, glm::dvec3(0.0));
  for (const HeldNode& held : request.Held)
  {
    const auto node = static_cast<std::size_t>(held.Node);
    isConstrained[node] = 1;
    targets[node] = sliding.Project(node, held.Displacement);
  }
  EquilibriumProblem problem;
  problem.Limits = ChooseLimits(request);
  problem.IsInteractive = request.Mode == EquilibriumMode::Interactive;
  problem.Supports = FindSupports(body, pieces, isConstrained);
  const std::vector<bool>& isHeld = problem.Supports.IsHeld;
  if (std::count(isHeld.begin(), isHeld.end(), true) == 0)
  {
    throw Error(
      "No constraints: nothing holds the body. Fix or hold at least three nodes that do "
      "not lie on a line, of tetrahedra that are connected by faces; or let nodes slide in "
      "planes of three directions.");
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
  problem.IsFree.assign(nodes, 0);
  problem.Loads.assign(nodes, glm::dvec3(0.0));
  if (request.Loads.Gravity != glm::dvec3(0.0))
  {
    AddGravity(request.Loads.Gravity, body, pieces, isHeld, volumes, problem.Loads);
  }
  for (std::size_t node = 0; node < nodes; ++node)
  {
    if (isConstrained[node] != 0 && pieces.PieceOfNode[node] >= 0)
    {
      problem.HeldNodes.push_back(static_cast<std::int32_t>(node));
      problem.Targets.push_back(targets[node]);
    }
    if (isOfHeldPiece[node] == 0)
    {
      continue;
    }
    problem.IsFree[node] = isConstrained[node] == 0 ? 1 : 0;
    if (!request.Loads.Forces.empty())
    {
      problem.Loads[node] += request.Loads.Forces[node];
    }
  }
  return problem;
}

Residuals FindResiduals(const EquilibriumProblem& problem, const SlidingNodes& sliding,
  const std::vector<glm::dvec3>& forces)
{
  Residuals residuals;
  const auto addReference = [&](const glm::dvec3& force)
  { residuals.Reference = std::max(residuals.Reference, LargestComponent(force)); };
  for (std::size_t node = 0; node < problem.IsFree.size(); ++node)
  {
    if (problem.IsFree[node] != 0)
    {
      const glm::dvec3 left = problem.Loads[node] - forces[node];
      const glm::dvec3 within = sliding.Project(node, left);
      residuals.Largest = std::max(residuals.Largest, LargestComponent(within));
      addReference(problem.Loads[node]);
      addReference(left - within);
    }
  }
  for (const std::int32_t node : problem.HeldNodes)
  {
    const auto i = static_cast<std::size_t>(node);
    addReference(problem.Loads[i] - forces[i]);
  }
  return residuals;
}

std::vector<glm::dvec3> FindReactions(const EquilibriumProblem& problem,
  const SlidingNodes& sliding, const std::vector<glm::dvec3>& forces)
{
  std::vector<glm::dvec3> reactions(forces.size(), glm::dvec3(0.0));
  for (std::size_t node = 0; node < forces.size(); ++node)
  {
    const glm::dvec3 left = forces[node] - problem.Loads[node];
    // What is left within the plane of a free node is a residual.
    reactions[node] = problem.IsFree[node] != 0 ? left - sliding.Project(node, left) : left;
  }
  return reactions;
}

} // namespace deformvolume
