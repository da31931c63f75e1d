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

/// Bytes of a winner's key: four hold a cell of up to 2^30, and two bits, for inverted
/// tetrahedra and for voxels that are still to be won.
std::size_t GetWinnerSize(const VoxelGrid& voxelGrid);

/// Who wins the voxels of an output where tetrahedra overlap, and what is known of its patches: on
/// the device, made when it is needed first.
class OutputWinners
{
public:
  /// An output of this extent is about to be made. Lets go of what does not serve for that.
  void Start(const cl::CommandQueue& queue, const Extent& output, const VoxelGrid& voxelGrid);

  /// Bytes that Prepare will allocate.
  std::uint64_t GetMissingMemory() const;
  /// No voxel has a winner.
  void Prepare(OpenCLContext& context, std::vector<cl::Event>& events);
  /// The same where the last output had winners, for some patches of it. All others are kept.
  /// list: their numbers on the device; parameters: with the extent of the output.
  void PrepareAgain(OpenCLContext& context, const std::vector<std::uint32_t>& patches,
    const cl::Buffer& list, const KernelParameters& parameters, std::vector<cl::Event>& events);
  /// After the pass in which cells claim voxels, or without it where none is contested: finds those
  /// to be won, and those that nobody has written. coverage, counters: of the output.
  void Settle(OpenCLContext& context, bool claimed, const cl::Buffer& coverage,
    const cl::Buffer& counters, const KernelParameters& parameters, std::vector<cl::Event>& events);
  /// Whether Settle has found voxels that several tetrahedra write, now or in patches that are
  /// kept.
  bool HasContested() const;

  ///@{
  /// After Prepare, when winners are no longer needed: room for a count a voxel takes their place.
  void PrepareCounts(OpenCLContext& context, std::vector<cl::Event>& events);
  std::vector<std::uint32_t> ReadCounts() const;
  ///@}

  /// Whether some patches of the output stay as they are.
  bool KeepsPatches() const { return this->IsAgain; }
  /// Null where there are none.
  const cl::Buffer& GetKeys() const { return this->Keys; }
  const cl::Buffer& GetPatches() const { return this->Patches; }

  std::uint64_t GetMemory() const;

private:
  bool HasBuffers() const;
  std::uint64_t CountPatches() const;

  cl::CommandQueue Queue;
  Extent Output{ { 0, -1, 0, -1, 0, -1 } };
  std::uint64_t KeyBytes = 0; // of all voxels
  std::size_t KeySize = 4;
  cl::Buffer Keys;
  cl::Buffer Patches; // a byte for what is known of each, and another where it has contested voxels
  bool IsAgain = false;
};

} // namespace deformvolume

#endif
