// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStopwatch_h
#define DeformVolumeStopwatch_h

#include "CompilationWatch.h"

#include <chrono>

namespace deformvolume
{

/// Measures the seconds since its construction, without the time of kernel compilation.
class Stopwatch
{
public:
  double GetSeconds() const
  {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - this->Begin;
    return passed.count() - (CompilationWatch::GetCurrentSeconds() - this->Compiled);
  }

private:
  std::chrono::steady_clock::time_point Begin = std::chrono::steady_clock::now();
  double Compiled = CompilationWatch::GetCurrentSeconds();
};

} // namespace deformvolume

#endif
