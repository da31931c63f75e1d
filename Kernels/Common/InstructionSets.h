// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeInstructionSets_h
#define DeformVolumeInstructionSets_h

namespace deformvolume
{

/// Sets of instructions of x86-64 that the processor has and the operating system lets programs
/// use. On other processors, none.
struct InstructionSets
{
  bool AVX2 = false;
  /// AVX2 and what came with it in Intel's Haswell: FMA, BMI1, BMI2, LZCNT, F16C, POPCNT and
  /// CMPXCHG16B.
  bool Haswell = false;
  /// AVX-512 Foundation.
  bool AVX512 = false;
};

InstructionSets FindInstructionSets();

} // namespace deformvolume

#endif
