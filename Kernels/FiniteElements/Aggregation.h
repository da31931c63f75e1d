// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeAggregation_h
#define DeformVolumeAggregation_h

#include "SparseBlocks.h"
#include "Watch.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The translations and rotations of a body, as small motions: six columns.
constexpr int RigidModes = 6;
template <int Size>
using NearNullSpace = std::vector<Eigen::Matrix<double, Size, RigidModes>>;

/// Of each row of a sparse matrix the number of its aggregate: a row with those that it is
/// connected with, as far as they are in no other aggregate.
struct Aggregates
{
  std::vector<std::int32_t> AggregateOfRow;
  std::int32_t NumberOfAggregates = 0;
};
Aggregates MakeAggregates(
  Watch& watch, const std::vector<std::int32_t>& starts, const std::vector<std::int32_t>& columns);

/// The next coarser level of a matrix: six unknowns for each aggregate of rows, which move the
/// aggregate as the near null space says.
template <int Size>
struct Coarsening
{
  /// From aggregates to rows.
  SparseBlocks<Size, RigidModes> Prolongation;
  SparseBlocks<RigidModes, RigidModes> Matrix;
  NearNullSpace<RigidModes> Modes;
};

/// The largest eigenvalue of a matrix whose rows are multiplied with the inverses of the blocks on
/// the diagonal, or little more.
template <int Size>
double FindLargestEigenvalue(Watch& watch, const SparseBlocks<Size, Size>& matrix,
  const std::vector<Eigen::Matrix<double, Size, Size>>& inverses);

/// Inverses of the blocks on the diagonal.
template <int Size>
std::vector<Eigen::Matrix<double, Size, Size>> InvertDiagonal(
  Watch& watch, const SparseBlocks<Size, Size>& matrix);

template <int Size>
Coarsening<Size> Coarsen(Watch& watch, const SparseBlocks<Size, Size>& matrix,
  const std::vector<Eigen::Matrix<double, Size, Size>>& inverses, double largestEigenvalue,
  const NearNullSpace<Size>& modes);

} // namespace deformvolume

#endif
