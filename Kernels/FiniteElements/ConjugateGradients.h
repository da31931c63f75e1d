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
    /// By how much the length of the residual is made smaller.
    double Tolerance = 1e-2;
  };

  /// The right-hand side is 0 where nodes are not free. Returns the number of iterations.
  int Solve(Watch& watch, const BlockMatrix& matrix, const std::vector<unsigned char>& isFree,
    Preconditioner& preconditioner, const std::vector<glm::dvec3>& rightHandSide,
    const Limits& limits, std::vector<glm::dvec3>& solution);

private:
  std::vector<glm::dvec3> Residual;
  std::vector<glm::dvec3> Preconditioned;
  std::vector<glm::dvec3> Direction;
  std::vector<glm::dvec3> Product;
};

/// The sum of what body(begin, end) returns for parts of the rows, which are added in their order.
template <typename Body>
double SumOfParts(Watch& watch, std::size_t rows, Body&& body)
{
  constexpr std::size_t size = BlockMatrix::RowsOfPart;
  std::vector<double> sums((rows + size - 1) / size);
  ForParts(watch, sums.size(), BlockMatrix::PartsAtOnce,
    [&](std::size_t part) { sums[part] = body(part * size, std::min(rows, (part + 1) * size)); });
  double total = 0.0;
  for (const double sum : sums)
  {
    total += sum;
  }
  return total;
}

} // namespace deformvolume

#endif
