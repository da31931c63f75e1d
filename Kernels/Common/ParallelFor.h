// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeParallelFor_h
#define DeformVolumeParallelFor_h

#include "DeformVolumeExport.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// Processes the items begin to end - 1 of a range.
using ParallelBody = std::function<void(std::int64_t begin, std::int64_t end)>;

/// Calls a body for all parts of the range from first to last - 1, in parallel, and returns when
/// all calls have returned. A part has `grain` items; 0: the loop chooses. The body does not throw.
using ParallelLoop = void (*)(
  std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body);

/// Set the loop for all work on the host in this process. A program with a thread pool of its own
/// can pass a loop that uses this pool. Default: null, which means RunOnOwnThreads. Thread-safe.
DEFORMVOLUME_EXPORT void SetParallelLoop(ParallelLoop loop);

/// A loop that works on at most `threads` threads, the calling thread included. The threads end
/// when the loop ends.
DEFORMVOLUME_EXPORT void RunOnOwnThreads(
  std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body, int threads);

/// Calls body(begin, end) for parts of a range in parallel; see ParallelLoop. After an exception no
/// further part starts. The first exception is rethrown when all calls have returned.
DEFORMVOLUME_EXPORT void ParallelFor(
  std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body);

/// Calls body(begin, end) in parallel for parts of the range from 0 to size - 1. Each part has
/// `step` items; the last part may have fewer.
template <typename Body>
void ParallelForParts(std::size_t size, std::size_t step, Body&& body)
{
  ParallelFor(0, static_cast<std::int64_t>((size + step - 1) / step), 1,
    [&](std::int64_t first, std::int64_t last)
    {
      for (auto part = static_cast<std::size_t>(first); part < static_cast<std::size_t>(last);
           ++part)
      {
        body(part * step, std::min(size, (part + 1) * step));
      }
    });
}

/// Calls body(item) in parallel for the items 0 to count - 1, `step` items at a time.
template <typename Integer, typename Body>
void ParallelForItems(Integer count, std::size_t step, Body&& body)
{
  ParallelForParts(static_cast<std::size_t>(count), step,
    [&](std::size_t begin, std::size_t end)
    {
      for (; begin < end; ++begin)
      {
        body(static_cast<Integer>(begin));
      }
    });
}

/// Sets `least` to the minimum of `least` and `value`. Thread-safe.
template <typename T>
void Lower(std::atomic<T>& least, T value)
{
  T before = least.load();
  while (value < before && !least.compare_exchange_weak(before, value))
  {
  }
}

/// Returns the first number from 0 to size - 1 for which isWanted(number) is true; `size` if there
/// is none. Tests `step` numbers at a time, in parallel.
template <typename IsWanted>
std::size_t FindFirst(std::size_t size, std::size_t step, IsWanted&& isWanted)
{
  std::atomic<std::size_t> first{ size };
  ParallelForParts(size, step,
    [&](std::size_t begin, std::size_t end)
    {
      while (begin < end && !isWanted(begin))
      {
        ++begin;
      }
      Lower(first, begin < end ? begin : size);
    });
  return first;
}

/// Calls make(number, items) for numbers from 0 to size - 1, `step` numbers at a time, in parallel.
/// make() appends items to a vector. Returns all items, in the order of the numbers.
template <typename Item, typename Make>
std::vector<Item> CollectItems(std::size_t size, std::size_t step, Make&& make)
{
  std::vector<std::vector<Item>> parts((size + step - 1) / step);
  ParallelForParts(size, step,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t number = begin; number < end; ++number)
      {
        make(number, parts[begin / step]);
      }
    });
  std::vector<Item> all;
  for (const std::vector<Item>& part : parts)
  {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

} // namespace deformvolume

#endif
