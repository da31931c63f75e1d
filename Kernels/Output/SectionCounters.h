// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSectionCounters_h
#define DeformVolumeSectionCounters_h

#include "OpenCLContext.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

class KernelLauncher;

/// The sums of the counters of a slab.
struct SlabCounts
{
  std::uint64_t Writes = 0;
  std::uint64_t Inverted = 0;
  std::uint64_t Overstretched = 0;
  std::uint64_t Covered = 0; // only if coverage is bits, after a pass over all cells
  bool HasLarge = false;     // whether there are large cells
  /// Whether tetrahedra at the border of the sampling mesh do not cover samples that the kernel
  /// assumed they cover.
  bool MissingWhereAssumed = false;

  /// Whether winners must be chosen. Without overlaps every covered voxel is written once. Where
  /// the mesh is folded, voxels on the crease may also be missing.
  bool NeedWinners(std::uint64_t covered) const
  {
    return this->Writes > covered || this->Inverted > 0 || this->Overstretched > 0 ||
      this->MissingWhereAssumed;
  }
};

/// The counters, on the device, of the sections of bricks of cells (DEFORMVOLUME_COUNTERS).
class SectionCounters
{
public:
  /// Reserves the counters, and sets them to 0.
  void Start(KernelLauncher& launcher, std::size_t numberOfBricks);
  /// Sets all counters to 0, before a counting pass is repeated.
  void Clear(KernelLauncher& launcher);
  /// Sets the counters of some sections to 0, before an incremental update. bricks: number of
  /// bricks in the list. brickList: in the format of DEFORMVOLUME_BRICK_BITS. withWinners: whether
  /// to clear also, for all sections, the counters by which the passes for winners find their work.
  void ClearSections(
    KernelLauncher& launcher, std::size_t bricks, const cl::Buffer& brickList, bool withWinners);

  /// Reads the sums. coverageBits, words: to find SlabCounts::Covered; null and 0 otherwise.
  SlabCounts Read(KernelLauncher& launcher, const cl::Buffer& coverageBits, std::uint64_t words);
  /// Returns the bricks with sections that have a counter other than 0, in the format of
  /// DEFORMVOLUME_BRICK_BITS.
  std::vector<cl_uint> FindBricks(KernelLauncher& launcher, int counter) const;

  const cl::Buffer& GetBuffer() const { return this->Counters; }
  std::uint64_t GetMemory() const;

private:
  cl::Buffer Counters;
  cl::Buffer Parts;   // partial sums of Counters
  cl::Buffer Summary; // sums of Parts
  std::size_t NumberOfSections = 0;
};

} // namespace deformvolume

#endif
