// SPDX-License-Identifier: BSD-3-Clause
#include "BlockMatrix.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

namespace deformvolume
{
namespace
{

struct ProductArguments
{
  const std::int32_t* Rows;
  const std::int32_t* Columns;
  const double* Values;
  const unsigned char* IsFree;
  const double* Vector;
  double* Product;
};

DEFORMVOLUME_ALWAYS_INLINE Lanes LoadColumn(const double* column)
{
  // This reads one value beyond the column. The fourth lane is ignored.
  Lanes lanes;
  std::memcpy(&lanes, column, sizeof(lanes));
  return lanes;
}

DEFORMVOLUME_ALWAYS_INLINE void MultiplyRows(
  const ProductArguments& arguments, std::size_t begin, std::size_t end)
{
  for (std::size_t row = begin; row < end; ++row)
  {
    double* const product = arguments.Product + 3 * row;
    Lanes sum = MakeLanes(0.0);
    if (arguments.IsFree[row] != 0)
    {
      const std::int32_t last = arguments.Rows[row + 1];
      for (std::int32_t block = arguments.Rows[row]; block < last; ++block)
      {
        const double* const vector =
          arguments.Vector + 3 * static_cast<std::size_t>(arguments.Columns[block]);
        const double* const values =
          arguments.Values + BlockMatrix::BlockSize * static_cast<std::size_t>(block);
        sum = sum + LoadColumn(values) * vector[0] + LoadColumn(values + 3) * vector[1] +
          LoadColumn(values + 6) * vector[2];
      }
    }
    product[0] = sum[0];
    product[1] = sum[1];
    product[2] = sum[2];
  }
}

} // namespace

BlockPattern MakeNodePattern(AbortCheck& abortCheck, const ElasticBody& body)
{
  const std::size_t nodes = body.Points.size();
  std::vector<std::size_t> starts(nodes + 1, 0);
  ForItems(abortCheck, body.Tetrahedra.size(),
    [&](std::size_t t) {
      body.ForNodes(t, [&](std::int32_t node) { ++starts[static_cast<std::size_t>(node) + 1]; });
    });
  for (std::size_t node = 0; node < nodes; ++node)
  {
    starts[node + 1] += starts[node];
  }
  std::vector<std::size_t> next(starts.begin(), starts.end() - 1);
  std::vector<std::int32_t> tetrahedra(starts.back());
  ForItems(abortCheck, body.Tetrahedra.size(),
    [&](std::size_t t)
    {
      body.ForNodes(t,
        [&](std::int32_t node)
        { tetrahedra[next[static_cast<std::size_t>(node)]++] = static_cast<std::int32_t>(t); });
    });

  BlockPattern pattern;
  pattern.Rows.assign(nodes + 1, 0);
  pattern.Diagonal.resize(nodes);
  std::vector<std::int32_t> columns;
  ForItems(abortCheck, nodes,
    [&](std::size_t node)
    {
      columns.assign(1, static_cast<std::int32_t>(node));
      for (std::size_t i = starts[node]; i < starts[node + 1]; ++i)
      {
        body.ForNodes(static_cast<std::size_t>(tetrahedra[i]),
          [&](std::int32_t other) { columns.push_back(other); });
      }
      std::sort(columns.begin(), columns.end());
      columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
      const auto own =
        std::lower_bound(columns.begin(), columns.end(), static_cast<std::int32_t>(node));
      pattern.Diagonal[node] =
        pattern.Rows[node] + static_cast<std::int32_t>(own - columns.begin());
      pattern.Columns.insert(pattern.Columns.end(), columns.begin(), columns.end());
      if (pattern.Columns.size() > std::numeric_limits<std::int32_t>::max())
      {
        throw Error("The mesh is too large for finite elements: its stiffness matrix has more than "
                    "2,147,483,647 blocks. Use a coarser mesh.");
      }
      pattern.Rows[node + 1] = static_cast<std::int32_t>(pattern.Columns.size());
    });

  // For a fixed column, rows are visited in ascending order. The transposed blocks have the same
  // order.
  pattern.Mirrored.resize(pattern.Columns.size());
  std::vector<std::int32_t> nextOfRow(pattern.Rows.begin(), pattern.Rows.end() - 1);
  ForItems(abortCheck, pattern.Columns.size(),
    [&](std::size_t block)
    { pattern.Mirrored[block] = nextOfRow[static_cast<std::size_t>(pattern.Columns[block])]++; });
  return pattern;
}

std::int32_t BlockPattern::Find(std::int32_t row, std::int32_t column) const
{
  const auto begin = this->Columns.begin() + this->Rows[static_cast<std::size_t>(row)];
  const auto end = this->Columns.begin() + this->Rows[static_cast<std::size_t>(row) + 1];
  return static_cast<std::int32_t>(std::lower_bound(begin, end, column) - this->Columns.begin());
}

std::vector<BatchPositions> FindPositions(
  AbortCheck& abortCheck, const ElementBatches& batches, const BlockPattern& pattern)
{
  std::vector<BatchPositions> positions;
  Grow(abortCheck, positions, batches.Batches.size());
  constexpr std::size_t atOnce = 256;
  ForParts(abortCheck, (positions.size() + atOnce - 1) / atOnce, 8,
    [&](std::size_t part)
    {
      const std::size_t end = std::min(positions.size(), (part + 1) * atOnce);
      for (std::size_t batch = part * atOnce; batch < end; ++batch)
      {
        const auto& nodes = batches.Batches[batch].Nodes;
        int pair = 0;
        for (int a = 0; a < ElementBatch::NumberOfNodes; ++a)
        {
          for (int b = a + 1; b < ElementBatch::NumberOfNodes; ++b, ++pair)
          {
            for (int lane = 0; lane < NumberOfLanes; ++lane)
            {
              const bool isRising = nodes[a][lane] < nodes[b][lane];
              const std::int32_t block = pattern.Find(isRising ? nodes[a][lane] : nodes[b][lane],
                isRising ? nodes[b][lane] : nodes[a][lane]);
              positions[batch].Blocks[pair][lane] = isRising ? block : ~block;
            }
          }
        }
      }
    });
  return positions;
}

void BlockMatrix::SetPattern(AbortCheck& abortCheck, BlockPattern pattern)
{
  this->Pattern = std::move(pattern);
  // One more value than the blocks need, for the ignored lane of LoadColumn.
  this->Values.clear();
  Grow(abortCheck, this->Values, this->Pattern.GetNumberOfBlocks() * BlockSize + 1);
}

void BlockMatrix::PutToZero(AbortCheck& abortCheck)
{
  constexpr std::size_t size = std::size_t(1) << 16;
  ForParts(abortCheck, (this->Values.size() + size - 1) / size, 256,
    [&](std::size_t part)
    {
      const std::size_t begin = part * size;
      const std::size_t end = std::min(this->Values.size(), begin + size);
      std::fill(this->Values.begin() + static_cast<std::ptrdiff_t>(begin),
        this->Values.begin() + static_cast<std::ptrdiff_t>(end), 0.0);
    });
}

void BlockMatrix::Mirror(AbortCheck& abortCheck)
{
  const std::size_t rows = this->Pattern.GetNumberOfRows();
  ForParts(abortCheck, (rows + RowsOfPart - 1) / RowsOfPart, PartsAtOnce,
    [&](std::size_t part)
    {
      const std::size_t end = std::min(rows, (part + 1) * RowsOfPart);
      for (std::size_t row = part * RowsOfPart; row < end; ++row)
      {
        for (std::int32_t block = this->Pattern.Rows[row]; block < this->Pattern.Diagonal[row];
             ++block)
        {
          const double* source =
            this->GetBlock(this->Pattern.Mirrored[static_cast<std::size_t>(block)]);
          double* target = this->GetBlock(block);
          for (int i = 0; i < 3; ++i)
          {
            for (int j = 0; j < 3; ++j)
            {
              target[3 * i + j] = source[3 * j + i];
            }
          }
        }
      }
    });
}

void BlockMatrix::Multiply(std::size_t begin, std::size_t end, const unsigned char* isFree,
  const glm::dvec3* vector, glm::dvec3* product) const
{
  const ProductArguments arguments = { this->Pattern.Rows.data(), this->Pattern.Columns.data(),
    this->Values.data(), isFree, &vector->x, &product->x };
  RunOnLanes([&]() __attribute__((always_inline)) { MultiplyRows(arguments, begin, end); });
}

} // namespace deformvolume
