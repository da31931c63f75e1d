// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTangentSolver_h
#define DeformVolumeTangentSolver_h

#include "BlockMatrix.h"
#include "ConjugateGradients.h"
#include "FiniteElements.h"
#include "Multigrid.h"
#include "Preconditioner.h"
#include "SlidingNodes.h"
#include "SolutionHistory.h"
#include "Watch.h"

#include <glm/vec3.hpp>

#include <utility>
#include <vector>

namespace deformvolume
{

/// The tangent of a body, and what solves linear systems with it: conjugate gradients, with the
/// inverses of the diagonal for few nodes, and levels for many, which are kept while they serve.
/// After an exception it has to Forget.
class TangentSolver
{
public:
  /// points: of the body, at rest. All of them have to stay.
  TangentSolver(const std::vector<glm::dvec3>& points, const FiniteElements& elements,
    const SlidingNodes& sliding)
    : Points(points)
    , Elements(elements)
    , Sliding(sliding)
  {
  }

  struct Limits
  {
    int Iterations = 500;
    /// By how much the length of the residual is made smaller, from that of the right-hand side.
    double Tolerance = 1e-2;
  };

  void SetPattern(Watch& watch, BlockPattern pattern)
  {
    this->Matrix.SetPattern(watch, std::move(pattern));
  }
  const BlockMatrix& GetMatrix() const { return this->Matrix; }

  /// Makes the matrix for displacements; isClamped: without negative eigenvalues, see FindTangent.
  void Update(Watch& watch, const std::vector<glm::dvec3>& displacements, bool isClamped);

  /// Nothing of what was solved before has to do with what follows.
  void Forget();

  /// Solves for the free nodes; the right-hand side is 0 elsewhere. repeats: it is much like one of
  /// those before that were said to repeat.
  ConjugateGradients::Result Solve(Watch& watch, const std::vector<unsigned char>& isFree,
    const std::vector<glm::dvec3>& rightHandSide, const Limits& limits, bool repeats,
    std::vector<glm::dvec3>& solution);

private:
  std::vector<glm::dvec3> FindPositions() const;
  Preconditioner& Precondition(Watch& watch, const std::vector<unsigned char>& isFree);
  // Has the levels built anew where they have become unlike the matrix.
  void JudgeLevels(int iterations, double digits);

  const std::vector<glm::dvec3>& Points;
  const FiniteElements& Elements;
  const SlidingNodes& Sliding;
  BlockMatrix Matrix;
  // The displacements that it is of.
  std::vector<glm::dvec3> Shape;
  BlockJacobi Jacobi;
  Multigrid Levels;
  // The nodes that the preconditioner is for; empty: it is to be built.
  std::vector<unsigned char> IsFree;
  // Iterations for each digit, when the levels were new.
  double CostOfLevels = 0.0;
  // Whether the preconditioner is for this matrix.
  bool IsPreconditioned = false;
  // Whether the levels were built from this matrix.
  bool AreLevelsNew = false;
  // Whether that is the levels.
  bool HasLevels = false;
  ConjugateGradients Gradients;
  std::vector<glm::dvec3> Residual;
  SolutionHistory History;
};

} // namespace deformvolume

#endif
