// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeEquilibriumSolver_h
#define DeformVolumeEquilibriumSolver_h

#include "EquilibriumProblem.h"
#include "EquilibriumTypes.h"
#include "FiniteElements.h"
#include "SlidingNodes.h"
#include "TangentSolver.h"
#include "Watch.h"

#include <glm/vec3.hpp>

#include <vector>

namespace deformvolume
{

/// Newton's method for a body, with steps that become shorter until the energy falls enough.
class EquilibriumSolver
{
public:
  EquilibriumSolver(Watch& watch, const ElasticBody& body);

  void SetMaterials(const std::vector<ElasticMaterial>& materials);
  void SetMaterialModel(MaterialModel model);
  EquilibriumReport Solve(const EquilibriumRequest& request);

  const ElasticBody& GetBody() const { return this->Body; }
  const std::vector<glm::dvec3>& GetDisplacements() const { return this->Last.Displacements; }
  void SetDisplacements(const std::vector<glm::dvec3>& displacements);
  std::vector<glm::dvec3> GetForces() const;
  std::vector<ElementResults> GetElementResults() const;

private:
  // Displacements, and what they cause.
  struct State
  {
    std::vector<glm::dvec3> Displacements;
    std::vector<glm::dvec3> Forces;
    FiniteElements::Sums Sums;
    double Potential = 0.0;
  };
  void UpdateScale(Watch& watch);
  // What the last calls have found serves no longer, but for the displacements.
  void Forget();
  void UseHeldPieces(const EquilibriumProblem& problem);
  // Pieces that are not held go with what moves their nodes of support.
  void MoveFollowers(const EquilibriumProblem& problem, State& state) const;
  EquilibriumReport FindEquilibrium(
    Watch& watch, const EquilibriumRequest& request, const EquilibriumProblem& problem);
  void Evaluate(Watch& watch, const EquilibriumProblem& problem, State& state) const;
  void FindPotential(Watch& watch, const EquilibriumProblem& problem, State& state) const;
  // Finds the tangent of a state, unless the one that there is may serve. It is the true one, and
  // clamped where that one has turned out to be negative or not to lead to less energy.
  void UpdateTangent(Watch& watch, const EquilibriumProblem& problem, const State& state);
  // Moves the held nodes to their targets, and the others as the tangent says. Returns whether they
  // were elsewhere.
  bool MoveHeldNodes(
    Watch& watch, const EquilibriumProblem& problem, State& state, EquilibriumReport& report);
  // Moves the free nodes of tetrahedra that are inside out to the mean of their neighbours, as long
  // as the energy falls. Newton's method takes many steps to turn such tetrahedra: each in its own
  // way, which is rarely that of its neighbours.
  void Untangle(Watch& watch, const EquilibriumProblem& problem, State& state);
  // How well a linear system is to be solved where the residual is to become so much smaller.
  static double ChooseTolerance(const EquilibriumProblem& problem, double wanted);
  // Solves for what the right-hand side and the forces that are left say. False where the tangent
  // is not positive.
  bool SolveLinear(Watch& watch, const EquilibriumProblem& problem, const State& state,
    double tolerance, EquilibriumReport& report);
  // Takes clamped tangents from now on, for some steps. False where it does so already.
  bool Clamp();
  // Goes along the direction until the energy is less. False where it never is.
  bool Search(Watch& watch, const EquilibriumProblem& problem, State& state);
  // False where no step makes the energy less.
  bool Step(Watch& watch, const EquilibriumProblem& problem, double tolerance, State& state,
    EquilibriumReport& report);

  ElasticBody Body;
  BodyPieces Pieces;
  // Which of these the elements are of: those that are held.
  std::vector<bool> ActivePieces;
  SlidingNodes Sliding;
  GaussVolumes Volumes;
  // E h^2, in N.
  double ForceScale = 0.0;
  FiniteElements Elements;
  TangentSolver Tangent;
  // Whether there is a tangent that may serve, and whether it is that of another call.
  bool HasTangent = false;
  bool IsTangentOld = false;
  // For how many steps tangents are still to be clamped.
  int ClampedSteps = 0;
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
