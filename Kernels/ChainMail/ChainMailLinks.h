// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChainMailLinks_h
#define DeformVolumeChainMailLinks_h

#include "ChainMailBlocks.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Finds from the active tetrahedra which links and elements exist.
class ChainMailLinks
{
public:
  /// Set the active tetrahedra, one byte per cell; null: all are active. Returns the blocks with
  /// voxels that changed, in ascending order.
  std::vector<std::uint32_t> Set(const ChainMailBlocks& blocks, const unsigned char* active);

  /// Writes the links and elements of blocks to the bytes of all voxels, and keeps all other bits.
  void Write(const ChainMailBlocks& blocks, const std::vector<std::uint32_t>& list,
    unsigned char* bytes) const;

  /// Returns the memory on the host, in bytes.
  std::uint64_t GetMemory() const { return this->Active.size(); }

private:
  unsigned char Find(const ChainMailBlocks& blocks, int x, int y, int z) const;

  std::vector<unsigned char> Active; // empty: all are active
};

} // namespace deformvolume

#endif
