// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDensities_h
#define DeformVolumeDensities_h

#include "DeformVolumeExport.h"
#include "ParallelFor.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

namespace deformvolume
{

/// Divides values by Jacobian determinants, so that the sum of a density over the volume stays the
/// same. T: float or double. values: one tuple per voxel. Voxels whose Jacobian is not greater than
/// 0 receive 0. valid: zero for voxels that do not change; null: all change.
template <typename T>
void DivideByJacobian(
  T* values, int components, const float* jacobians, const signed char* valid, std::int64_t voxels)
{
  ParallelForItems(static_cast<std::size_t>(voxels), 1 << 16,
    [&](std::size_t i)
    {
      const auto width = static_cast<std::size_t>(components);
      for (std::size_t k = i * width; k < (i + 1) * width && (!valid || valid[i]); ++k)
      {
        values[k] = jacobians[i] > 0.0F ? values[k] / static_cast<T>(jacobians[i]) : T(0);
      }
    });
}

/// Writes the background to the covered voxels of an output whose Jacobian is not greater than 0.
/// valid: nonzero for covered voxels. Returns the number of these voxels.
template <typename T>
std::int64_t ClearInverted(T* values, int components, const float* jacobians,
  const signed char* valid, std::int64_t voxels, T background)
{
  std::atomic<std::int64_t> count{ 0 };
  ParallelForItems(static_cast<std::size_t>(voxels), 1 << 16,
    [&](std::size_t i)
    {
      if (valid[i] && !(jacobians[i] > 0.0F))
      {
        std::fill_n(values + i * static_cast<std::size_t>(components), components, background);
        ++count;
      }
    });
  return count;
}

/// Returns a warning about amounts that the sums of density arrays lack; empty if they lack
/// nothing. hidden: number of samples that other parts of a folded volume hide. covered: number of
/// covered voxels. lost: number of voxels whose Jacobian is not greater than 0. background:
/// describes the value of these voxels, for the message.
DEFORMVOLUME_EXPORT std::string DescribeLoss(
  std::int64_t hidden, std::int64_t covered, std::int64_t lost, const std::string& background);

} // namespace deformvolume

#endif
