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
  static constexpr std::size_t VoxelsPerBlock = 512;
  using Block = std::array<std::int32_t, 3 * VoxelsPerBlock>;

  Extent Voxels{ { 0, -1, 0, -1, 0, -1 } }; // structured indices of the volume
  std::vector<std::uint32_t> Numbers;       // of the blocks, ascending
  std::vector<std::shared_ptr<const Block>> Blocks;
};

} // namespace deformvolume

#endif
