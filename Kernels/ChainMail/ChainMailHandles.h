// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChainMailHandles_h
#define DeformVolumeChainMailHandles_h

#include "ChainMailBlocks.h"
#include "ChainMailTypes.h"

#include <array>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A voxel that a handle holds.
struct HeldVoxel
{
  std::uint32_t Index; // index in the arrays of the kernels (ChainMailBlocks::GetVoxelIndex)
  std::uint32_t Handle;
};

/// Throws an Error if a handle lies outside the volume or is moved too far, if one of its
/// coordinates is not finite, or if its radius is negative or not finite.
void CheckHandles(const ChainMailBlocks& blocks, const std::vector<ChainMailHandle>& handles);

/// The voxels of handles that CheckHandles accepted. A voxel within the radius of several handles
/// belongs to the first of these handles. The voxels are sorted by index.
class ChainMailHandles
{
public:
  ChainMailHandles(const ChainMailBlocks& blocks, const std::array<double, 3>& spacing,
    const std::vector<ChainMailHandle>& handles);

  const std::vector<HeldVoxel>& GetVoxels() const { return this->Voxels; }
  /// Returns the blocks that contain these voxels, in ascending order.
  std::vector<std::uint32_t> GetBlocks() const;
  /// Returns the displacement of a handle, in units.
  const std::array<std::int32_t, 3>& GetTarget(std::size_t handle) const
  {
    return this->Targets[handle];
  }
  std::size_t GetNumberOfHandles() const { return this->Targets.size(); }
  /// Whether a handle has voxels that do not belong to earlier handles.
  bool HasVoxels(std::size_t handle) const { return this->HasSome[handle]; }

private:
  void Select(const ChainMailBlocks& blocks, const std::array<double, 3>& spacing,
    const ChainMailHandle& handle, std::uint32_t number);

  std::vector<HeldVoxel> Voxels;
  std::vector<std::array<std::int32_t, 3>> Targets;
  std::vector<bool> HasSome;
};

} // namespace deformvolume

#endif
