// SPDX-License-Identifier: BSD-3-Clause
#include "ConjugateGradients.h"

#include "RowParts.h"

#include <glm/geometric.hpp>

#include <cmath>
#include <cstddef>

namespace deformvolume
{
ConjugateGradients::Result ConjugateGradients::Solve(AbortCheck& abortCheck,
  const BlockMatrix& matrix, const std::vector<unsigned char>& isFree,
  Preconditioner& preconditioner, const Limits& limits, std::vector<glm::dvec3>& solution,
  std::vector<glm::dvec3>& residual)
{
  const std::size_t rows = residual.size();
  this->Preconditioned.resize(rows);
  this->Direction.assign(rows, glm::dvec3(0.0));
  this->Product.resize(rows);
  double squared = SumOfProducts(abortCheck, residual, residual);
  double last = 0.0;
  Result result;
  int& iteration = result.Iterations;
  for (; squared > limits.SquaredResidual && iteration < limits.Iterations; ++iteration)
  {
    preconditioner.Apply(abortCheck, residual, std::sqrt(squared), this->Preconditioned);
    const double product = SumOfProducts(abortCheck, residual, this->Preconditioned);
    if (!(product > 0.0))
    {
      result.IsIndefinite = true;
      break;
    }
    const double ratio = iteration == 0 ? 0.0 : product / last;
    last = product;
    // All directions must be updated before the first product: the rows of one part use directions
    // of other parts.
    ForRows(abortCheck, rows,
      [&](std::size_t begin, std::size_t end)
      {
        for (std::size_t row = begin; row < end; ++row)
        {
          this->Direction[row] = this->Preconditioned[row] + ratio * this->Direction[row];
        }
      });
    const double curvature = SumOfParts(abortCheck, rows,
      [&](std::size_t begin, std::size_t end)
      {
        matrix.Multiply(begin, end, isFree.data(), this->Direction.data(), this->Product.data());
        double sum = 0.0;
        for (std::size_t row = begin; row < end; ++row)
        {
          sum += glm::dot(this->Direction[row], this->Product[row]);
        }
        return sum;
      });
    // There is no minimum along a direction of zero or negative curvature.
    if (!(curvature > 0.0))
    {
      result.IsIndefinite = true;
      break;
    }
    const double length = product / curvature;
    squared = SumOfParts(abortCheck, rows,
      [&](std::size_t begin, std::size_t end)
      {
        double sum = 0.0;
        for (std::size_t row = begin; row < end; ++row)
        {
          solution[row] += length * this->Direction[row];
          residual[row] -= length * this->Product[row];
          sum += glm::dot(residual[row], residual[row]);
        }
        return sum;
      });
  }
  return result;
}

} // namespace deformvolume
