// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDensities_h
#define DeformVolumeDensities_h

#include "DeformVolumeExport.h"
#include "ParallelFor.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

namespace deformvolume
{

/// Divides the values of an output by the Jacobian determinants, so that the sum of a density over
/// the volume stays the same. T: float or double. values: one tuple per voxel. valid: nonzero for
/// covered voxels; the values of other voxels do not change. divided: receives the results; may be
/// the same memory as `values`. Covered voxels whose Jacobian is not greater than 0 receive the
/// background. Returns the number of these voxels.
template <typename T>
std::int64_t DivideByJacobian(const T* values, int components, const float* jacobians,
  const signed char* valid, std::int64_t voxels, T background, T* divided)
{
  std::atomic<std::int64_t> count{ 0 };
  ParallelForParts(static_cast<std::size_t>(voxels), 1 << 16,
    [&](std::size_t begin, std::size_t end)
    {
      const auto width = static_cast<std::size_t>(components);
      std::int64_t found = 0;
      for (std::size_t i = begin; i < end; ++i)
      {
        const float jacobian = valid[i] ? jacobians[i] : 1.0F;
        const bool isLost = !(jacobian > 0.0F);
        found += isLost ? 1 : 0;
        for (std::size_t k = i * width; k < (i + 1) * width; ++k)
        {
          divided[k] = isLost ? background : values[k] / static_cast<T>(jacobian);
        }
      }
      count += found;
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
