// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBlockBounds_h
#define DeformVolumeBlockBounds_h

#include "IndexBounds.h"
#include "ParallelFor.h"

#include <glm/vector_relational.hpp>

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
    for (int direction = 0; direction < 6; ++direction)
    {
      const std::size_t farthest = this->FindFarthest(direction / 2, direction % 2 != 0);
      if (farthest < this->Bounds.size() && !Holds(all, this->Bounds[farthest]))
      {
        compute(farthest);
        all.Add(this->Bounds[farthest]);
      }
    }
    std::vector<std::size_t> left;
    for (std::size_t block = 0; block < this->Bounds.size(); ++block)
    {
      if (!this->IsExact[block] && !Holds(all, this->Bounds[block]))
      {
        left.push_back(block);
      }
    }
    ParallelForParts(left.size(), 1, [&](std::size_t begin, std::size_t) { compute(left[begin]); });
    return this->GetExact();
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

  /// The block, of those whose bounds are not known, whose box reaches farthest on an axis.
  std::size_t FindFarthest(int axis, bool upwards) const
  {
    const auto isFarther = [&](const IndexBounds& a, const IndexBounds& b)
    { return upwards ? a.Max[axis] > b.Max[axis] : a.Min[axis] < b.Min[axis]; };
    std::size_t farthest = this->Bounds.size();
    for (std::size_t block = 0; block < this->Bounds.size(); ++block)
    {
      if (!this->IsExact[block] &&
        (farthest == this->Bounds.size() || isFarther(this->Bounds[block], this->Bounds[farthest])))
      {
        farthest = block;
      }
    }
    return farthest;
  }

  std::vector<IndexBounds> Bounds;
  std::vector<unsigned char> IsExact; // else a box that holds them
};

} // namespace deformvolume

#endif
