// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBlockMatrix_h
#define DeformVolumeBlockMatrix_h

#include "AbortCheck.h"
#include "ElementBatches.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The sparsity pattern of a symmetric matrix of blocks. The blocks of a row are sorted by columns
/// and include the diagonal block.
struct BlockPattern
{
  /// The first block of each row, followed by the number of blocks.
  std::vector<std::int32_t> Rows;
  /// The column of each block.
  std::vector<std::int32_t> Columns;
  /// The diagonal block of each row.
  std::vector<std::int32_t> Diagonal;
  /// The block at the transposed position of each block.
  std::vector<std::int32_t> Mirrored;

  /// Returns the block of a row and a column. The block must exist.
  std::int32_t Find(std::int32_t row, std::int32_t column) const;
  std::size_t GetNumberOfRows() const { return this->Diagonal.size(); }
  std::size_t GetNumberOfBlocks() const { return this->Columns.size(); }
};

/// Makes the pattern in which two nodes are connected if they have a tetrahedron in common.
BlockPattern MakeNodePattern(AbortCheck& abortCheck, const ElasticBody& body);

/// The matrix blocks of the pairs of nodes of each tetrahedron of a batch. Pairs are ordered 0 1, 0
/// 2, ..., 0 9, 1 2, ..., 8 9. Only blocks above the diagonal are stored. If the second node of a
/// pair has the lower number, the transposed block lies above the diagonal, and the entry is
/// ~block.
struct BatchPositions
{
  static constexpr int NumberOfPairs =
    ElementBatch::NumberOfNodes * (ElementBatch::NumberOfNodes - 1) / 2;

  std::int32_t Blocks[NumberOfPairs][NumberOfLanes];
};
std::vector<BatchPositions> FindPositions(
  AbortCheck& abortCheck, const ElementBatches& batches, const BlockPattern& pattern);

/// A symmetric matrix of blocks of 3 x 3 values, each block by columns.
class BlockMatrix
{
public:
  static constexpr std::size_t BlockSize = 9;
  /// The number of rows that a thread handles at a time. Sums are formed over these rows, then in
  /// the order of the rows, so that they do not depend on the number of threads.
  static constexpr std::size_t RowsOfPart = 512;
  static constexpr std::size_t PartsAtOnce = 512;

  void SetPattern(AbortCheck& abortCheck, BlockPattern pattern);
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

  void PutToZero(AbortCheck& abortCheck);

  /// Copies the blocks above the diagonal to the transposed positions below it.
  void Mirror(AbortCheck& abortCheck);

  /// Sets the rows [begin, end) of the product of the matrix and a vector: free rows to their
  /// product, other rows to 0.
  void Multiply(std::size_t begin, std::size_t end, const unsigned char* isFree,
    const glm::dvec3* vector, glm::dvec3* product) const;

private:
  BlockPattern Pattern;
  std::vector<double> Values;
};

} // namespace deformvolume

#endif
