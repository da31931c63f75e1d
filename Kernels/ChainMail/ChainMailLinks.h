// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChainMailLinks_h
#define DeformVolumeChainMailLinks_h

#include "ChainMailBlocks.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Which links and elements are there, by the active tetrahedra.
class ChainMailLinks
{
public:
  /// Sets the active tetrahedra, one byte a cell; null: all are. Returns the blocks with voxels
  /// that they change, in ascending order.
  std::vector<std::uint32_t> Set(const ChainMailBlocks& blocks, const unsigned char* active);

  /// Writes links and elements of blocks to the bytes of all voxels, and keeps all other bits.
  void Write(const ChainMailBlocks& blocks, const std::vector<std::uint32_t>& list,
    unsigned char* bytes) const;

  /// Bytes that are held.
  std::uint64_t GetMemory() const { return this->Active.size(); }

private:
  unsigned char Find(const ChainMailBlocks& blocks, int x, int y, int z) const;

  std::vector<unsigned char> Active; // empty: all are
};

} // namespace deformvolume

#endif
