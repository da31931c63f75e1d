// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputSlab_h
#define DeformVolumeOutputSlab_h

#include "DeformRequest.h"
#include "Extent.h"
#include "KernelParameters.h"
#include "LargeCellList.h"
#include "OpenCLContext.h"
#include "OutputMemory.h"
#include "OutputWinners.h"
#include "SectionCounters.h"
#include "VolumeArray.h"
#include "VoxelGrid.h"

#include <vector>

namespace deformvolume
{

class KernelLauncher;

/// A slab of the output of exact resampling: besides its arrays and their coverage, the winners of
/// overlaps and the counters of the bricks of cells.
class OutputSlab : public OutputMemory
{
public:
  /// Prepares the memory for a slab (OutputMemory::Bind()).
  void Bind(KernelLauncher& launcher, const Extent& extent, const DeformRequest& request,
    const std::vector<VolumeArray>& arrays, const VoxelGrid& voxelGrid, std::size_t numberOfBricks);
  /// Sets the coverage to 0, and fills the arrays with the background. If coverage is stored as
  /// bits, FillUncoveredVoxels() fills the arrays instead. Call this after Bind().
  void Clear(KernelLauncher& launcher, bool coverageBits);
  /// If coverage is stored as bits: expands the bits to bytes, and fills voxels that are not
  /// covered with the background. isUpdate: only patches that PrepareUpdate() cleared have changed.
  void FillUncoveredVoxels(KernelLauncher& launcher, bool isUpdate);

  /// The parts of an output that an incremental update computes (see ChangeTracker).
  struct PartToUpdate
  {
    const std::vector<cl_uint>& Bricks;
    const cl::Buffer& BrickList; // Bricks on the device, unless empty
    const std::vector<std::uint32_t>& Patches;
    bool WithWinners; // whether the last output chose winners
  };
  /// Replaces Bind() and Clear() for an incremental update. The last output and its counters must
  /// be available. Clears the patches, the counters of the bricks, and the counters by which the
  /// passes for winners find their work. Other patches keep their winners.
  void PrepareUpdate(KernelLauncher& launcher, const DeformRequest& request,
    const std::vector<VolumeArray>& arrays, const PartToUpdate& part);

  OutputWinners& GetWinners() { return this->Winners; }
  const OutputWinners& GetWinners() const { return this->Winners; }
  /// See OutputWinners. parameters: of the mesh.
  void FindUnsettledVoxels(
    KernelLauncher& launcher, bool claimed, const KernelParameters& parameters);

  std::uint64_t CountCovered(KernelLauncher& launcher);
  /// Counts the covered voxels of some patches, after FillUncoveredVoxels.
  std::uint64_t CountCovered(KernelLauncher& launcher, const std::vector<std::uint32_t>& patches);
  /// Reads the sums of the counters. covered: whether to find SlabCounts::Covered, which requires
  /// that coverage is bits.
  SlabCounts ReadCounts(KernelLauncher& launcher, bool covered);

  /// Whether the slab fits the CPU kernel, which uses float positions and 31-bit indices.
  bool FitsLanes() const;

  /// Sets the output extent in the parameters of a launch.
  void SetParameters(KernelParameters& parameters) const;

  bool HasCoverageBits() const { return this->BitsUsed; }
  /// The buffer that resampling kernels write: bits or bytes.
  const cl::Buffer& GetCoverageTarget() const
  {
    return this->BitsUsed ? this->CoverageBits : this->GetCoverage();
  }
  const LargeCellList& GetLargeCells() const { return this->LargeCells; }
  const SectionCounters& GetCounters() const { return this->Counters; }
  SectionCounters& GetCounters() { return this->Counters; }

  /// Waits for all commands, also after a failure, and releases the memory of the request. Does not
  /// throw.
  void Finish();

  std::uint64_t GetMemory() const;

private:
  void SendPatches(KernelLauncher& launcher, const std::vector<std::uint32_t>& patches);
  void ExpandCoverage(KernelLauncher& launcher, bool isUpdate);

  cl::CommandQueue Queue;
  Extent WholeExtent = EmptyExtent; // of the output
  cl::Buffer CoverageBits;
  bool BitsUsed = false;
  OutputWinners Winners;
  cl::Buffer PatchList; // patches that an update clears
  std::size_t NumberOfListedPatches = 0;
  SectionCounters Counters;
  LargeCellList LargeCells; // at most 1 MB; GetMemory() does not count it
};

} // namespace deformvolume

#endif
