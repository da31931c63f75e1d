// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeParallelFor_h
#define DeformVolumeParallelFor_h

#include "DeformVolumeExport.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace deformvolume
{

/// What is done with a part of a range, from begin to one before end.
using ParallelBody = std::function<void(std::int64_t begin, std::int64_t end)>;

/// Calls a body for all parts of a range, side by side, and returns when all have ended. A part has
/// grain items; 0: as the loop likes. The body does not throw.
using ParallelLoop = void (*)(
  std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body);

/// The loop that all work on the host uses from now on, in this process: that of a program that has
/// threads already. Null: RunOnOwnThreads, the default. May be called by many threads.
DEFORMVOLUME_EXPORT void SetParallelLoop(ParallelLoop loop);

/// A loop that starts so many threads at most, which end with it.
DEFORMVOLUME_EXPORT void RunOnOwnThreads(
  std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body, int threads);

/// Calls body(begin, end) for parts of a range in parallel; see ParallelLoop. What a call throws
/// first is thrown once all have ended; parts that had not begun are left out then.
DEFORMVOLUME_EXPORT void ParallelFor(
  std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body);

/// The same for parts of 0 to size that have step items each, but for the last one.
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

/// Sets the least of the values that several threads find to another one, if that is lower.
template <typename T>
void Lower(std::atomic<T>& least, T value)
{
  T before = least.load();
  while (value < before && !least.compare_exchange_weak(before, value))
  {
  }
}

} // namespace deformvolume

#endif
