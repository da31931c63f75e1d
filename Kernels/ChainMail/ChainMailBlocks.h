// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChainMailBlocks_h
#define DeformVolumeChainMailBlocks_h

#include "Extent.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The blocks of 8 x 8 x 8 voxels that a volume is divided into. Local indices count from 0 at its
/// first voxel.
class ChainMailBlocks
{
public:
  explicit ChainMailBlocks(const Extent& extent);

  const Extent& GetExtent() const { return this->Whole; }
  const std::array<int, 3>& GetSize() const { return this->Size; }
  const std::array<int, 3>& GetCounts() const { return this->Counts; }
  std::size_t GetNumberOfBlocks() const;

  /// The block on a face of another one (-x, +x, -y, +y, -z, +z); -1 where there is none.
  std::int64_t GetNeighbour(std::uint32_t block, int face) const;
  /// Blocks that share a face have different ones: 0 or 1.
  int GetColour(std::uint32_t block) const;
  /// The place of a voxel among those of all blocks.
  std::uint32_t GetPlace(int x, int y, int z) const;
  /// Local indices of the voxels of a block.
  Extent GetVoxels(std::uint32_t block) const;
  /// The blocks of the voxels in a box of local indices.
  void Append(const Extent& box, std::vector<std::uint32_t>& blocks) const;
  /// Structured indices of blocks in ascending order; those that are neighbours on x are joined.
  std::vector<Extent> Join(const std::vector<std::uint32_t>& blocks) const;

private:
  std::array<int, 3> GetIndex(std::uint32_t block) const;

  Extent Whole;
  std::array<int, 3> Size;
  std::array<int, 3> Counts;
};

} // namespace deformvolume

#endif
