// SPDX-License-Identifier: BSD-3-Clause
#include "PaddedBlocks.h"

#include "Lanes.h"

#include <cstring>

namespace deformvolume
{
namespace
{

// GCC does not accept a vector_size that depends on a template parameter.
template <typename Real, std::size_t Size>
struct RowLanes;
template <>
struct RowLanes<float, 4>
{
  using Type = float __attribute__((vector_size(16), aligned(16)));
};
template <>
struct RowLanes<float, 8>
{
  using Type = float __attribute__((vector_size(32), aligned(32)));
};
template <>
struct RowLanes<double, 4>
{
  using Type = double __attribute__((vector_size(32), aligned(32)));
};
template <>
struct RowLanes<double, 8>
{
  using Type = double __attribute__((vector_size(64), aligned(64)));
};

template <typename Real>
struct BlockProduct
{
  std::size_t Begin;
  std::size_t End;
  const std::int32_t* Starts;
  const std::int32_t* Columns;
  const Real* Values;
  const Real* Vector;
  const Real* Right;
  Real* Result;
  const Real* Diagonal;
};

enum class Product
{
  Added,
  Subtracted,
  Smoothed
};

template <typename Real, int Rows, int Columns, Product Kind>
DEFORMVOLUME_ALWAYS_INLINE void MultiplyRows(const BlockProduct<Real>& arguments)
{
  constexpr std::size_t padded = PaddedSize<Rows>;
  constexpr std::size_t paddedColumns = PaddedSize<Columns>;
  using Lane = typename RowLanes<Real, padded>::Type;
  for (std::size_t row = arguments.Begin; row < arguments.End; ++row)
  {
    Lane sums[2] = { Lane{}, Lane{} };
    for (auto block = static_cast<std::size_t>(arguments.Starts[row]);
         block < static_cast<std::size_t>(arguments.Starts[row + 1]); ++block)
    {
      const Real* const vector =
        arguments.Vector + paddedColumns * static_cast<std::size_t>(arguments.Columns[block]);
      const Real* const values = arguments.Values + block * (Rows * Columns);
      for (int j = 0; j < Columns; ++j)
      {
        // Lanes after the last row of the block are ignored.
        Lane column;
        std::memcpy(&column, values + j * Rows, sizeof(column));
        sums[j % 2] = sums[j % 2] + column * vector[j];
      }
    }
    Lane sum = sums[0] + sums[1];
    Real* const result = arguments.Result + row * padded;
    Lane before;
    std::memcpy(&before,
      (Kind == Product::Added ? arguments.Result : arguments.Right) + row * padded, sizeof(before));
    sum = Kind == Product::Added ? before + sum : before - sum;
    if (Kind == Product::Smoothed)
    {
      const Real* const diagonal = arguments.Diagonal + row * (Rows * Rows);
      Lane smoothed;
      std::memcpy(&smoothed, arguments.Vector + row * padded, sizeof(smoothed));
      for (int j = 0; j < Rows; ++j)
      {
        Lane column;
        std::memcpy(&column, diagonal + j * Rows, sizeof(column));
        smoothed = smoothed + column * sum[j];
      }
      sum = smoothed;
    }
    std::memcpy(result, &sum, sizeof(sum));
  }
}

template <typename Real, int Rows, int Columns, Product Kind>
void Run(const BlockProduct<Real>& arguments)
{
  RunOnLanes([&]()
      __attribute__((always_inline)) { MultiplyRows<Real, Rows, Columns, Kind>(arguments); });
}

} // namespace

template <typename Real, int Rows, int Columns>
PaddedBlocks<Real, Rows, Columns>::PaddedBlocks(
  AbortCheck& abortCheck, const SparseBlocks<Rows, Columns>& matrix)
  : Starts(matrix.Starts)
  , ColumnOfBlock(matrix.ColumnOfBlock)
{
  constexpr std::size_t size = Rows * Columns;
  // Padding: the last column is read with as many values as there are lanes.
  this->Values.resize(matrix.Blocks.size() * size + PaddedSize<Rows>, Real(0));
  ForItemsInParallel(abortCheck, matrix.Blocks.size(),
    [&](std::size_t block)
    {
      for (std::size_t i = 0; i < size; ++i)
      {
        this->Values[block * size + i] = static_cast<Real>(matrix.Blocks[block].data()[i]);
      }
    });
}

template <typename Real, int Rows, int Columns>
void PaddedBlocks<Real, Rows, Columns>::Subtract(
  std::size_t begin, std::size_t end, const Real* right, const Real* vector, Real* result) const
{
  Run<Real, Rows, Columns, Product::Subtracted>({ begin, end, this->Starts.data(),
    this->ColumnOfBlock.data(), this->Values.data(), vector, right, result, nullptr });
}

template <typename Real, int Rows, int Columns>
void PaddedBlocks<Real, Rows, Columns>::Smooth(std::size_t begin, std::size_t end,
  const std::vector<Real>& diagonal, const Real* right, const Real* vector, Real* result) const
{
  Run<Real, Rows, Columns, Product::Smoothed>({ begin, end, this->Starts.data(),
    this->ColumnOfBlock.data(), this->Values.data(), vector, right, result, diagonal.data() });
}

template <typename Real, int Rows, int Columns>
void PaddedBlocks<Real, Rows, Columns>::Add(
  std::size_t begin, std::size_t end, const Real* vector, Real* result) const
{
  Run<Real, Rows, Columns, Product::Added>({ begin, end, this->Starts.data(),
    this->ColumnOfBlock.data(), this->Values.data(), vector, nullptr, result, nullptr });
}

#define DEFORMVOLUME_BLOCKS(real)                                                                  \
  template class PaddedBlocks<real, 3, 3>;                                                         \
  template class PaddedBlocks<real, 3, 6>;                                                         \
  template class PaddedBlocks<real, 6, 3>;                                                         \
  template class PaddedBlocks<real, 6, 6>;
DEFORMVOLUME_BLOCKS(float)
DEFORMVOLUME_BLOCKS(double)
#undef DEFORMVOLUME_BLOCKS

} // namespace deformvolume
