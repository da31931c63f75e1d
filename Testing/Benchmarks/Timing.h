// SPDX-License-Identifier: BSD-3-Clause
#ifndef Timing_h
#define Timing_h

#include <chrono>

/// Returns the wall-clock seconds that a function takes.
template <typename Work>
double Time(Work&& work)
{
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

#endif
