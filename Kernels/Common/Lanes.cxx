// SPDX-License-Identifier: BSD-3-Clause
#include "Lanes.h"

#include "InstructionSets.h"

#include <atomic>

namespace deformvolume
{
namespace
{

bool FindWideLanes()
{
  return DEFORMVOLUME_HAS_AVX2_CODE && FindInstructionSets().AVX2;
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
