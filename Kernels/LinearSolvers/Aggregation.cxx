// SPDX-License-Identifier: BSD-3-Clause
#include "Aggregation.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

namespace deformvolume
{

Aggregates MakeAggregates(AbortCheck& abortCheck, const std::vector<std::int32_t>& starts,
  const std::vector<std::int32_t>& columns)
{
  const std::size_t rows = starts.size() - 1;
  Aggregates result;
  std::vector<std::int32_t>& aggregateOfRow = result.AggregateOfRow;
  aggregateOfRow.assign(rows, -1);
  const auto forNeighbors = [&](std::size_t row, auto&& visit)
  {
    for (auto i = static_cast<std::size_t>(starts[row]);
         i < static_cast<std::size_t>(starts[row + 1]); ++i)
    {
      visit(static_cast<std::size_t>(columns[i]));
    }
  };
  // A row whose neighbors are all without an aggregate starts one with them. Rows with many
  // neighbors come first: large aggregates give a small coarse level.
  std::vector<std::size_t> order(rows);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
    [&](std::size_t a, std::size_t b)
    { return starts[a + 1] - starts[a] > starts[b + 1] - starts[b]; });
  ForItems(abortCheck, rows,
    [&](std::size_t item)
    {
      const std::size_t row = order[item];
      bool isAlone = true;
      forNeighbors(row, [&](std::size_t other) { isAlone = isAlone && aggregateOfRow[other] < 0; });
      if (isAlone)
      {
        const std::int32_t aggregate = result.NumberOfAggregates++;
        aggregateOfRow[row] = aggregate;
        forNeighbors(row, [&](std::size_t other) { aggregateOfRow[other] = aggregate; });
      }
    });
  // Each remaining row joins the smallest aggregate next to it.
  std::vector<std::int32_t> sizes(static_cast<std::size_t>(result.NumberOfAggregates), 0);
  for (const std::int32_t aggregate : aggregateOfRow)
  {
    if (aggregate >= 0)
    {
      ++sizes[static_cast<std::size_t>(aggregate)];
    }
  }
  const std::vector<std::int32_t> first = aggregateOfRow;
  ForItems(abortCheck, rows,
    [&](std::size_t row)
    {
      if (first[row] >= 0)
      {
        return;
      }
      std::int32_t best = -1;
      forNeighbors(row,
        [&](std::size_t other)
        {
          const std::int32_t aggregate = first[other];
          if (aggregate >= 0 &&
            (best < 0 ||
              sizes[static_cast<std::size_t>(aggregate)] < sizes[static_cast<std::size_t>(best)]))
          {
            best = aggregate;
          }
        });
      // Such an aggregate exists: otherwise the row would have started one itself.
      aggregateOfRow[row] = best;
      ++sizes[static_cast<std::size_t>(best)];
    });
  return result;
}

template <int Size>
std::vector<Eigen::Matrix<double, Size, Size>> InvertDiagonal(
  AbortCheck& abortCheck, const SparseBlocks<Size, Size>& matrix)
{
  using Block = Eigen::Matrix<double, Size, Size>;
  std::vector<Block> inverses(static_cast<std::size_t>(matrix.GetNumberOfRows()));
  ForItemsInParallel(abortCheck, inverses.size(),
    [&](std::size_t item)
    {
      const auto row = static_cast<std::int32_t>(item);
      for (std::size_t block = matrix.GetStart(row); block < matrix.GetEnd(row); ++block)
      {
        if (matrix.ColumnOfBlock[block] == row)
        {
          // A block that is not positive definite, for example through rounding, is replaced by its
          // norm.
          const Block& own = matrix.Blocks[block];
          const Eigen::LLT<Block> factor(own);
          const Block identity = Block::Identity();
          inverses[item] = factor.info() == Eigen::Success
            ? Block(factor.solve(identity))
            : Block(identity / std::max(own.norm(), std::numeric_limits<double>::min()));
        }
      }
    });
  return inverses;
}

template <int Size>
double FindLargestEigenvalue(AbortCheck& abortCheck, const SparseBlocks<Size, Size>& matrix,
  const std::vector<Eigen::Matrix<double, Size, Size>>& inverses)
{
  constexpr int iterations = 12;
  // The power method underestimates the eigenvalue after so few iterations.
  constexpr double margin = 1.1;
  using Vector = Eigen::Matrix<double, Size, 1>;
  const std::int32_t rows = matrix.GetNumberOfRows();
  std::vector<Vector> vector(static_cast<std::size_t>(rows));
  std::vector<Vector> product(vector.size());
  // Start with a pseudorandom vector: it has a component along each eigenvector.
  unsigned int random = 1;
  for (Vector& value : vector)
  {
    for (int i = 0; i < Size; ++i)
    {
      random = random * 1664525u + 1013904223u;
      value[i] = static_cast<double>(random >> 8) / (1 << 24) - 0.5;
    }
  }
  double length = 1.0;
  for (int iteration = 0; iteration < iterations; ++iteration)
  {
    ForParts(abortCheck, (vector.size() + 511) / 512, 64,
      [&](std::size_t part)
      {
        for (std::size_t row = part * 512; row < std::min(vector.size(), (part + 1) * 512); ++row)
        {
          Vector sum = Vector::Zero();
          const auto r = static_cast<std::int32_t>(row);
          for (std::size_t block = matrix.GetStart(r); block < matrix.GetEnd(r); ++block)
          {
            sum +=
              matrix.Blocks[block] * vector[static_cast<std::size_t>(matrix.ColumnOfBlock[block])];
          }
          product[row] = inverses[row] * sum;
        }
      });
    double squared = 0.0;
    for (const Vector& value : product)
    {
      squared += value.squaredNorm();
    }
    double before = 0.0;
    for (const Vector& value : vector)
    {
      before += value.squaredNorm();
    }
    length = std::sqrt(squared / before);
    for (std::size_t row = 0; row < vector.size(); ++row)
    {
      vector[row] = product[row] / std::sqrt(squared);
    }
  }
  return margin * length;
}

namespace
{

// Makes the near null space orthonormal within each aggregate (QR decomposition). Q becomes the
// tentative prolongation, R the near null space of the coarse level. An aggregate of few rows does
// not have all modes; its missing modes become 0.
template <int Size>
void Orthogonalize(AbortCheck& abortCheck, const Aggregates& aggregates,
  const NearNullSpace<Size>& modes, SparseBlocks<Size, RigidModes>& prolongation,
  NearNullSpace<RigidModes>& coarse)
{
  constexpr double least = 1e-7;
  prolongation.NumberOfColumns = aggregates.NumberOfAggregates;
  prolongation.ColumnOfBlock = aggregates.AggregateOfRow;
  prolongation.Blocks = modes;
  prolongation.Starts.resize(modes.size() + 1);
  for (std::size_t row = 0; row <= modes.size(); ++row)
  {
    prolongation.Starts[row] = static_cast<std::int32_t>(row);
  }
  std::vector<std::vector<std::int32_t>> rowsOfAggregate(
    static_cast<std::size_t>(aggregates.NumberOfAggregates));
  for (std::size_t row = 0; row < modes.size(); ++row)
  {
    rowsOfAggregate[static_cast<std::size_t>(aggregates.AggregateOfRow[row])].push_back(
      static_cast<std::int32_t>(row));
  }
  coarse.assign(rowsOfAggregate.size(), Eigen::Matrix<double, RigidModes, RigidModes>::Zero());
  for (std::size_t aggregate = 0; aggregate < rowsOfAggregate.size(); ++aggregate)
  {
    abortCheck.Check();
    const auto dot = [&](int i, int j)
    {
      double sum = 0.0;
      for (const std::int32_t row : rowsOfAggregate[aggregate])
      {
        const auto& block = prolongation.Blocks[static_cast<std::size_t>(row)];
        sum += block.col(i).dot(block.col(j));
      }
      return sum;
    };
    for (int j = 0; j < RigidModes; ++j)
    {
      const double before = std::sqrt(dot(j, j));
      // Orthogonalize twice, to remove the rounding errors of the first pass.
      for (int i = 0; i < 2 * j; ++i)
      {
        const double part = dot(i % j, j);
        coarse[aggregate](i % j, j) += part;
        for (const std::int32_t row : rowsOfAggregate[aggregate])
        {
          auto& block = prolongation.Blocks[static_cast<std::size_t>(row)];
          block.col(j) -= part * block.col(i % j);
        }
      }
      const double length = std::sqrt(dot(j, j));
      const bool isThere = length > least * before;
      coarse[aggregate](j, j) = isThere ? length : 0.0;
      for (const std::int32_t row : rowsOfAggregate[aggregate])
      {
        auto column = prolongation.Blocks[static_cast<std::size_t>(row)].col(j);
        column *= isThere ? 1.0 / length : 0.0;
      }
    }
  }
}

} // namespace

template <int Size>
Coarsening<Size> Coarsen(AbortCheck& abortCheck, const SparseBlocks<Size, Size>& matrix,
  const std::vector<Eigen::Matrix<double, Size, Size>>& inverses, double largestEigenvalue,
  const NearNullSpace<Size>& modes)
{
  Coarsening<Size> result;
  const Aggregates aggregates = MakeAggregates(abortCheck, matrix.Starts, matrix.ColumnOfBlock);
  SparseBlocks<Size, RigidModes> tentative;
  Orthogonalize(abortCheck, aggregates, modes, tentative, result.Modes);
  const double damping = 4.0 / (3.0 * largestEigenvalue);
  result.Prolongation = Multiply(abortCheck, matrix, tentative);
  ForItemsInParallel(abortCheck, tentative.Blocks.size(),
    [&](std::size_t r)
    {
      const auto row = static_cast<std::int32_t>(r);
      for (std::size_t block = result.Prolongation.GetStart(row);
           block < result.Prolongation.GetEnd(row); ++block)
      {
        auto& value = result.Prolongation.Blocks[block];
        value = -damping * inverses[r] * value;
        if (result.Prolongation.ColumnOfBlock[block] == aggregates.AggregateOfRow[r])
        {
          value += tentative.Blocks[r];
        }
      }
    });
  auto product = Multiply(abortCheck, matrix, result.Prolongation);
  const auto restriction = Transpose(abortCheck, result.Prolongation);
  result.Matrix = Multiply(abortCheck, restriction, product);
  product = {};
  // Unknowns of modes that were set to 0 would make the matrix singular.
  ForItems(abortCheck, result.Modes.size(),
    [&](std::size_t item)
    {
      const auto row = static_cast<std::int32_t>(item);
      for (std::size_t block = result.Matrix.GetStart(row); block < result.Matrix.GetEnd(row);
           ++block)
      {
        for (int i = 0; i < RigidModes && result.Matrix.ColumnOfBlock[block] == row; ++i)
        {
          if (result.Modes[item](i, i) == 0.0)
          {
            result.Matrix.Blocks[block](i, i) = 1.0;
          }
        }
      }
    });
  return result;
}

template std::vector<Eigen::Matrix<double, 3, 3>> InvertDiagonal<3>(
  AbortCheck&, const SparseBlocks<3, 3>&);
template std::vector<Eigen::Matrix<double, 6, 6>> InvertDiagonal<6>(
  AbortCheck&, const SparseBlocks<6, 6>&);
template double FindLargestEigenvalue<3>(
  AbortCheck&, const SparseBlocks<3, 3>&, const std::vector<Eigen::Matrix<double, 3, 3>>&);
template double FindLargestEigenvalue<6>(
  AbortCheck&, const SparseBlocks<6, 6>&, const std::vector<Eigen::Matrix<double, 6, 6>>&);
template Coarsening<3> Coarsen<3>(AbortCheck&, const SparseBlocks<3, 3>&,
  const std::vector<Eigen::Matrix<double, 3, 3>>&, double, const NearNullSpace<3>&);
template Coarsening<6> Coarsen<6>(AbortCheck&, const SparseBlocks<6, 6>&,
  const std::vector<Eigen::Matrix<double, 6, 6>>&, double, const NearNullSpace<6>&);

} // namespace deformvolume
