// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputSlab_h
#define DeformVolumeOutputSlab_h

#include "DeformRequest.h"
#include "Extent.h"
#include "HostMemory.h"
#include "KernelParameters.h"
#include "LargeCellList.h"
#include "OpenCLContext.h"
#include "OutputWinners.h"
#include "SectionCounters.h"
#include "VolumeArray.h"
#include "VoxelGrid.h"

#include <memory>
#include <vector>

namespace deformvolume
{

class WorkDevice;

/// A slab of the output on the device: a range of planes of all arrays, their coverage, the winners
/// of overlaps, and the counters of the bricks of cells.
class OutputSlab
{
public:
  /// Allocates memory for a slab of the request's output, reuses existing buffers, or uses the
  /// memory of the request in place. Adds events of launches to a list.
  void Bind(OpenCLContext& context, const cl::CommandQueue& queue, const Extent& extent,
    const DeformRequest& request, const std::vector<VolumeArray>& arrays,
    const VoxelGrid& voxelGrid, std::size_t numberOfBricks, std::vector<cl::Event>& events);
  /// Sets the coverage to 0, and fills the arrays with the background. If coverage is stored as
  /// bits, Complete() fills the arrays instead. Call this after Bind().
  void Clear(OpenCLContext& context, const std::vector<VolumeArray>& arrays, bool coverageBits,
    std::vector<cl::Event>& events);
  /// If coverage is stored as bits: expands the bits to bytes, and fills voxels that are not
  /// covered with the background. isUpdate: only patches that PrepareUpdate() cleared have changed.
  void Complete(OpenCLContext& context, const std::vector<VolumeArray>& arrays, bool isUpdate,
    std::vector<cl::Event>& events);

  /// Whether the last output, for the same extent, is available: in the memory of this request for
  /// arrays that are written in place, otherwise on the device.
  bool HoldsLastOutput(const OpenCLContext& context, const DeformRequest& request,
    const std::vector<VolumeArray>& arrays) const;
  /// The parts of an output that an incremental update computes (see IncrementalUpdate).
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
  void PrepareUpdate(OpenCLContext& context, const cl::CommandQueue& queue,
    const DeformRequest& request, const std::vector<VolumeArray>& arrays, const PartToUpdate& part,
    std::vector<cl::Event>& events);

  OutputWinners& GetWinners() { return this->Winners; }
  const OutputWinners& GetWinners() const { return this->Winners; }
  /// See OutputWinners. parameters: of the mesh.
  void Settle(OpenCLContext& context, bool claimed, const KernelParameters& parameters,
    std::vector<cl::Event>& events);

  std::uint64_t CountCovered(WorkDevice& device, std::vector<cl::Event>& events);
  /// Counts the covered voxels of some patches, after Complete.
  std::uint64_t CountCovered(OpenCLContext& context, const std::vector<std::uint32_t>& patches,
    std::vector<cl::Event>& events);
  /// Reads the sums of the counters. covered: whether to find SlabCounts::Covered, which requires
  /// that coverage is bits.
  SlabCounts ReadCounts(WorkDevice& device, bool covered, std::vector<cl::Event>& events);

  /// Whether the slab fits the CPU kernel, which uses float positions and 31-bit indices.
  bool FitsLanes() const;

  /// Sets the output extent in the parameters of a launch.
  void SetParameters(KernelParameters& parameters) const;

  const Extent& GetExtent() const { return this->SlabExtent; }
  const cl::Buffer& GetArray(std::size_t index) const { return this->Arrays[index]; }
  const cl::Buffer& GetCoverage() const { return this->Coverage; }
  bool HasCoverageBits() const { return this->BitsUsed; }
  /// The buffer that resampling kernels write: bits or bytes.
  const cl::Buffer& GetCoverageTarget() const
  {
    return this->BitsUsed ? this->CoverageBits : this->Coverage;
  }
  const LargeCellList& GetLargeCells() const { return this->LargeCells; }
  const SectionCounters& GetCounters() const { return this->Counters; }
  SectionCounters& GetCounters() { return this->Counters; }

  /// Begins to copy a part of the finished slab to the memory of the request, in a separate queue.
  void Read(const cl::CommandQueue& queue, const DeformRequest& request, const Extent& part);
  /// Leaves the finished slab, which must be the whole output, on the device. The returned outputs
  /// must be copied to the host before Bind() or PrepareUpdate() is called. queue: for these
  /// copies. parts: for each array, then for the coverage, the extent in which the memory of the
  /// request does not have the current values.
  std::vector<std::shared_ptr<DeviceOutput>> KeepOnDevice(const cl::CommandQueue& queue,
    const DeformRequest& request, const std::vector<VolumeArray>& arrays,
    const std::vector<Extent>& parts) const;
  /// Waits until the slab is in the memory of the request. Throws cl::Error if a copy failed.
  void FinishReading() { this->Reads.Check(); }
  /// Waits for all commands, also after a failure, and releases the memory of the request. Does not
  /// throw.
  void Finish();

  std::uint64_t GetMemory() const;

private:
  void BindArrays(
    OpenCLContext& context, const DeformRequest& request, const std::vector<VolumeArray>& arrays);
  void SendPatches(OpenCLContext& context, const std::vector<std::uint32_t>& patches);
  void ExpandCoverage(OpenCLContext& context, bool isUpdate, std::vector<cl::Event>& events);
  std::uint64_t GetOffset(const DeformRequest& request) const;

  cl::CommandQueue Queue;
  Extent SlabExtent{ { 0, -1, 0, -1, 0, -1 } };
  Extent WholeExtent{ { 0, -1, 0, -1, 0, -1 } }; // of the output
  std::vector<cl::Buffer> Arrays;
  std::vector<std::size_t> TupleSizes;
  cl::Buffer Coverage;
  cl::Buffer CoverageBits;
  bool BitsUsed = false;
  OutputWinners Winners;
  cl::Buffer PatchList; // patches that an update clears
  std::size_t NumberOfListedPatches = 0;
  SectionCounters Counters;
  LargeCellList LargeCells; // at most 1 MB; GetMemory() does not count it
  std::uint64_t NumberOfVoxels = 0;
  PendingCopies Reads; // last member: copies end before buffers are deleted
};

} // namespace deformvolume

#endif
