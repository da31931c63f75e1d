// SPDX-License-Identifier: BSD-3-Clause
#include "InstructionSets.h"

#include <algorithm>
#include <initializer_list>

#if defined(__x86_64__) && defined(__GNUC__)
#include <cpuid.h>
#endif

namespace deformvolume
{

// __builtin_cpu_supports() is shorter, but refers to a variable of the compiler's runtime library,
// which the library of the compiler of the wheel, zig, does not have.
#if defined(__x86_64__) && defined(__GNUC__)
namespace
{

struct Registers
{
  unsigned int A = 0;
  unsigned int B = 0;
  unsigned int C = 0;
  unsigned int D = 0;
};

Registers Ask(unsigned int leaf)
{
  Registers registers;
  __get_cpuid_count(leaf, 0, &registers.A, &registers.B, &registers.C, &registers.D);
  return registers;
}

bool HasBits(unsigned int value, std::initializer_list<int> bits)
{
  return std::all_of(bits.begin(), bits.end(), [&](int bit) { return value >> bit & 1U; });
}

/// Returns the register sets that the operating system saves (XCR0). Programs cannot use the other
/// register sets.
unsigned int GetSavedRegisters()
{
  unsigned int low = 0;
  unsigned int high = 0;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return low;
}

} // namespace

InstructionSets FindInstructionSets()
{
  InstructionSets sets;
  const unsigned int first = Ask(1).C;
  if (!HasBits(first, { 27, 28 })) // OSXSAVE, AVX
  {
    return sets;
  }
  const unsigned int seventh = Ask(7).B;
  const unsigned int saved = GetSavedRegisters();
  const bool savesWide = HasBits(saved, { 1, 2 });
  sets.AVX2 = savesWide && HasBits(seventh, { 5 });
  // Leaf 1: FMA, CMPXCHG16B, POPCNT, F16C. Leaf 7: BMI1, BMI2. Leaf 0x80000001: LZCNT.
  sets.Haswell = sets.AVX2 && HasBits(first, { 12, 13, 23, 29 }) && HasBits(seventh, { 3, 8 }) &&
    HasBits(Ask(0x80000001).C, { 5 });
  sets.AVX512 = savesWide && HasBits(saved, { 5, 6, 7 }) && HasBits(seventh, { 16 });
  return sets;
}
#else
InstructionSets FindInstructionSets()
{
  return {};
}
#endif

} // namespace deformvolume
