// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePointSet_h
#define DeformVolumePointSet_h

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A set of points of a deformation, with one bit per point. Points may be added in parallel.
class PointSet
{
public:
  static constexpr std::size_t PointsPerWord = 64;

  /// Makes the set empty, with room for `count` points.
  void Clear(std::size_t count)
  {
    std::vector<Word>((count + PointsPerWord - 1) / PointsPerWord).swap(this->Words);
  }

  /// Adds the points whose bits are set. Bit k is point PointsPerWord * word + k.
  void AddWord(std::size_t word, std::uint64_t bits)
  {
    if (bits)
    {
      this->Words[word].Bits.fetch_or(bits, std::memory_order_relaxed);
    }
  }
  void Add(std::size_t point)
  {
    this->AddWord(point / PointsPerWord, std::uint64_t{ 1 } << point % PointsPerWord);
  }

  /// Adds the points begin to end - 1.
  void AddRange(std::size_t begin, std::size_t end)
  {
    while (begin < end)
    {
      const std::size_t first = begin % PointsPerWord;
      const std::size_t count = std::min(PointsPerWord - first, end - begin);
      this->AddWord(begin / PointsPerWord, ~std::uint64_t{ 0 } >> (PointsPerWord - count) << first);
      begin += count;
    }
  }

  /// Returns a range that contains all points of the set, rounded to whole words. begin = end: the
  /// set is empty.
  void GetEnds(std::size_t& begin, std::size_t& end) const
  {
    const auto isSet = [](const Word& word) { return word.Get() != 0; };
    const auto first = std::find_if(this->Words.begin(), this->Words.end(), isSet);
    const auto last = std::find_if(this->Words.rbegin(), this->Words.rend(), isSet).base();
    begin = PointsPerWord * static_cast<std::size_t>(first - this->Words.begin());
    end = first == this->Words.end()
      ? begin
      : PointsPerWord * static_cast<std::size_t>(last - this->Words.begin());
  }

  /// Whether the set has any of the points begin to end - 1. The range may exceed the size of the
  /// set.
  bool HasAnyOf(std::size_t begin, std::size_t end) const
  {
    end = std::min(end, PointsPerWord * this->Words.size());
    while (begin < end)
    {
      const std::size_t first = begin % PointsPerWord;
      const std::size_t count = std::min(PointsPerWord - first, end - begin);
      if (this->Words[begin / PointsPerWord].Get() >> first << (PointsPerWord - count))
      {
        return true;
      }
      begin += count;
    }
    return false;
  }

private:
  struct Word
  {
    std::uint64_t Get() const { return this->Bits.load(std::memory_order_relaxed); }
    std::atomic<std::uint64_t> Bits{ 0 };
  };
  std::vector<Word> Words;
};

} // namespace deformvolume

#endif
