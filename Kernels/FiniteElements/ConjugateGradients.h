// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeConjugateGradients_h
#define DeformVolumeConjugateGradients_h

#include "BlockMatrix.h"
#include "Preconditioner.h"
#include "Watch.h"

#include <glm/vec3.hpp>

#include <vector>

namespace deformvolume
{

/// Preconditioned conjugate gradients for the free rows of a matrix. Sums do not depend on the
/// number of threads.
class ConjugateGradients
{
public:
  struct Limits
  {
    int Iterations = 500;
    /// The square of the length that the residual is to have at most.
    double SquaredResidual = 0.0;
  };

  struct Result
  {
    int Iterations = 0;
    /// The matrix, or the preconditioner, is not positive definite. The solution is what it was
    /// before that was found.
    bool IsIndefinite = false;
  };

  /// Makes a solution better whose residual is given, which is 0 where nodes are not free.
  Result Solve(Watch& watch, const BlockMatrix& matrix, const std::vector<unsigned char>& isFree,
    Preconditioner& preconditioner, const Limits& limits, std::vector<glm::dvec3>& solution,
    std::vector<glm::dvec3>& residual);

private:
  std::vector<glm::dvec3> Preconditioned;
  std::vector<glm::dvec3> Direction;
  std::vector<glm::dvec3> Product;
};

} // namespace deformvolume

#endif
