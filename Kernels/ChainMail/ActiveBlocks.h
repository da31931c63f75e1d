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

/// A block, and the systems that voxels round it have changed.
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

  /// Another order for each number but 0.
  void SetOrder(unsigned int order);

  bool IsEmpty() const { return this->Lists[0].empty() && this->Lists[1].empty(); }
  void Add(std::uint32_t block, std::uint32_t systems);
  /// Adds the blocks on faces of another one; faces: as bits.
  void AddNeighbours(std::uint32_t block, std::uint32_t faces, std::uint32_t systems);
  /// Takes blocks of one colour, which share no faces, at most so many.
  std::vector<ActiveBlock> Take(int colour, std::size_t most);
  void Clear();

private:
  ChainMailBlocks Blocks;
  std::vector<unsigned char> Systems; // of each block
  std::array<std::vector<std::uint32_t>, 2> Lists;
  bool IsShuffled = false;
  std::mt19937 Random;
};

} // namespace deformvolume

#endif
