// SPDX-License-Identifier: BSD-3-Clause
// Loops over rows of vectors in parallel, and sums that do not depend on the number of threads.
#ifndef DeformVolumeRowParts_h
#define DeformVolumeRowParts_h

#include "AbortCheck.h"
#include "BlockMatrix.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace deformvolume
{

/// Calls body(begin, end) for ranges of rows in parallel.
template <typename Body>
void ForRows(AbortCheck& abortCheck, std::size_t rows, Body&& body)
{
  constexpr std::size_t size = BlockMatrix::RowsOfPart;
  ForParts(abortCheck, (rows + size - 1) / size, BlockMatrix::PartsAtOnce,
    [&](std::size_t part) { body(part * size, std::min(rows, (part + 1) * size)); });
}

/// Returns the sum of the results of body(begin, end) for ranges of rows, added in the order of the
/// rows.
template <typename Body>
double SumOfParts(AbortCheck& abortCheck, std::size_t rows, Body&& body)
{
  constexpr std::size_t size = BlockMatrix::RowsOfPart;
  std::vector<double> sums((rows + size - 1) / size);
  ForRows(abortCheck, rows,
    [&](std::size_t begin, std::size_t end) { sums[begin / size] = body(begin, end); });
  double total = 0.0;
  for (const double sum : sums)
  {
    total += sum;
  }
  return total;
}

inline double SumOfProducts(
  AbortCheck& abortCheck, const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b)
{
  return SumOfParts(abortCheck, a.size(),
    [&](std::size_t begin, std::size_t end)
    {
      double sum = 0.0;
      for (std::size_t row = begin; row < end; ++row)
      {
        sum += glm::dot(a[row], b[row]);
      }
      return sum;
    });
}

} // namespace deformvolume

#endif
