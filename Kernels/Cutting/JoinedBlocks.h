// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeJoinedBlocks_h
#define DeformVolumeJoinedBlocks_h

#include "BrickBlocks.h"

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace deformvolume
{

/// What the blocks of several edits are together, brick by brick: an edit that is added is joined
/// with what there is, and needs none of the edits before it. The order of edits must not matter.
template <typename Block>
class JoinedBlocks
{
public:
  /// An element of a block.
  using Value = typename Block::value_type;
  /// Joins a value with another one.
  using Join = void (*)(Value& value, const Value& other);

  /// empty: what joins with any value to that value.
  JoinedBlocks(const Value& empty, Join join)
    : JoinValues(join)
  {
    this->Empty.fill(empty);
  }

  /// Joins a block of an edit with what its brick has.
  void Add(std::size_t brick, const Block& block)
  {
    Block& joined = this->Blocks.emplace(brick, this->Empty).first->second;
    for (std::size_t i = 0; i < block.size(); ++i)
    {
      this->JoinValues(joined[i], block[i]);
    }
    ++this->NumberOfJoins;
  }
  /// Joins all blocks of an edit.
  void Add(const std::vector<std::size_t>& bricks, const std::vector<Block>& blocks)
  {
    for (std::size_t i = 0; i < bricks.size(); ++i)
    {
      this->Add(bricks[i], blocks[i]);
    }
  }
  /// Forgets what some bricks have.
  void Forget(const std::vector<std::size_t>& bricks)
  {
    for (const std::size_t brick : bricks)
    {
      this->Blocks.erase(brick);
    }
  }
  /// Adds those of some bricks that an edit has a block of.
  void AddAgain(const std::vector<std::size_t>& wanted, const std::vector<std::size_t>& bricks,
    const std::vector<Block>& blocks)
  {
    for (const std::size_t brick : wanted)
    {
      if (const Block* block = FindBlock(bricks, blocks, brick))
      {
        this->Add(brick, *block);
      }
    }
  }
  /// Forgets everything.
  void Clear() { this->Blocks.clear(); }

  /// Null where no edit has a block.
  const Block* Find(std::size_t brick) const
  {
    const auto found = this->Blocks.find(brick);
    return found == this->Blocks.end() ? nullptr : &found->second;
  }

  /// Blocks of edits that were joined: what edits cost.
  std::uint64_t GetNumberOfJoins() const { return this->NumberOfJoins; }
  /// Bytes that the blocks take.
  std::uint64_t GetMemory() const
  {
    return this->Blocks.size() * (sizeof(Block) + sizeof(std::size_t));
  }

private:
  Join JoinValues;
  Block Empty;
  std::unordered_map<std::size_t, Block> Blocks;
  std::uint64_t NumberOfJoins = 0;
};

} // namespace deformvolume

#endif
