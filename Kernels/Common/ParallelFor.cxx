// SPDX-License-Identifier: BSD-3-Clause
#include "ParallelFor.h"

#include "FirstException.h"
#include "Processors.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace deformvolume
{
namespace
{

std::atomic<ParallelLoop> CurrentLoop{ nullptr };

// Calls body(part) for parts 0 to parts - 1, in parallel on at most `limit` threads. After an
// exception no further part starts. The first exception is rethrown when all threads have ended.
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
    // The threads that have started do all the work.
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

} // namespace

void SetParallelLoop(ParallelLoop loop)
{
  CurrentLoop = loop;
}

void RunOnOwnThreads(
  std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body, int threads)
{
  constexpr std::int64_t partsPerThread = 4;
  const std::int64_t size = std::max<std::int64_t>(0, last - first);
  const std::int64_t step =
    grain > 0 ? grain : std::max<std::int64_t>(1, size / (threads * partsPerThread));
  RunOnThreads(static_cast<std::size_t>((size + step - 1) / step),
    static_cast<std::size_t>(threads),
    [&](std::size_t part)
    {
      const std::int64_t begin = first + static_cast<std::int64_t>(part) * step;
      body(begin, std::min(last, begin + step));
    });
}

void ParallelFor(
  std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body)
{
  const ParallelLoop loop = CurrentLoop;
  if (!loop)
  {
    RunOnOwnThreads(first, last, grain, body, GetProcessorShare());
    return;
  }
  // The body must not throw (ParallelLoop).
  FirstException failure;
  loop(first, last, grain,
    [&](std::int64_t begin, std::int64_t end) { failure.Run([&] { body(begin, end); }); });
  failure.Rethrow();
}

} // namespace deformvolume
