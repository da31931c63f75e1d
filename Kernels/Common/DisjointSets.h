// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDisjointSets_h
#define DeformVolumeDisjointSets_h

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace deformvolume
{

/// Disjoint sets (union-find) of the numbers 0 to size - 1. At first each number is a set of its
/// own. The representative of a set is its lowest number.
template <typename Integer>
class DisjointSets
{
public:
  explicit DisjointSets(std::size_t size = 0) { this->Reset(size); }

  void Reset(std::size_t size)
  {
    this->Parents.resize(size);
    std::iota(this->Parents.begin(), this->Parents.end(), Integer{ 0 });
  }

  /// Returns the lowest number of the set that contains `item`.
  Integer Find(Integer item)
  {
    while (this->At(item) != item)
    {
      this->At(item) = this->At(this->At(item));
      item = this->At(item);
    }
    return item;
  }

  void Unite(Integer a, Integer b)
  {
    a = this->Find(a);
    b = this->Find(b);
    this->At(std::max(a, b)) = std::min(a, b);
  }

private:
  Integer& At(Integer item) { return this->Parents[static_cast<std::size_t>(item)]; }

  std::vector<Integer> Parents;
};

} // namespace deformvolume

#endif
