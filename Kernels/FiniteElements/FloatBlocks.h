// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFloatBlocks_h
#define DeformVolumeFloatBlocks_h

#include "SparseBlocks.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// How many numbers a vector of the multigrid method has for each row, of which those behind the
/// third or the sixth are not used.
template <int Rows>
constexpr std::size_t PaddedSize = Rows <= 4 ? 4 : 8;

/// A sparse matrix of blocks in single precision, each by its columns: a preconditioner needs no
/// more.
template <int Rows, int Columns>
class FloatBlocks
{
public:
  FloatBlocks() = default;
  FloatBlocks(Watch& watch, const SparseBlocks<Rows, Columns>& matrix);

  std::size_t GetNumberOfRows() const { return this->Starts.size() - 1; }

  /// The rows from begin to one before end: result = right - matrix * vector. May be called side by
  /// side.
  void Subtract(std::size_t begin, std::size_t end, const float* right, const float* vector,
    float* result) const;

  /// result = vector + diagonal * (right - matrix * vector), of which the diagonal has a block for
  /// each row.
  void Smooth(std::size_t begin, std::size_t end, const std::vector<float>& diagonal,
    const float* right, const float* vector, float* result) const;

  /// result = result + matrix * vector.
  void Add(std::size_t begin, std::size_t end, const float* vector, float* result) const;

private:
  std::vector<std::int32_t> Starts{ 0 };
  std::vector<std::int32_t> ColumnOfBlock;
  std::vector<float> Values;
};

} // namespace deformvolume

#endif
