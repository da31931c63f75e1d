// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChainMailLimits_h
#define DeformVolumeChainMailLimits_h

#include "ChainMailTypes.h"

#include <array>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The limits of materials in the layout of the kernels.
struct ChainMailLimits
{
  /// table: 1 to 256 materials. spacing: of the voxels, on each axis. Throws an Error if a material
  /// is invalid.
  ChainMailLimits(
    const std::vector<ChainMailMaterial>& table, const std::array<double, 3>& spacing);

  std::vector<std::int32_t> Limits;
  std::vector<unsigned char> Weights;
  std::vector<float> Reciprocals;
};

} // namespace deformvolume

#endif
