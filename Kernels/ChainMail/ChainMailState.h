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

/// A block, and the task of the kernel Propagate there.
struct BlockTask
{
  std::uint32_t Block;
  std::uint32_t Task;
};

/// The task of a handle in a step.
struct HandleTask
{
  std::array<std::int32_t, 3> Target;
  std::int32_t Flags; // 0: the handle is skipped
};

using SharedNumbers = std::array<std::uint32_t, DEFORMVOLUME_SHARED>;

/// The voxels of a ChainMailModel on the device, and the launches of its kernels.
class ChainMailState
{
public:
  /// device: must outlive this object.
  ChainMailState(
    WorkDevice& device, const ChainMailBlocks& blocks, const std::array<double, 9>& indexToWorld);

  /// Returns the memory that such a volume needs on the device, in bytes, including the output.
  static std::uint64_t GetNeededMemory(const ChainMailBlocks& blocks);
  std::uint64_t GetMemory() const;

  /// The largest number of blocks in a launch. It is small, as a step can be aborted only between
  /// launches.
  static constexpr std::size_t AtOnce = 1024;

  /// Set a callback that is called between launches; Aborted is thrown if it returns false. Null:
  /// no callback. Save() and Propagate() are never aborted in between.
  void SetProgress(const std::function<bool()>& progress) { this->Progress = progress; }

  /// Calls the callback, and throws Aborted if it returns false.
  void Continue() const;

  void SetLimits(const ChainMailLimits& limits);
  /// Change one byte of each voxel. The bytes are in the order of blocks.
  void ChangeLinks(const std::function<void(unsigned char*)>& change);
  void ChangeMaterials(const std::function<void(unsigned char*)>& change);

  ///@{
  /// Set where the output goes: host memory, or vectors on this device, one per voxel.
  void SetOutput(float* output);
  void SetOutput(const std::shared_ptr<DeviceVectors>& output);
  ///@}
  bool HasOutput() const { return this->Output.IsSet(); }
  /// Waits until the output is written, and copies rows of blocks, in structured indices, to the
  /// host memory.
  void ReadOutput(const std::vector<Extent>& changes);
  /// Marks rows of blocks as changed in the output vectors.
  void MarkChanges(const std::vector<Extent>& changes);

  /// The following functions run a kernel on blocks.
  void Save(const std::vector<std::uint32_t>& list);
  /// isEnd: whether `saved` must become the output again, as the step ends.
  void Restore(const std::vector<std::uint32_t>& list, bool isEnd = false);
  void ClearFlags(const std::vector<std::uint32_t>& list);
  void ResetDisplacements(const std::vector<std::uint32_t>& list);
  void WriteOutput(const std::vector<std::uint32_t>& list);
  void Check(const std::vector<std::uint32_t>& list);
  ///@{
  /// Read or write the displacements of blocks, in ascending order.
  void ReadBlocks(
    const std::vector<std::uint32_t>& list, std::vector<ChainMailSnapshot::Block>& values);
  void WriteBlocks(const std::vector<std::uint32_t>& list,
    const std::vector<std::shared_ptr<const ChainMailSnapshot::Block>>& values);
  ///@}
  /// No two blocks may share a face. results: the result of the kernel for each block.
  void Propagate(const std::vector<BlockTask>& list, std::vector<std::uint32_t>& results);
  /// Performs one relaxation sweep, and sets results to 1 for blocks that changed.
  void Relax(const std::vector<std::uint32_t>& list, float elasticity, int threshold,
    std::vector<std::uint32_t>& results);
  /// moved: for each block, the number of voxels whose displacement differs from the saved one.
  void Finish(const std::vector<std::uint32_t>& list, std::vector<std::uint32_t>& moved);

  /// counts: the number of voxels that each handle holds.
  void Hold(const std::vector<HeldVoxel>& voxels, const std::vector<HandleTask>& handles,
    std::vector<std::uint32_t>& counts);

  /// Returns the shared numbers, and resets them to 0.
  SharedNumbers TakeShared();

private:
  using Setter = std::function<void(std::size_t begin, std::size_t count)>;

  void Launch(const cl::Kernel& kernel, std::size_t groups);
  void ForParts(const std::vector<BlockTask>& list, const Setter& launch, bool canStop);
  void ForParts(const std::vector<std::uint32_t>& list, const Setter& launch, bool canStop = true);
  void Run(const cl::Kernel& kernel, const std::vector<std::uint32_t>& list, bool canStop = true);
  /// Does what Run does, and reads the result of the kernel for each block.
  template <typename Task>
  void RunAndRead(const cl::Kernel& kernel, const std::vector<Task>& list,
    std::vector<std::uint32_t>& results, bool canStop = true);
  void ChangeBytes(const cl::Buffer& buffer, const std::function<void(unsigned char*)>& change);

  WorkDevice& Device;
  ChainMailBlocks Blocks;
  ChainMailGrid Grid;
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
