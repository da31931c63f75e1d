// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeAbortCheck_h
#define DeformVolumeAbortCheck_h

#include "Error.h"
#include "ParallelFor.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace deformvolume
{

/// Calls a progress callback at most every 5 ms, and aborts when it returns false.
class AbortCheck
{
public:
  explicit AbortCheck(std::function<bool()> progress)
    : Progress(std::move(progress))
  {
  }

  /// Calls the callback if 5 ms have passed. Throws Aborted if it returns false.
  void Check()
  {
    constexpr std::chrono::milliseconds interval(5);
    const auto now = std::chrono::steady_clock::now();
    if (this->Progress && (now - this->Last >= interval || this->IsFirst))
    {
      this->IsFirst = false;
      this->Last = now;
      if (!this->Progress())
      {
        throw Aborted();
      }
    }
  }

private:
  std::function<bool()> Progress;
  std::chrono::steady_clock::time_point Last{};
  bool IsFirst = true;
};

/// Calls body(item) for items 0 to items - 1 in sequence, and checks for an abort after every 4096
/// items. An item should take about a microsecond.
template <typename Body>
void ForItems(AbortCheck& abortCheck, std::size_t items, Body&& body)
{
  constexpr std::size_t atOnce = 4096;
  for (std::size_t begin = 0; begin < items; begin += atOnce)
  {
    abortCheck.Check();
    for (std::size_t item = begin; item < std::min(items, begin + atOnce); ++item)
    {
      body(item);
    }
  }
}

/// Grows a vector to a size, and checks for an abort after every 16 MiB, since the first access to
/// new memory is slow.
template <typename Value>
void Grow(AbortCheck& abortCheck, std::vector<Value>& values, std::size_t size)
{
  constexpr std::size_t atOnce = (std::size_t(1) << 24) / sizeof(Value);
  values.reserve(size);
  while (values.size() < size)
  {
    abortCheck.Check();
    values.resize(std::min(size, values.size() + atOnce));
  }
}

/// Calls body(part) for parts 0 to parts - 1 in parallel, and checks for an abort after every
/// atOnce parts. `atOnce` parts should take at most about ten milliseconds.
template <typename Body>
void ForParts(AbortCheck& abortCheck, std::size_t parts, std::size_t atOnce, Body&& body)
{
  for (std::size_t begin = 0; begin < parts; begin += atOnce)
  {
    abortCheck.Check();
    ParallelForItems(std::min(atOnce, parts - begin), 1, [&](std::size_t i) { body(begin + i); });
  }
}

/// Calls body(item) for items 0 to items - 1 in parallel, and checks for an abort after every 8192
/// items. An item should take about a microsecond.
template <typename Body>
void ForItemsInParallel(AbortCheck& abortCheck, std::size_t items, Body&& body)
{
  constexpr std::size_t size = 1024;
  constexpr std::size_t partsAtOnce = 8;
  ForParts(abortCheck, (items + size - 1) / size, partsAtOnce,
    [&](std::size_t part)
    {
      for (std::size_t item = part * size; item < std::min(items, (part + 1) * size); ++item)
      {
        body(item);
      }
    });
}

} // namespace deformvolume

#endif
