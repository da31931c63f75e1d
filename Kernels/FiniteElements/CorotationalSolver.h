// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCorotationalSolver_h
#define DeformVolumeCorotationalSolver_h

#include "ConjugateGradients.h"
#include "CorotationalElements.h"
#include "CorotationalTypes.h"
#include "Multigrid.h"
#include "Watch.h"

#include <glm/vec3.hpp>

#include <vector>

namespace deformvolume
{

/// Newton's method for a body, with steps that become shorter until the energy falls enough.
class CorotationalSolver
{
public:
  explicit CorotationalSolver(const ElasticBody& body);

  void SetMaterials(const std::vector<ElasticMaterial>& materials);
  CorotationalReport Solve(const CorotationalRequest& request);

  const ElasticBody& GetBody() const { return this->Body; }
  const std::vector<glm::dvec3>& GetDisplacements() const { return this->Last.Displacements; }
  void SetDisplacements(const std::vector<glm::dvec3>& displacements);
  std::vector<glm::dvec3> GetForces() const;
  std::vector<ElementResults> GetElementResults() const;

private:
  // What does not change during a call of Solve.
  struct Problem
  {
    std::vector<unsigned char> IsFree;
    // Nodes that a piece holds which is not frozen, but that are not free.
    std::vector<std::int32_t> HeldNodes;
    // Where these are to be.
    std::vector<glm::dvec3> Targets;
    std::vector<glm::dvec3> Loads;
    std::int32_t FrozenPieces = 0;
  };
  // Displacements, and what they cause.
  struct State
  {
    std::vector<glm::dvec3> Displacements;
    std::vector<glm::dvec3> Forces;
    CorotationalElements::Sums Sums;
    double Potential = 0.0;
  };
  struct Residuals
  {
    double Largest = 0.0;
    double Reference = 0.0;
  };

  void UpdateScale();
  Problem MakeProblem(const CorotationalRequest& request) const;
  void Evaluate(Watch& watch, const Problem& problem, State& state) const;
  void FindPotential(Watch& watch, const Problem& problem, State& state) const;
  Residuals FindResidual(const Problem& problem, const State& state) const;
  // Moves the held nodes to their targets, and the others as the tangent says.
  void MoveHeldNodes(Watch& watch, const Problem& problem, const CorotationalLimits& limits,
    State& state, CorotationalReport& report);
  Preconditioner& Precondition(Watch& watch, const Problem& problem, const State& state);
  // Has the levels built anew where they have become unlike the matrix.
  void JudgeLevels(int iterations, const CorotationalLimits& limits);
  void SolveLinear(Watch& watch, const Problem& problem, const CorotationalLimits& limits,
    const State& state, CorotationalReport& report);
  // False where no step makes the energy less.
  bool Step(Watch& watch, const Problem& problem, const CorotationalLimits& limits, State& state,
    CorotationalReport& report);

  ElasticBody Body;
  BodyPieces Pieces;
  std::vector<double> Masses;
  // E h^2, in N.
  double ForceScale = 0.0;
  CorotationalElements Elements;
  BlockMatrix Matrix;
  BlockJacobi Jacobi;
  Multigrid Levels;
  // What these are for; empty: they are to be built.
  std::vector<unsigned char> IsFreeInLevels;
  // Iterations for each digit, when they were new.
  double CostOfLevels = 0.0;
  ConjugateGradients Gradients;
  std::vector<glm::dvec3> RightHandSide;
  std::vector<glm::dvec3> Direction;
  State Trial;
  // Where the last call has left the body. Its forces need not be found again, unless something has
  // been changed since.
  State Last;
  bool HasForces = false;
};

} // namespace deformvolume

#endif
