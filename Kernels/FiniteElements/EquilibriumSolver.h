// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeEquilibriumSolver_h
#define DeformVolumeEquilibriumSolver_h

#include "AbortCheck.h"
#include "EquilibriumProblem.h"
#include "EquilibriumTypes.h"
#include "FiniteElements.h"
#include "SlidingNodes.h"
#include "TangentSolver.h"

#include <glm/vec3.hpp>

#include <vector>

namespace deformvolume
{

/// Finds the equilibrium of a body by Newton's method with backtracking line search.
class EquilibriumSolver
{
public:
  EquilibriumSolver(AbortCheck& abortCheck, const ElasticBody& body);

  void SetMaterials(const std::vector<ElasticMaterial>& materials);
  void SetMaterialModel(MaterialModel model);
  EquilibriumReport Solve(const EquilibriumRequest& request);

  const ElasticBody& GetBody() const { return this->Body; }
  const std::vector<glm::dvec3>& GetDisplacements() const { return this->Last.Displacements; }
  /// See FiniteElementModel::GetStart().
  std::vector<glm::dvec3> GetStart() const;
  void SetDisplacements(const std::vector<glm::dvec3>& displacements);
  std::vector<glm::dvec3> GetForces() const;
  std::vector<ElementResults> GetElementResults() const;
  const std::vector<glm::dvec3>& GetReactions() const { return this->Reactions; }

private:
  // Displacements, and the forces and energies that follow from them.
  struct State
  {
    std::vector<glm::dvec3> Displacements;
    std::vector<glm::dvec3> Forces;
    FiniteElements::Sums Sums;
    double Potential = 0.0;
  };
  void UpdateScale(AbortCheck& abortCheck);
  // Returns an upper limit of the rounding errors of forces in the softest material, in N.
  double FindRounding(const std::vector<glm::dvec3>& displacements) const;
  // Whether each unbalanced force is at most `wanted`, or of the size of the rounding errors of the
  // stiffest tetrahedron of its node.
  bool IsWithinRounding(const EquilibriumProblem& problem, const State& state, double wanted) const;
  // Discards forces, tangent, preconditioner and solutions of earlier calls. Keeps the
  // displacements.
  void Forget();
  void UseHeldPieces(const EquilibriumProblem& problem);
  // Moves pieces that are not held with their supporting nodes. Free pieces, which have no such
  // nodes, get their shape at rest.
  void MoveFrozenPieces(
    const EquilibriumProblem& problem, const std::vector<bool>& isFree, State& state) const;
  EquilibriumReport FindEquilibrium(
    AbortCheck& abortCheck, const EquilibriumRequest& request, const EquilibriumProblem& problem);
  void Evaluate(AbortCheck& abortCheck, const EquilibriumProblem& problem, State& state) const;
  void FindPotential(AbortCheck& abortCheck, const EquilibriumProblem& problem, State& state) const;
  // Computes the tangent of a state unless the existing one can be reused. The tangent is clamped
  // (see FindTangent) for some steps after the exact one was indefinite, or its direction did not
  // reduce the energy.
  void UpdateTangent(AbortCheck& abortCheck, const EquilibriumProblem& problem, const State& state);
  // Moves the held nodes to their targets, and the other nodes by the linear response. Returns
  // whether any held node moved.
  bool MoveHeldNodes(AbortCheck& abortCheck, const EquilibriumProblem& problem, State& state,
    EquilibriumReport& report);
  // Moves the chosen free nodes to the mean of their neighbors.
  void MoveToNeighbors(AbortCheck& abortCheck, const EquilibriumProblem& problem,
    const std::vector<unsigned char>& isChosen, const State& state, State& moved) const;
  // Moves the free nodes of inverted tetrahedra to the mean of their neighbors, as long as this
  // reduces the energy. Newton's method alone would take many steps: it turns each inverted
  // tetrahedron independently of its neighbors.
  void Untangle(AbortCheck& abortCheck, const EquilibriumProblem& problem, State& state);
  // The tolerance for a linear system if the residual is to be reduced by the factor `wanted`.
  static double ChooseTolerance(const EquilibriumProblem& problem, double wanted);
  // Solves for the right-hand side plus the unbalanced forces. Returns false if the tangent is not
  // positive definite.
  bool SolveLinear(AbortCheck& abortCheck, const EquilibriumProblem& problem, const State& state,
    double tolerance, EquilibriumReport& report);
  // Switches to clamped tangents for some steps. Returns false if they are already in use.
  bool Clamp();
  // Line search along the direction. Returns false if no step length reduces the energy.
  bool Search(AbortCheck& abortCheck, const EquilibriumProblem& problem, State& state);
  // Newton's method. Returns whether it gave up because the body is tangled.
  bool Iterate(AbortCheck& abortCheck, const EquilibriumProblem& problem, double tolerance,
    State& state, EquilibriumReport& report);
  // A few tetrahedra can stay inverted in an equilibrium of their own. Looks for an equilibrium of
  // less energy from a state in which their nodes have moved to the mean of their neighbors.
  void RemoveDents(AbortCheck& abortCheck, const EquilibriumProblem& problem, double tolerance,
    State& state, EquilibriumReport& report);
  // One Newton step. Returns false if no step reduces the energy.
  bool Step(AbortCheck& abortCheck, const EquilibriumProblem& problem, double tolerance,
    State& state, EquilibriumReport& report);

  ElasticBody Body;
  BodyPieces Pieces;
  // The pieces whose tetrahedra Elements contains: those that are held.
  std::vector<bool> ActivePieces;
  SlidingNodes Sliding;
  GaussVolumes Volumes;
  double LeastModulus = 0.0; // of all materials, in Pa
  double MeanEdge = 0.0;     // the mean distance of neighboring nodes, in m
  FiniteElements Elements;
  TangentSolver Tangent;
  // HasTangent: a tangent exists that may be reused. IsTangentOld: it is from an earlier call.
  bool HasTangent = false;
  bool IsTangentOld = false;
  // The number of further steps with clamped tangents.
  int ClampedSteps = 0;
  std::vector<glm::dvec3> RightHandSide;
  std::vector<glm::dvec3> Direction;
  State Trial;
  // The state after the last call. Its forces are still valid if HasForces.
  State Last;
  bool HasForces = false;
  // The reactions of the last call.
  std::vector<glm::dvec3> Reactions;
  // The free pieces of the last call, which have their shape at rest.
  std::vector<bool> RigidPieces;
  // The last call found an equilibrium in the mode Converged: RemoveDents has nothing new to find
  // until the body moves.
  bool HasLookedForDents = false;
  // The inverted tetrahedra that RemoveDents has last failed to remove, one byte per tetrahedron.
  std::vector<unsigned char> LastingDents;
  // The last call gave up with inverted tetrahedra. The next one starts at rest.
  bool HasStalled = false;
};

} // namespace deformvolume

#endif
