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

/// The division of a volume into blocks of 8 x 8 x 8 voxels. Local indices of voxels begin at 0 at
/// the first voxel of the volume.
class ChainMailBlocks
{
public:
  explicit ChainMailBlocks(const Extent& extent);

  const Extent& GetExtent() const { return this->Whole; }
  const std::array<int, 3>& GetSize() const { return this->Size; }
  const std::array<int, 3>& GetCounts() const { return this->Counts; }
  std::size_t GetNumberOfBlocks() const;

  /// Returns the neighbor of a block on a face (-x, +x, -y, +y, -z, +z); -1 if there is none.
  std::int64_t GetNeighbor(std::uint32_t block, int face) const;
  /// Returns the color of a block, 0 or 1. Blocks that share a face have different colors.
  int GetColor(std::uint32_t block) const;
  /// Returns the index of a voxel in the arrays of the kernels, which hold one block after the
  /// other.
  std::uint32_t GetVoxelIndex(int x, int y, int z) const;
  /// Returns the local indices of the voxels of a block.
  Extent GetVoxels(std::uint32_t block) const;
  /// Appends the blocks that contain voxels of a box of local indices.
  void Append(const Extent& box, std::vector<std::uint32_t>& blocks) const;
  /// Returns the extents of blocks in structured indices, with neighbors on x joined. blocks: in
  /// ascending order.
  std::vector<Extent> Join(const std::vector<std::uint32_t>& blocks) const;

private:
  std::array<int, 3> GetIndex(std::uint32_t block) const;

  Extent Whole;
  std::array<int, 3> Size;
  std::array<int, 3> Counts;
};

} // namespace deformvolume

#endif
