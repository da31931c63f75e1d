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

/// A copy of the displacements of a ChainMailModel. It has the blocks of 8 x 8 x 8 voxels that are
/// not at rest, with 6 KiB each. Blocks that are the same as in an earlier snapshot are shared with
/// it.
struct ChainMailSnapshot
{
  /// The number of voxels of a block.
  static constexpr std::size_t VoxelsPerBlock = 512;
  /// Three displacements per voxel, in 1/65536 of the spacing.
  using Block = std::array<std::int32_t, 3 * VoxelsPerBlock>;

  /// Structured extent of the volume.
  Extent Voxels = EmptyExtent;
  /// The numbers of the blocks, in ascending order.
  std::vector<std::uint32_t> Numbers;
  /// The blocks with these numbers.
  std::vector<std::shared_ptr<const Block>> Blocks;
};

} // namespace deformvolume

#endif
