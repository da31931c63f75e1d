// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputSlab_h
#define DeformVolumeOutputSlab_h

#include "DeformRequest.h"
#include "Extent.h"
#include "HostMemory.h"
#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "OutputWinners.h"
#include "VolumeArray.h"
#include "VoxelGrid.h"

#include <memory>
#include <vector>

namespace deformvolume
{

class WorkDevice;

/// What the device holds of the output: a range of planes of all arrays, their coverage, the
/// winners where tetrahedra overlap, and the counters of the bricks of cells.
class OutputSlab
{
public:
  struct Counts
  {
    std::uint64_t Writes = 0;
    std::uint64_t Inverted = 0;
    std::uint64_t Overstretched = 0;
    std::uint64_t Covered = 0; // where coverage is bits, after a pass over all cells
    bool HasLarge = false;     // cells
    /// On the border of the mesh, tetrahedra that cover nothing, where the kernel took them to.
    bool MissingWhereAssumed = false;

    /// Every covered voxel was written once, unless tetrahedra overlap; where the mesh is folded,
    /// voxels on the crease may also be missing.
    bool NeedWinners(std::uint64_t covered) const
    {
      return this->Writes > covered || this->Inverted > 0 || this->Overstretched > 0 ||
        this->MissingWhereAssumed;
    }
  };

  /// Splits an output into slabs that the device can allocate. Throws Error where not even one
  /// plane fits.
  static std::vector<Extent> Split(const Extent& output, const std::vector<VolumeArray>& arrays,
    const VoxelGrid& voxelGrid, std::uint64_t allocationLimit);

  /// Words of 32 that coverage as bits takes.
  static std::uint64_t CountWords(std::uint64_t voxels);
  /// Bytes of a voxel of the request's output that need memory of the device: those of the arrays
  /// and the coverage that are not worked on in place.
  static std::uint64_t GetBytesPerVoxel(const OpenCLContext& context,
    const std::vector<VolumeArray>& arrays, const DeformRequest& request);

  /// Makes room for a slab of the request's output, or uses what is there, or the memory of the
  /// request. Events of launches are added to a list.
  void Place(OpenCLContext& context, const cl::CommandQueue& queue, const Extent& extent,
    const DeformRequest& request, const std::vector<VolumeArray>& arrays,
    const VoxelGrid& voxelGrid, std::size_t numberOfBricks, std::vector<cl::Event>& events);
  /// After that: nothing is covered. Fills the arrays with the background, or leaves that to
  /// Complete where coverage is bits.
  void Clear(OpenCLContext& context, const std::vector<VolumeArray>& arrays, bool coverageBits,
    std::vector<cl::Event>& events);
  /// Where coverage is bits: makes bytes of them, and voxels that are not covered background.
  /// again: where only the patches have changed that PrepareAgain has cleared.
  void Complete(OpenCLContext& context, const std::vector<VolumeArray>& arrays, bool again,
    std::vector<cl::Event>& events);

  /// Whether the last output, of a request for the same extent, is at hand: in the memory of this
  /// request, as far as that is worked on in place, and on the device.
  bool HoldsLastOutput(const OpenCLContext& context, const DeformRequest& request,
    const std::vector<VolumeArray>& arrays) const;
  /// What is made anew of an output (see IncrementalUpdate).
  struct PartToMake
  {
    const std::vector<cl_uint>& Bricks;
    const cl::Buffer& BrickList; // the same on the device, where there are some
    const std::vector<std::uint32_t>& Patches;
    bool WithWinners; // whether winners were chosen in the last output
  };
  /// The same as Place and Clear where the last output is at hand, and the counters are those of
  /// it: clears the patches, the counters of the bricks, and those of work for the passes that
  /// choose winners. Patches that are left keep their winners.
  void PrepareAgain(OpenCLContext& context, const cl::CommandQueue& queue,
    const DeformRequest& request, const std::vector<VolumeArray>& arrays, const PartToMake& part,
    std::vector<cl::Event>& events);

  OutputWinners& GetWinners() { return this->Winners; }
  const OutputWinners& GetWinners() const { return this->Winners; }
  /// The counters are 0 again: a pass that counts is run once more.
  void ClearCounters(OpenCLContext& context, std::vector<cl::Event>& events);
  /// See OutputWinners. parameters: of the mesh.
  void Settle(OpenCLContext& context, bool claimed, const KernelParameters& parameters,
    std::vector<cl::Event>& events);

  /// The list of large cells (DEFORMVOLUME_PIECE), as the launches of a pass leave it.
  struct LargeCell
  {
    std::array<cl_int, 3> Cell; // local index
    cl_int Pieces;
  };
  void ClearLargeCells() const;
  std::vector<LargeCell> ReadLargeCells() const;

  std::uint64_t CountCovered(WorkDevice& device, std::vector<cl::Event>& events);
  /// Of some patches, after Complete.
  std::uint64_t CountCovered(OpenCLContext& context, const std::vector<std::uint32_t>& patches,
    std::vector<cl::Event>& events);
  /// covered: whether Counts.Covered is wanted; known only where coverage is bits.
  Counts ReadCounts(WorkDevice& device, bool covered, std::vector<cl::Event>& events);

  /// Whether the kernel for processors, with positions in float and indices of 31 bits, can write
  /// the slab.
  bool FitsLanes() const;

  /// The bricks with sections of which a counter is not 0, as DEFORMVOLUME_BRICK_BITS says.
  std::vector<cl_uint> FindBricks(int counter);

  /// Puts the output extent into the parameters of a launch.
  void SetParameters(KernelParameters& parameters) const;

  const Extent& GetExtent() const { return this->SlabExtent; }
  const cl::Buffer& GetArray(std::size_t index) const { return this->Arrays[index]; }
  const cl::Buffer& GetCoverage() const { return this->Coverage; }
  bool HasCoverageBits() const { return this->BitsUsed; }
  /// What kernels that resample write: bits, or bytes.
  const cl::Buffer& GetCoverageTarget() const
  {
    return this->BitsUsed ? this->CoverageBits : this->Coverage;
  }
  const cl::Buffer& GetLargeCells() const { return this->LargeCells; }
  const cl::Buffer& GetCounters() const { return this->Counters; }

  /// Begins to copy a part of the slab, which is done, to its place in the request's memory, in a
  /// queue of its own.
  void Read(const cl::CommandQueue& queue, const DeformRequest& request, const Extent& part);
  /// Leaves the slab, which is done and is the whole output, where it is. It has to be brought to
  /// the host before another one is placed here or made of it. The queue is for that. parts: of
  /// each array, and of the coverage, what the request's memory has not.
  std::vector<std::shared_ptr<DeviceOutput>> Leave(const cl::CommandQueue& queue,
    const DeformRequest& request, const std::vector<VolumeArray>& arrays,
    const std::vector<Extent>& parts) const;
  /// Waits until the slab is in the request's memory. Throws cl::Error where it did not get there.
  void FinishReading() { this->Reads.Check(); }
  /// Waits, whatever has happened, and lets go of the request's memory. Throws nothing.
  void Finish();

  std::uint64_t GetMemory() const;

private:
  void PlaceArrays(
    OpenCLContext& context, const DeformRequest& request, const std::vector<VolumeArray>& arrays);
  void SendPatches(OpenCLContext& context, const std::vector<std::uint32_t>& patches);
  void ClearSections(
    OpenCLContext& context, const PartToMake& part, std::vector<cl::Event>& events);
  void ExpandCoverage(OpenCLContext& context, bool again, std::vector<cl::Event>& events);
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
  cl::Buffer PatchList; // those that an update clears
  std::size_t NumberOfListedPatches = 0;
  cl::Buffer Counters;
  cl::Buffer Parts;   // partial sums of these
  cl::Buffer Summary; // of them
  cl::Buffer
    LargeCells; // at most a megabyte, which GetMemory leaves out as it does all lists of work
  std::size_t MostLargeCells = 0;
  std::size_t NumberOfSections = 0; // of bricks
  std::uint64_t NumberOfVoxels = 0;
  PendingCopies Reads; // last: they end before the buffers do
};

} // namespace deformvolume

#endif
