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

/// Divides the values of an output by the Jacobian, so that the sum of amounts for each unit of
/// volume is kept. T: float or double. values: tuples of some components; they may be divided in
/// place. valid: which voxels are covered; all others stay as they are. Where the Jacobian is not
/// greater than 0 they become the background. Returns how many voxels those were.
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

/// What the sums of densities lack, in words for a warning; "" where that is nothing. hidden:
/// samples that other parts of a folded volume hide, in an output with so many covered voxels.
/// lost: voxels whose Jacobian is not greater than 0. background: what they have, in words.
DEFORMVOLUME_EXPORT std::string DescribeLoss(
  std::int64_t hidden, std::int64_t covered, std::int64_t lost, const std::string& background);

} // namespace deformvolume

#endif
