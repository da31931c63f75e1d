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

/// Bounds of many points that are looked at by blocks. Of a block that lies within the others for
/// certain, only a box that holds it is found. What is found is kept until the block changes.
class BlockBounds
{
public:
  /// So many blocks, of which nothing is known.
  void Resize(std::size_t blocks)
  {
    this->Bounds.resize(blocks);
    this->IsExact.resize(blocks);
  }
  /// How many blocks there are.
  std::size_t GetNumberOfBlocks() const { return this->Bounds.size(); }

  /// Finds the bounds of all blocks. changed: nonzero for those that are not as they were.
  /// findBox(block): a box that holds a changed block, empty if it is. findBounds(block): its
  /// bounds. Both are called by many threads.
  template <typename FindBox, typename FindBounds>
  IndexBounds Compute(
    const std::vector<unsigned char>& changed, FindBox&& findBox, FindBounds&& findBounds)
  {
    std::vector<std::size_t> other;
    for (std::size_t block = 0; block < this->Bounds.size(); ++block)
    {
      if (changed[block])
      {
        other.push_back(block);
      }
    }
    constexpr std::size_t step = 16;
    ParallelForParts(other.size(), step,
      [&](std::size_t begin, std::size_t end)
      {
        for (std::size_t i = begin; i < end; ++i)
        {
          const std::size_t block = other[i];
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
    // Those that reach farthest first: they leave few others.
    std::vector<std::size_t> left = this->FindBeyond(all);
    for (int direction = 0; direction < 6 && !left.empty(); ++direction)
    {
      const std::size_t farthest = this->FindFarthest(left, direction / 2, direction % 2 != 0);
      if (!this->IsExact[farthest] && !Holds(all, this->Bounds[farthest]))
      {
        compute(farthest);
        all.Add(this->Bounds[farthest]);
      }
    }
    left = this->FindBeyond(all, left);
    ParallelForParts(left.size(), 1, [&](std::size_t begin, std::size_t) { compute(left[begin]); });
    for (const std::size_t block : left)
    {
      all.Add(this->Bounds[block]);
    }
    return all;
  }

private:
  /// Whether a box has another one in it. What is not-a-number is in none.
  static bool Holds(const IndexBounds& box, const IndexBounds& other)
  {
    return !box.IsEmpty() && glm::all(glm::lessThanEqual(box.Min, other.Min)) &&
      glm::all(glm::greaterThanEqual(box.Max, other.Max));
  }

  /// Of all blocks whose bounds are known.
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

  /// Those whose bounds are not known, and whose boxes a box does not hold; in the second form of
  /// some blocks.
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

  /// The one of some blocks that reaches farthest on an axis.
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
  std::vector<unsigned char> IsExact; // else a box that holds them
};

} // namespace deformvolume

#endif
