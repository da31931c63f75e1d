// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWatch_h
#define DeformVolumeWatch_h

#include "Error.h"
#include "ParallelFor.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>

namespace deformvolume
{

/// Asks now and then whether to go on.
class Watch
{
public:
  explicit Watch(std::function<bool()> progress)
    : Progress(std::move(progress))
  {
  }

  /// Throws Aborted where the answer is no.
  void Ask()
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

/// Calls body(part) for so many parts in parallel, and asks after so many of them: all together
/// should take some ten milliseconds at most.
template <typename Body>
void ForParts(Watch& watch, std::size_t parts, std::size_t atOnce, Body&& body)
{
  for (std::size_t begin = 0; begin < parts; begin += atOnce)
  {
    watch.Ask();
    const std::size_t end = std::min(parts, begin + atOnce);
    ParallelFor(static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end), 1,
      [&](std::int64_t first, std::int64_t last)
      {
        for (auto part = static_cast<std::size_t>(first); part < static_cast<std::size_t>(last);
             ++part)
        {
          body(part);
        }
      });
  }
}

} // namespace deformvolume

#endif
