// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBlockBounds_h
#define DeformVolumeBlockBounds_h

#include "IndexBounds.h"
#include "ParallelFor.h"

#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Computes the bounds of many points, block by block. If the bounds of other blocks certainly
/// contain a block, only an upper bound of its box is computed. The results are kept until the
/// block changes.
class BlockBounds
{
public:
  /// Set the number of blocks.
  void Resize(std::size_t blocks)
  {
    this->Bounds.resize(blocks);
    this->IsExact.resize(blocks);
  }
  /// Number of blocks.
  std::size_t GetNumberOfBlocks() const { return this->Bounds.size(); }

  /// Computes the bounds of all blocks. changed: nonzero for blocks that have changed since the
  /// last call. findBox(block): returns a box that contains a block; it is empty if the block is
  /// empty. findBounds(block): returns the exact bounds of a block. Both functions are called in
  /// parallel.
  template <typename FindBox, typename FindBounds>
  IndexBounds Compute(
    const std::vector<unsigned char>& changed, FindBox&& findBox, FindBounds&& findBounds)
  {
    std::vector<std::size_t> stale;
    for (std::size_t block = 0; block < this->Bounds.size(); ++block)
    {
      if (changed[block])
      {
        stale.push_back(block);
      }
    }
    constexpr std::size_t step = 16;
    ParallelForParts(stale.size(), step,
      [&](std::size_t begin, std::size_t end)
      {
        for (std::size_t i = begin; i < end; ++i)
        {
          const std::size_t block = stale[i];
          this->Bounds[block] = findBox(block);
          this->IsExact[block] = this->Bounds[block].IsEmpty() ? 1 : 0;
        }
      });
    const auto compute = [&](std::size_t block)
    {
      this->Bounds[block] = findBounds(block);
      this->IsExact[block] = 1;
    };
    IndexBounds all = this->GetExact();
    // Start with the blocks that extend farthest: the bounds then contain most other blocks.
    std::vector<std::size_t> remaining = this->FindBeyond(all);
    for (int direction = 0; direction < 6 && !remaining.empty(); ++direction)
    {
      const std::size_t farthest = this->FindFarthest(remaining, direction / 2, direction % 2 != 0);
      if (!this->IsExact[farthest] && !Holds(all, this->Bounds[farthest]))
      {
        compute(farthest);
        all.Add(this->Bounds[farthest]);
      }
    }
    remaining = this->FindBeyond(all, remaining);
    ParallelForParts(
      remaining.size(), 1, [&](std::size_t begin, std::size_t) { compute(remaining[begin]); });
    for (const std::size_t block : remaining)
    {
      all.Add(this->Bounds[block]);
    }
    return all;
  }

private:
  /// Whether a box contains another box. False if the other box has a NaN.
  static bool Holds(const IndexBounds& box, const IndexBounds& other)
  {
    return !box.IsEmpty() && glm::all(glm::lessThanEqual(box.Min, other.Min)) &&
      glm::all(glm::greaterThanEqual(box.Max, other.Max));
  }

  /// Returns the bounds of all blocks with exact bounds.
  IndexBounds GetExact() const
  {
    IndexBounds all;
    for (std::size_t block = 0; block < this->Bounds.size(); ++block)
    {
      if (this->IsExact[block])
      {
        all.Add(this->Bounds[block]);
      }
    }
    return all;
  }

  /// Finds the blocks without exact bounds that a box does not contain, among all blocks or among
  /// the given blocks.
  std::vector<std::size_t> FindBeyond(const IndexBounds& box) const
  {
    std::vector<std::size_t> beyond;
    for (std::size_t block = 0; block < this->Bounds.size(); ++block)
    {
      this->AddIfBeyond(box, block, beyond);
    }
    return beyond;
  }
  std::vector<std::size_t> FindBeyond(
    const IndexBounds& box, const std::vector<std::size_t>& blocks) const
  {
    std::vector<std::size_t> beyond;
    for (const std::size_t block : blocks)
    {
      this->AddIfBeyond(box, block, beyond);
    }
    return beyond;
  }
  void AddIfBeyond(
    const IndexBounds& box, std::size_t block, std::vector<std::size_t>& beyond) const
  {
    if (!this->IsExact[block] && !Holds(box, this->Bounds[block]))
    {
      beyond.push_back(block);
    }
  }

  /// Returns the block that extends farthest on an axis.
  std::size_t FindFarthest(const std::vector<std::size_t>& blocks, int axis, bool upwards) const
  {
    const auto isNearer = [&](std::size_t a, std::size_t b)
    {
      const IndexBounds& first = this->Bounds[a];
      const IndexBounds& second = this->Bounds[b];
      return upwards ? first.Max[axis] < second.Max[axis] : first.Min[axis] > second.Min[axis];
    };
    return *std::max_element(blocks.begin(), blocks.end(), isNearer);
  }

  std::vector<IndexBounds> Bounds;
  std::vector<unsigned char> IsExact; // 0: Bounds may be too large
};

} // namespace deformvolume

#endif
