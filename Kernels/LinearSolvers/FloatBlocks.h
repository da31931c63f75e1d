// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFloatBlocks_h
#define DeformVolumeFloatBlocks_h

#include "SparseBlocks.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The number of floats that a row of a multigrid vector takes. The floats after the first three
/// (or six, for Rows = 6) are padding.
template <int Rows>
constexpr std::size_t PaddedSize = Rows <= 4 ? 4 : 8;

/// A sparse matrix of blocks in single precision, which is accurate enough for a preconditioner.
/// Each block is stored by columns.
template <int Rows, int Columns>
class FloatBlocks
{
public:
  FloatBlocks() = default;
  FloatBlocks(Watch& watch, const SparseBlocks<Rows, Columns>& matrix);

  std::size_t GetNumberOfRows() const { return this->Starts.size() - 1; }

  /// Sets the rows [begin, end) of result = right - matrix * vector. May be called in parallel for
  /// different rows.
  void Subtract(std::size_t begin, std::size_t end, const float* right, const float* vector,
    float* result) const;

  /// result = vector + diagonal * (right - matrix * vector), where `diagonal` has a block for each
  /// row.
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
