// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePaddedBlocks_h
#define DeformVolumePaddedBlocks_h

#include "SparseBlocks.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The number of numbers that a row of a multigrid vector takes. Those after the first three (or
/// six, for Rows = 6) are padding.
template <int Rows>
constexpr std::size_t PaddedSize = Rows <= 4 ? 4 : 8;

/// A sparse matrix of blocks of floats or doubles. Each block is stored by columns.
template <typename Real, int Rows, int Columns>
class PaddedBlocks
{
public:
  PaddedBlocks() = default;
  PaddedBlocks(AbortCheck& abortCheck, const SparseBlocks<Rows, Columns>& matrix);

  std::size_t GetNumberOfRows() const { return this->Starts.size() - 1; }

  /// Sets the rows [begin, end) of result = right - matrix * vector. May be called in parallel for
  /// different rows.
  void Subtract(
    std::size_t begin, std::size_t end, const Real* right, const Real* vector, Real* result) const;

  /// result = vector + diagonal * (right - matrix * vector), where `diagonal` has a block for each
  /// row.
  void Smooth(std::size_t begin, std::size_t end, const std::vector<Real>& diagonal,
    const Real* right, const Real* vector, Real* result) const;

  /// result = result + matrix * vector.
  void Add(std::size_t begin, std::size_t end, const Real* vector, Real* result) const;

private:
  std::vector<std::int32_t> Starts{ 0 };
  std::vector<std::int32_t> ColumnOfBlock;
  std::vector<Real> Values;
};

} // namespace deformvolume

#endif
