// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTangentSolver_h
#define DeformVolumeTangentSolver_h

#include "AbortCheck.h"
#include "BlockMatrix.h"
#include "ConjugateGradients.h"
#include "FiniteElements.h"
#include "Multigrid.h"
#include "Preconditioner.h"
#include "SlidingNodes.h"
#include "SolutionHistory.h"

#include <glm/vec3.hpp>

#include <utility>
#include <vector>

namespace deformvolume
{

/// Solves linear systems with the tangent of a body by preconditioned conjugate gradients. The
/// preconditioner is block Jacobi for few free nodes, otherwise a multigrid hierarchy that is kept
/// while it converges well. Call Forget() after an exception.
class TangentSolver
{
public:
  /// points: the rest positions of the body. The object keeps references to all three arguments.
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
    /// The factor by which the residual must become shorter than the right-hand side.
    double Tolerance = 1e-2;
  };

  void SetPattern(AbortCheck& abortCheck, BlockPattern pattern)
  {
    this->Matrix.SetPattern(abortCheck, std::move(pattern));
  }
  const BlockMatrix& GetMatrix() const { return this->Matrix; }

  /// Assembles the matrix for displacements. isClamped: whether it must have no negative
  /// eigenvalues, see FindTangent.
  void Update(AbortCheck& abortCheck, const std::vector<glm::dvec3>& displacements, bool isClamped);

  /// Discards the preconditioner and all earlier solutions.
  void Forget();

  /// Solves for the free nodes. The right-hand side must be 0 at other nodes. usesHistory:
  /// whether the system resembles earlier ones that were solved with `usesHistory`; the solver then
  /// starts from their solutions.
  ConjugateGradients::Result Solve(AbortCheck& abortCheck, const std::vector<unsigned char>& isFree,
    const std::vector<glm::dvec3>& rightHandSide, const Limits& limits, bool usesHistory,
    std::vector<glm::dvec3>& solution);

private:
  std::vector<glm::dvec3> FindPositions() const;
  Preconditioner& Precondition(AbortCheck& abortCheck, const std::vector<unsigned char>& isFree);
  // Lets the hierarchy be rebuilt if it converges much slower than when it was new.
  void JudgeLevels(int iterations, double digits);

  const std::vector<glm::dvec3>& Points;
  const FiniteElements& Elements;
  const SlidingNodes& Sliding;
  BlockMatrix Matrix;
  // The displacements for which Matrix was assembled.
  std::vector<glm::dvec3> Shape;
  BlockJacobi Jacobi;
  Multigrid<float> Levels;
  // Used instead of Levels after floats have turned out not to be enough.
  Multigrid<double> LevelsOfDoubles;
  bool AreDoubles = false;
  // The free nodes of the preconditioner; empty: it must be built.
  std::vector<unsigned char> IsFree;
  // Iterations per decimal digit when the hierarchy was new.
  double CostOfLevels = 0.0;
  // Whether the current matrix has no negative eigenvalues.
  bool IsClamped = false;
  // Whether the preconditioner was updated for the current matrix.
  bool IsPreconditioned = false;
  // Whether the hierarchy was built from the current matrix.
  bool AreLevelsNew = false;
  // Whether the preconditioner is the multigrid hierarchy.
  bool HasLevels = false;
  ConjugateGradients Gradients;
  std::vector<glm::dvec3> Residual;
  SolutionHistory History;
};

} // namespace deformvolume

#endif
