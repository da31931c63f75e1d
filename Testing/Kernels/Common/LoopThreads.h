// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLoopThreads_h
#define DeformVolumeLoopThreads_h

#include "ParallelFor.h"

#include <cstdint>

/// Returns the result of a function. The loops of the engine use this number of threads meanwhile.
template <int Threads, typename Function>
auto CallOnThreads(const Function& function)
{
  deformvolume::SetParallelLoop([](std::int64_t first, std::int64_t last, std::int64_t grain,
                                  const deformvolume::ParallelBody& body)
    { deformvolume::RunOnOwnThreads(first, last, grain, body, Threads); });
  const auto result = function();
  deformvolume::SetParallelLoop(nullptr);
  return result;
}

#endif
