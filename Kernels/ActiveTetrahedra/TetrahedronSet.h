// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronSet_h
#define DeformVolumeTetrahedronSet_h

#include "CellBricks.h"

#include <array>
#include <cstddef>
#include <vector>

namespace deformvolume
{

/// Tetrahedra of a sampling mesh, for example those that one edit switches off.
struct TetrahedronSet
{
  /// One byte for each cell of a brick: bit i is set if tetrahedron i is in the set. Cell (x, y, z)
  /// of the brick has the index (z * 8 + y) * 8 + x.
  using Block = std::array<unsigned char, CellBricks::Cells>;

  /// Returns the index of a cell in the block of its brick.
  static std::size_t GetIndex(int x, int y, int z)
  {
    return static_cast<std::size_t>((z * CellBricks::Length + y) * CellBricks::Length + x);
  }

  /// The bricks with tetrahedra of the set, in ascending order.
  std::vector<std::size_t> Bricks;
  /// The block of each of these bricks.
  std::vector<Block> Blocks;

  /// Whether the set has no tetrahedra.
  bool IsEmpty() const { return this->Bricks.empty(); }
};

} // namespace deformvolume

#endif
