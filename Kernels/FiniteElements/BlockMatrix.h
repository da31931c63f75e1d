// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBlockMatrix_h
#define DeformVolumeBlockMatrix_h

#include "ElementBatches.h"
#include "Watch.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Where the blocks of a symmetric matrix lie: those of a row by rising columns, its own among
/// them.
struct BlockPattern
{
  /// Of each row the first block, and the number of blocks.
  std::vector<std::int32_t> Rows;
  /// Of each block.
  std::vector<std::int32_t> Columns;
  /// Of each row the block on the diagonal.
  std::vector<std::int32_t> Diagonal;
  /// Of each block the one on the other side of the diagonal.
  std::vector<std::int32_t> Mirrored;

  /// The block of a row and a column that have one.
  std::int32_t Find(std::int32_t row, std::int32_t column) const;
  std::size_t GetNumberOfRows() const { return this->Diagonal.size(); }
  std::size_t GetNumberOfBlocks() const { return this->Columns.size(); }
};

/// The pattern in which nodes that have a tetrahedron in common are connected.
BlockPattern MakeNodePattern(Watch& watch, const ElasticBody& body);

/// Where the blocks above the diagonal of each tetrahedron lie: those of nodes 0 1, 0 2, ..., 0 9,
/// 1 2, ..., 8 9 of a batch. Where the second node has the lower number, what lies above the
/// diagonal is the block transposed, and this is ~position.
struct BatchPositions
{
  static constexpr int NumberOfPairs =
    ElementBatch::NumberOfNodes * (ElementBatch::NumberOfNodes - 1) / 2;

  std::int32_t Blocks[NumberOfPairs][NumberOfLanes];
};
std::vector<BatchPositions> FindPositions(
  Watch& watch, const ElementBatches& batches, const BlockPattern& pattern);

/// A symmetric matrix of blocks of 3 x 3, each by its columns.
class BlockMatrix
{
public:
  static constexpr std::size_t BlockSize = 9;
  /// Rows that are worked on together. Sums are added for so many rows, and then in their order.
  static constexpr std::size_t RowsOfPart = 512;
  static constexpr std::size_t PartsAtOnce = 512;

  void SetPattern(Watch& watch, BlockPattern pattern);
  const BlockPattern& GetPattern() const { return this->Pattern; }

  double* GetBlock(std::int32_t block)
  {
    return &this->Values[static_cast<std::size_t>(block) * BlockSize];
  }
  const double* GetBlock(std::int32_t block) const
  {
    return &this->Values[static_cast<std::size_t>(block) * BlockSize];
  }
  const double* GetDiagonal(std::size_t row) const
  {
    return this->GetBlock(this->Pattern.Diagonal[row]);
  }

  void PutToZero(Watch& watch);

  /// Copies the blocks above the diagonal to below it.
  void Mirror(Watch& watch);

  /// The rows from begin to one before end of the product, where rows are free; elsewhere 0.
  void Multiply(std::size_t begin, std::size_t end, const unsigned char* isFree,
    const glm::dvec3* vector, glm::dvec3* product) const;

private:
  BlockPattern Pattern;
  std::vector<double> Values;
};

} // namespace deformvolume

#endif
