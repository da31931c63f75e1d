// SPDX-License-Identifier: BSD-3-Clause
#include "ParallelFor.h"

#include "FirstException.h"
#include "HostThreads.h"
#include "Processors.h"

#include <algorithm>
#include <atomic>
#include <cstddef>

namespace deformvolume
{
namespace
{

std::atomic<ParallelLoop> CurrentLoop{ nullptr };

} // namespace

void SetParallelLoop(ParallelLoop loop)
{
  CurrentLoop = loop;
}

void RunOnOwnThreads(
  std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body, int threads)
{
  constexpr std::int64_t partsOfThread = 4;
  const std::int64_t size = std::max<std::int64_t>(0, last - first);
  const std::int64_t step =
    grain > 0 ? grain : std::max<std::int64_t>(1, size / (threads * partsOfThread));
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
  // Not all loops can be left by an exception.
  FirstException failure;
  loop(first, last, grain,
    [&](std::int64_t begin, std::int64_t end) { failure.Run([&] { body(begin, end); }); });
  failure.Rethrow();
}

} // namespace deformvolume
