// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeActiveBlocks_h
#define DeformVolumeActiveBlocks_h

#include "ChainMailBlocks.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace deformvolume
{

/// A block, and the systems in which voxels around it have changed.
struct ActiveBlock
{
  std::uint32_t Block;
  std::uint32_t Systems;
};

/// The blocks that the kernel Propagate has yet to visit.
class ActiveBlocks
{
public:
  explicit ActiveBlocks(const ChainMailBlocks& blocks);

  /// Set the order of visits: 0 for the default order, other numbers for different random orders.
  void SetOrder(unsigned int order);

  bool IsEmpty() const { return this->Lists[0].empty() && this->Lists[1].empty(); }
  void Add(std::uint32_t block, std::uint32_t systems);
  /// Adds the neighbors of a block on some faces. faces: one bit for each face.
  void AddNeighbors(std::uint32_t block, std::uint32_t faces, std::uint32_t systems);
  /// Takes at most `most` blocks of one color. Blocks of the same color share no faces.
  std::vector<ActiveBlock> Take(int color, std::size_t most);
  void Clear();

private:
  ChainMailBlocks Blocks;
  std::vector<unsigned char> Systems; // for each block
  std::array<std::vector<std::uint32_t>, 2> Lists;
  bool IsShuffled = false;
  std::mt19937 Random;
};

} // namespace deformvolume

#endif
