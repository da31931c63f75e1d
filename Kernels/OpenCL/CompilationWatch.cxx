// SPDX-License-Identifier: BSD-3-Clause
#include "CompilationWatch.h"

#include <algorithm>

namespace deformvolume
{
namespace
{

thread_local CompilationWatch* Current = nullptr;

} // namespace

CompilationWatch::CompilationWatch(const Listener& listener)
  : Listen(listener)
  , Outer(Current)
{
  Current = this;
}

CompilationWatch::~CompilationWatch()
{
  Current = this->Outer;
}

double CompilationWatch::GetCurrentSeconds()
{
  return Current ? Current->Seconds : 0.0;
}

CompilationWatch::Compilation::Compilation()
{
  if (Current && Current->Listen)
  {
    Current->Listen(true);
  }
}

CompilationWatch::Compilation::~Compilation()
{
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - this->Begin;
  if (Current)
  {
    Current->Seconds += std::max(0.0, taken.count() - this->Excluded);
    if (Current->Listen)
    {
      Current->Listen(false);
    }
  }
}

} // namespace deformvolume
