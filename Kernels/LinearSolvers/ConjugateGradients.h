// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeConjugateGradients_h
#define DeformVolumeConjugateGradients_h

#include "AbortCheck.h"
#include "BlockMatrix.h"
#include "Preconditioner.h"

#include <glm/vec3.hpp>

#include <vector>

namespace deformvolume
{

/// Preconditioned conjugate gradients for the free rows of a matrix. Results do not depend on the
/// number of threads.
class ConjugateGradients
{
public:
  struct Limits
  {
    int Iterations = 500;
    /// The iteration ends when the squared length of the residual is at most this value.
    double SquaredResidual = 0.0;
  };

  struct Result
  {
    int Iterations = 0;
    /// Whether the matrix or the preconditioner turned out not to be positive definite. The
    /// solution is then that of the previous iteration.
    bool IsIndefinite = false;
  };

  /// Improves a solution. residual: of the given solution, 0 at nodes that are not free; updated.
  Result Solve(AbortCheck& abortCheck, const BlockMatrix& matrix,
    const std::vector<unsigned char>& isFree, Preconditioner& preconditioner, const Limits& limits,
    std::vector<glm::dvec3>& solution, std::vector<glm::dvec3>& residual);

private:
  std::vector<glm::dvec3> Preconditioned;
  std::vector<glm::dvec3> Direction;
  std::vector<glm::dvec3> Product;
};

} // namespace deformvolume

#endif
