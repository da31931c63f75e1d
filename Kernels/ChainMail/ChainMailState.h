// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChainMailState_h
#define DeformVolumeChainMailState_h

#include "ChainMailBlocks.h"
#include "ChainMailHandles.h"
#include "ChainMailLimits.h"
#include "ChainMailParameters.h"
#include "ChainMailSnapshot.h"
#include "DeviceVectors.h"
#include "OutputVectors.h"
#include "WorkDevice.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace deformvolume
{

/// A block, and what the kernel Propagate is to do there.
struct BlockTask
{
  std::uint32_t Block;
  std::uint32_t Task;
};

/// What a step does with a handle.
struct HandleTask
{
  std::array<std::int32_t, 3> Target;
  std::int32_t Flags; // 0: it is left out
};

using SharedNumbers = std::array<std::uint32_t, DEFORMVOLUME_SHARED>;

/// The voxels of a ChainMailModel on the device, and the launches of its kernels.
class ChainMailState
{
public:
  /// device: it stays where it is. workGroupSize: 0: chosen by device.
  ChainMailState(WorkDevice& device, const ChainMailBlocks& blocks,
    const std::array<double, 9>& indexToWorld, std::size_t workGroupSize);

  /// Bytes that such a volume needs on the device, with its output, which may be there already.
  static std::uint64_t GetNeededMemory(const ChainMailBlocks& blocks);
  std::uint64_t GetMemory() const;

  /// Blocks in a launch: so few that an end can be asked for in between.
  static constexpr std::size_t AtOnce = 1024;

  /// Asked between launches whether to go on: throws Aborted where not. Null: always. Only Save()
  /// and Propagate() always do all of their work.
  void SetProgress(const std::function<bool()>& progress) { this->Progress = progress; }

  void Continue() const;

  void SetLimits(const ChainMailLimits& limits);
  /// Changes a byte of all voxels, as they lie in blocks.
  void ChangeLinks(const std::function<void(unsigned char*)>& change);
  void ChangeMaterials(const std::function<void(unsigned char*)>& change);

  ///@{
  /// Where the output goes: memory of the host, or vectors on this device, one a voxel.
  void PlaceOutput(float* output);
  void PlaceOutput(const std::shared_ptr<DeviceVectors>& output);
  ///@}
  bool HasOutput() const { return this->Output.IsPlaced(); }
  /// Brings rows of blocks of the output, in structured indices, to where they are read. It waits
  /// until they are written.
  void ReadOutput(const std::vector<Extent>& changes);
  /// Tells vectors which rows of blocks are others than before.
  void TellOfChanges(const std::vector<Extent>& changes);

  /// Each of these works on blocks.
  void Save(const std::vector<std::uint32_t>& list);
  /// isEnd: whether the output is to be as it was, too.
  void Restore(const std::vector<std::uint32_t>& list, bool isEnd = false);
  void ClearFlags(const std::vector<std::uint32_t>& list);
  void PutToRest(const std::vector<std::uint32_t>& list);
  void WriteOutput(const std::vector<std::uint32_t>& list);
  void Check(const std::vector<std::uint32_t>& list);
  ///@{
  /// The displacements of blocks, ascending.
  void ReadBlocks(
    const std::vector<std::uint32_t>& list, std::vector<ChainMailSnapshot::Block>& values);
  void WriteBlocks(const std::vector<std::uint32_t>& list,
    const std::vector<std::shared_ptr<const ChainMailSnapshot::Block>>& values);
  ///@}
  /// No two of them share a face. results: of each, what the kernel reports.
  void Propagate(const std::vector<BlockTask>& list, std::vector<std::uint32_t>& results);
  /// One sweep. Sets those of results to 1 whose block has changed.
  void Relax(const std::vector<std::uint32_t>& list, float elasticity, int threshold,
    std::vector<std::uint32_t>& results);
  /// moved: of each block, how many of its voxels are not as they were saved.
  void Finish(const std::vector<std::uint32_t>& list, std::vector<std::uint32_t>& moved);

  /// counts: how many voxels each handle has got.
  void Hold(const std::vector<HeldVoxel>& voxels, const std::vector<HandleTask>& handles,
    std::vector<std::uint32_t>& counts);

  /// The numbers that blocks share, which are 0 from then on.
  SharedNumbers TakeShared();

private:
  using Setter = std::function<void(std::size_t begin, std::size_t count)>;

  void Launch(const cl::Kernel& kernel, std::size_t groups);
  void ForParts(const std::vector<BlockTask>& list, const Setter& launch, bool canStop);
  void ForParts(const std::vector<std::uint32_t>& list, const Setter& launch, bool canStop = true);
  void Run(const cl::Kernel& kernel, const std::vector<std::uint32_t>& list, bool canStop = true);
  /// The same, and reads what the kernel reports of each block.
  template <typename Task>
  void RunAndRead(const cl::Kernel& kernel, const std::vector<Task>& list,
    std::vector<std::uint32_t>& results, bool canStop = true);
  void ChangeBytes(const cl::Buffer& buffer, const std::function<void(unsigned char*)>& change);

  WorkDevice& Device;
  ChainMailBlocks Blocks;
  ChainMailGrid Grid;
  std::size_t WorkGroupSize;
  bool Serial;
  cl::Program Program;
  std::function<bool()> Progress;
  cl::Buffer Displacements, Flags, Links, Materials;
  cl::Buffer Limits, Weights, Reciprocals;
  cl::Buffer List, Results, Shared;
  OutputVectors Output;
};

} // namespace deformvolume

#endif
