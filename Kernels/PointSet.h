// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePointSet_h
#define DeformVolumePointSet_h

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Some of the points of a deformation, a bit each. Words of different points may be set side by
/// side.
class PointSet
{
public:
  static constexpr std::size_t PointsPerWord = 64;

  /// None of so many points.
  void Clear(std::size_t count)
  {
    this->Words.assign((count + PointsPerWord - 1) / PointsPerWord, 0);
  }

  /// Bit k: point PointsPerWord * word + k.
  void SetWord(std::size_t word, std::uint64_t bits) { this->Words[word] = bits; }

  /// The first one and one past the last, or a few points more; begin = end: there are none.
  void GetEnds(std::size_t& begin, std::size_t& end) const
  {
    const auto isSet = [](std::uint64_t word) { return word != 0; };
    const auto first = std::find_if(this->Words.begin(), this->Words.end(), isSet);
    const auto last = std::find_if(this->Words.rbegin(), this->Words.rend(), isSet).base();
    begin = PointsPerWord * static_cast<std::size_t>(first - this->Words.begin());
    end = first == this->Words.end()
      ? begin
      : PointsPerWord * static_cast<std::size_t>(last - this->Words.begin());
  }

  bool HasAnyOf(std::size_t begin, std::size_t end) const
  {
    while (begin < end)
    {
      const std::size_t first = begin % PointsPerWord;
      const std::size_t count = std::min(PointsPerWord - first, end - begin);
      if (this->Words[begin / PointsPerWord] >> first << (PointsPerWord - count))
      {
        return true;
      }
      begin += count;
    }
    return false;
  }

private:
  std::vector<std::uint64_t> Words;
};

} // namespace deformvolume

#endif
