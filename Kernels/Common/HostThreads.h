// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeHostThreads_h
#define DeformVolumeHostThreads_h

#include "FirstException.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace deformvolume
{

/// Calls body(part) for each of so many parts, side by side on at most so many threads. What a call
/// throws first is thrown once all threads have ended; parts that had not begun are left out then.
template <typename Body>
void RunOnThreads(std::size_t parts, std::size_t limit, Body&& body)
{
  FirstException failure;
  std::atomic<std::size_t> next{ 0 };
  const auto work = [&]
  {
    for (std::size_t part = next++; part < parts; part = next++)
    {
      failure.Run([&] { body(part); });
    }
  };
  std::vector<std::thread> threads;
  try
  {
    const std::size_t wanted = std::min(parts, limit);
    threads.reserve(wanted);
    while (threads.size() + 1 < wanted)
    {
      threads.emplace_back(work);
    }
  }
  catch (const std::system_error&)
  {
    // Those that there are do all.
  }
  catch (const std::bad_alloc&)
  {
  }
  work();
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  failure.Rethrow();
}

} // namespace deformvolume

#endif
