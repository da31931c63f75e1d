// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSparseBlocks_h
#define DeformVolumeSparseBlocks_h

#include "AbortCheck.h"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A sparse matrix of dense blocks of a fixed size, by rows.
template <int Rows, int Columns>
struct SparseBlocks
{
  using Block = Eigen::Matrix<double, Rows, Columns>;

  /// The first block of each row, followed by the number of blocks.
  std::vector<std::int32_t> Starts{ 0 };
  std::vector<std::int32_t> ColumnOfBlock;
  std::vector<Block> Blocks;
  std::int32_t NumberOfColumns = 0;

  std::int32_t GetNumberOfRows() const
  {
    return static_cast<std::int32_t>(this->Starts.size()) - 1;
  }
  std::size_t GetStart(std::int32_t row) const
  {
    return static_cast<std::size_t>(this->Starts[static_cast<std::size_t>(row)]);
  }
  std::size_t GetEnd(std::int32_t row) const { return this->GetStart(row + 1); }
};

template <int Rows, int Columns>
SparseBlocks<Columns, Rows> Transpose(
  AbortCheck& abortCheck, const SparseBlocks<Rows, Columns>& matrix)
{
  SparseBlocks<Columns, Rows> result;
  result.NumberOfColumns = matrix.GetNumberOfRows();
  result.Starts.assign(static_cast<std::size_t>(matrix.NumberOfColumns) + 1, 0);
  ForItems(abortCheck, matrix.ColumnOfBlock.size(),
    [&](std::size_t block)
    { ++result.Starts[static_cast<std::size_t>(matrix.ColumnOfBlock[block]) + 1]; });
  for (std::size_t i = 1; i < result.Starts.size(); ++i)
  {
    result.Starts[i] += result.Starts[i - 1];
  }
  std::vector<std::int32_t> next(result.Starts.begin(), result.Starts.end() - 1);
  result.ColumnOfBlock.resize(matrix.Blocks.size());
  result.Blocks.resize(matrix.Blocks.size());
  ForItems(abortCheck, static_cast<std::size_t>(matrix.GetNumberOfRows()),
    [&](std::size_t item)
    {
      const auto row = static_cast<std::int32_t>(item);
      for (std::size_t block = matrix.GetStart(row); block < matrix.GetEnd(row); ++block)
      {
        const auto index =
          static_cast<std::size_t>(next[static_cast<std::size_t>(matrix.ColumnOfBlock[block])]++);
        result.ColumnOfBlock[index] = row;
        result.Blocks[index] = matrix.Blocks[block].transpose();
      }
    });
  return result;
}

/// Multiplies two matrices. The columns of each row of the product are sorted.
template <int Rows, int Inner, int Columns>
SparseBlocks<Rows, Columns> Multiply(
  AbortCheck& abortCheck, const SparseBlocks<Rows, Inner>& a, const SparseBlocks<Inner, Columns>& b)
{
  // Rows of coarse levels take more time, as they have more and larger blocks.
  constexpr std::int32_t rowsOfPart = Rows > 3 ? 32 : 256;
  constexpr std::size_t partsAtOnce = 16;
  using Result = SparseBlocks<Rows, Columns>;
  const std::int32_t rows = a.GetNumberOfRows();
  std::vector<Result> parts(static_cast<std::size_t>((rows + rowsOfPart - 1) / rowsOfPart));
  ForParts(abortCheck, parts.size(), partsAtOnce,
    [&](std::size_t part)
    {
      Result& result = parts[part];
      std::vector<std::int32_t> indices(static_cast<std::size_t>(b.NumberOfColumns), -1);
      const auto first = static_cast<std::int32_t>(part) * rowsOfPart;
      std::vector<std::int32_t> columns;
      for (std::int32_t row = first; row < std::min(rows, first + rowsOfPart); ++row)
      {
        columns.clear();
        for (std::size_t i = a.GetStart(row); i < a.GetEnd(row); ++i)
        {
          for (std::size_t j = b.GetStart(a.ColumnOfBlock[i]); j < b.GetEnd(a.ColumnOfBlock[i]);
               ++j)
          {
            std::int32_t& index = indices[static_cast<std::size_t>(b.ColumnOfBlock[j])];
            if (index < 0)
            {
              index = 0;
              columns.push_back(b.ColumnOfBlock[j]);
            }
          }
        }
        std::sort(columns.begin(), columns.end());
        for (const std::int32_t column : columns)
        {
          indices[static_cast<std::size_t>(column)] =
            static_cast<std::int32_t>(result.Blocks.size());
          result.ColumnOfBlock.push_back(column);
          result.Blocks.push_back(Result::Block::Zero());
        }
        for (std::size_t i = a.GetStart(row); i < a.GetEnd(row); ++i)
        {
          for (std::size_t j = b.GetStart(a.ColumnOfBlock[i]); j < b.GetEnd(a.ColumnOfBlock[i]);
               ++j)
          {
            const auto index =
              static_cast<std::size_t>(indices[static_cast<std::size_t>(b.ColumnOfBlock[j])]);
            result.Blocks[index].noalias() += a.Blocks[i].lazyProduct(b.Blocks[j]);
          }
        }
        for (const std::int32_t column : columns)
        {
          indices[static_cast<std::size_t>(column)] = -1;
        }
        result.Starts.push_back(static_cast<std::int32_t>(result.Blocks.size()));
      }
    });
  Result result;
  result.NumberOfColumns = b.NumberOfColumns;
  std::size_t blocks = 0;
  for (const Result& part : parts)
  {
    blocks += part.Blocks.size();
  }
  result.ColumnOfBlock.reserve(blocks);
  result.Blocks.reserve(blocks);
  for (Result& part : parts)
  {
    abortCheck.Check();
    const std::int32_t offset = result.Starts.back();
    for (std::size_t i = 1; i < part.Starts.size(); ++i)
    {
      result.Starts.push_back(offset + part.Starts[i]);
    }
    result.ColumnOfBlock.insert(
      result.ColumnOfBlock.end(), part.ColumnOfBlock.begin(), part.ColumnOfBlock.end());
    result.Blocks.insert(result.Blocks.end(), part.Blocks.begin(), part.Blocks.end());
    part = Result(); // frees memory step by step: all at once would take long
  }
  return result;
}

} // namespace deformvolume

#endif
