// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeAggregation_h
#define DeformVolumeAggregation_h

#include "AbortCheck.h"
#include "SparseBlocks.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The number of rigid-body modes: three translations and three small rotations.
constexpr int RigidModes = 6;
template <int Size>
using NearNullSpace = std::vector<Eigen::Matrix<double, Size, RigidModes>>;

/// The aggregate of each row of a sparse matrix. An aggregate is a row together with its neighbors
/// that are in no other aggregate.
struct Aggregates
{
  std::vector<std::int32_t> AggregateOfRow;
  std::int32_t NumberOfAggregates = 0;
};
Aggregates MakeAggregates(AbortCheck& abortCheck, const std::vector<std::int32_t>& starts,
  const std::vector<std::int32_t>& columns);

/// The next coarser level of a matrix. Each aggregate of rows has six unknowns there, the
/// amplitudes of its near-null-space modes.
template <int Size>
struct Coarsening
{
  /// Maps unknowns of aggregates to unknowns of rows.
  SparseBlocks<Size, RigidModes> Prolongation;
  SparseBlocks<RigidModes, RigidModes> Matrix;
  NearNullSpace<RigidModes> Modes;
};

/// Returns the largest eigenvalue of the product of the inverse diagonal blocks and the matrix, or
/// a slightly larger value.
template <int Size>
double FindLargestEigenvalue(AbortCheck& abortCheck, const SparseBlocks<Size, Size>& matrix,
  const std::vector<Eigen::Matrix<double, Size, Size>>& inverses);

/// Returns the inverses of the diagonal blocks.
template <int Size>
std::vector<Eigen::Matrix<double, Size, Size>> InvertDiagonal(
  AbortCheck& abortCheck, const SparseBlocks<Size, Size>& matrix);

template <int Size>
Coarsening<Size> Coarsen(AbortCheck& abortCheck, const SparseBlocks<Size, Size>& matrix,
  const std::vector<Eigen::Matrix<double, Size, Size>>& inverses, double largestEigenvalue,
  const NearNullSpace<Size>& modes);

} // namespace deformvolume

#endif
