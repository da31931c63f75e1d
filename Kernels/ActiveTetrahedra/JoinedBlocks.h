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

/// The blocks of several edits joined, brick by brick. An added edit is joined with the existing
/// blocks; the earlier edits are not needed. Joining must not depend on the order of edits.
template <typename Value>
class JoinedBlocks
{
public:
  /// The values of a brick.
  using Block = typename BrickSet<Value>::Block;
  /// Joins a value with another one.
  using Join = void (*)(Value& value, const Value& other);

  /// empty: the neutral value, which changes no value that it is joined with.
  JoinedBlocks(const Value& empty, Join join)
    : JoinValues(join)
  {
    this->Empty.fill(empty);
  }

  /// Joins a block of an edit with the block of its brick.
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
  void Add(const BrickSet<Value>& edit)
  {
    for (std::size_t i = 0; i < edit.Bricks.size(); ++i)
    {
      this->Add(edit.Bricks[i], edit.Blocks[i]);
    }
  }
  /// Removes the blocks of some bricks.
  void Forget(const std::vector<std::size_t>& bricks)
  {
    for (const std::size_t brick : bricks)
    {
      this->Blocks.erase(brick);
    }
  }
  /// Joins the blocks of an edit, but only those of the bricks in `wanted`.
  void Rejoin(const std::vector<std::size_t>& wanted, const BrickSet<Value>& edit)
  {
    for (const std::size_t brick : wanted)
    {
      if (const Block* block = FindBlock(edit, brick))
      {
        this->Add(brick, *block);
      }
    }
  }
  /// Removes all blocks.
  void Clear() { this->Blocks.clear(); }

  /// Returns the joined block of a brick; null if no edit has one.
  const Block* Find(std::size_t brick) const
  {
    const auto found = this->Blocks.find(brick);
    return found == this->Blocks.end() ? nullptr : &found->second;
  }

  /// Returns the number of blocks that were joined, a measure of the work for edits.
  std::uint64_t GetNumberOfJoins() const { return this->NumberOfJoins; }

private:
  Join JoinValues;
  Block Empty;
  std::unordered_map<std::size_t, Block> Blocks;
  std::uint64_t NumberOfJoins = 0;
};

} // namespace deformvolume

#endif
