// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeHostThreads_h
#define DeformVolumeHostThreads_h

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <system_error>
#include <thread>
#include <vector>

namespace deformvolume
{

/// Threads that RunOnThreads uses at most.
inline std::size_t GetNumberOfThreads()
{
  return std::max<std::size_t>(1, std::thread::hardware_concurrency());
}

/// Calls body(part) for each of so many parts, side by side. body must not throw.
template <typename Body>
void RunOnThreads(std::size_t parts, Body&& body)
{
  std::atomic<std::size_t> next{ 0 };
  const auto work = [&]
  {
    for (std::size_t part = next++; part < parts; part = next++)
    {
      body(part);
    }
  };
  std::vector<std::thread> threads;
  try
  {
    while (threads.size() + 1 < std::min(parts, GetNumberOfThreads()))
    {
      threads.emplace_back(work);
    }
  }
  catch (const std::system_error&)
  {
    // Those that there are do all.
  }
  work();
  for (std::thread& thread : threads)
  {
    thread.join();
  }
}

/// Calls body(begin, end) for parts of 0 to size, of so many each, side by side. body must not
/// throw.
template <typename Body>
void RunOnParts(std::size_t size, std::size_t step, Body&& body)
{
  RunOnThreads((size + step - 1) / step,
    [&](std::size_t part) { body(part * step, std::min(size, (part + 1) * step)); });
}

} // namespace deformvolume

#endif
