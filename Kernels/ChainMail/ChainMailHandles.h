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
  std::uint32_t Place; // among those of all blocks
  std::uint32_t Handle;
};

/// Throws an Error where a handle lies outside the volume, is moved too far or has a number that is
/// none.
void CheckHandles(const ChainMailBlocks& blocks, const std::vector<ChainMailHandle>& handles);

/// The voxels of handles that were checked, those of the first one first. A voxel belongs to the
/// first handle in reach.
class ChainMailHandles
{
public:
  ChainMailHandles(const ChainMailBlocks& blocks, const std::array<double, 3>& spacing,
    const std::vector<ChainMailHandle>& handles);

  const std::vector<HeldVoxel>& GetVoxels() const { return this->Voxels; }
  /// The blocks that they lie in, in ascending order.
  std::vector<std::uint32_t> GetBlocks() const;
  /// Of a handle, in units.
  const std::array<std::int32_t, 3>& GetTarget(std::size_t handle) const
  {
    return this->Targets[handle];
  }
  std::size_t GetNumberOfHandles() const { return this->Targets.size(); }
  /// Whether a handle has voxels, which do not belong to handles before it.
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
