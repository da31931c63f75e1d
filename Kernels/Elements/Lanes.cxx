// SPDX-License-Identifier: BSD-3-Clause
#include "Lanes.h"

#include <atomic>

namespace deformvolume
{
namespace
{

bool FindWideLanes()
{
#if DEFORMVOLUME_HAS_AVX2_CODE
  return __builtin_cpu_supports("avx2");
#else
  return false;
#endif
}

std::atomic<bool>& AreUsed()
{
  static std::atomic<bool> areUsed{ FindWideLanes() };
  return areUsed;
}

} // namespace

bool HasWideLanes()
{
  return AreUsed().load(std::memory_order_relaxed);
}

void UseWideLanes(bool areUsed)
{
  AreUsed() = areUsed && FindWideLanes();
}

} // namespace deformvolume
