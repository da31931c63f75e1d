// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputWinners_h
#define DeformVolumeOutputWinners_h

#include "Extent.h"
#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "VoxelGrid.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

class KernelLauncher;

/// Returns the bytes of a winner's key. Four bytes hold a cell number up to 2^30 and two flag bits,
/// for inverted tetrahedra and for contested voxels.
std::size_t GetWinnerSize(const VoxelGrid& voxelGrid);

/// The winners of output voxels where tetrahedra overlap, and the states of patches, on the device.
/// The buffers are allocated when they are first needed.
class OutputWinners
{
public:
  /// Starts an output of this extent. Releases buffers that do not fit it.
  void Start(const Extent& output, const VoxelGrid& voxelGrid);

  /// Returns the bytes that Prepare will allocate.
  std::uint64_t GetMissingMemory() const;
  /// Allocates the buffers if needed, and resets all winners.
  void Prepare(KernelLauncher& launcher);
  /// Resets the winners of some patches. Other patches keep the winners of the last output. list:
  /// the patch numbers on the device. parameters: with the extent of the output.
  void PrepareUpdate(KernelLauncher& launcher, const std::vector<std::uint32_t>& patches,
    const cl::Buffer& list, const KernelParameters& parameters);
  /// Finds the voxels whose winner is not final: contested voxels, which several cells write, and
  /// uncovered voxels that a cell contains but does not own. Call this after
  /// DEFORMVOLUME_PASS_OWNERS, which may be skipped if no voxel is contested, and before
  /// DEFORMVOLUME_PASS_MARK. claimed: whether the pass of the owners was launched. coverage,
  /// counters: of the output.
  void FindUnsettledVoxels(KernelLauncher& launcher, bool claimed, const cl::Buffer& coverage,
    const cl::Buffer& counters, const KernelParameters& parameters);
  /// Whether FindUnsettledVoxels() has found voxels that several tetrahedra write: in this update,
  /// or earlier in patches that are kept.
  bool HasContested(KernelLauncher& launcher) const;

  ///@{
  /// Use the memory of the winners for one count per voxel, after winners are no longer needed.
  void PrepareCounts(KernelLauncher& launcher);
  std::vector<std::uint32_t> ReadCounts(KernelLauncher& launcher) const;
  ///@}

  /// Whether some patches of the output keep their values.
  bool KeepsPatches() const { return this->IsUpdate; }
  /// The buffers; null if not allocated.
  const cl::Buffer& GetKeys() const { return this->Keys; }
  const cl::Buffer& GetPatches() const { return this->Patches; }

  std::uint64_t GetMemory() const;

private:
  bool HasBuffers() const;
  std::uint64_t CountPatches() const;

  Extent Output = EmptyExtent;
  std::uint64_t KeyBytes = 0; // bytes for all voxels
  std::size_t KeySize = 4;
  cl::Buffer Keys;
  cl::Buffer Patches; // a state for each, then whether each has contested voxels
  bool IsUpdate = false;
};

} // namespace deformvolume

#endif
