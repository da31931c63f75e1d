// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronSet_h
#define DeformVolumeTetrahedronSet_h

#include "CellBricks.h"

#include <array>
#include <cstddef>
#include <vector>

namespace deformvolume
{

/// Tetrahedra of a sampling mesh: what one edit switches off.
struct TetrahedronSet
{
  /// One byte a cell of a brick, bit i = tetrahedron i is in the set. The byte of cell (x, y, z) of
  /// the brick is number (z * 8 + y) * 8 + x.
  using Block = std::array<unsigned char, CellBricks::Cells>;

  /// The number of a cell in the block of its brick.
  static std::size_t GetPlace(int x, int y, int z)
  {
    return static_cast<std::size_t>((z * CellBricks::Length + y) * CellBricks::Length + x);
  }

  /// Bricks with tetrahedra of the set, in ascending order, and as many blocks.
  std::vector<std::size_t> Bricks;
  /// The block of each of these bricks.
  std::vector<Block> Blocks;

  /// Whether there are no tetrahedra in it.
  bool IsEmpty() const { return this->Bricks.empty(); }
};

} // namespace deformvolume

#endif
