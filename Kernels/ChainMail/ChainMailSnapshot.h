// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChainMailSnapshot_h
#define DeformVolumeChainMailSnapshot_h

#include "Extent.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace deformvolume
{

/// The displacements of a ChainMailModel at some time. It holds the blocks of 8 x 8 x 8 voxels that
/// are not at rest, 6 KiB each; one that is as in an earlier snapshot is shared with it.
struct ChainMailSnapshot
{
  /// Voxels of a block.
  static constexpr std::size_t VoxelsPerBlock = 512;
  /// Three displacements a voxel, in 1/65536 of the spacing.
  using Block = std::array<std::int32_t, 3 * VoxelsPerBlock>;

  /// Structured indices of the volume.
  Extent Voxels{ { 0, -1, 0, -1, 0, -1 } };
  /// The numbers of the blocks, ascending.
  std::vector<std::uint32_t> Numbers;
  /// The blocks of these numbers.
  std::vector<std::shared_ptr<const Block>> Blocks;
};

} // namespace deformvolume

#endif
