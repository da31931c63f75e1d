// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronSet_h
#define DeformVolumeTetrahedronSet_h

#include "CellBricks.h"

#include <array>
#include <cstddef>
#include <vector>

namespace deformvolume
{

/// Values of the cells, or of the vertices (GetVertexBricks), of some bricks.
template <typename Value>
struct BrickSet
{
  /// One value for each cell of a brick. Cell (x, y, z) of the brick has the index
  /// (z * 8 + y) * 8 + x.
  using Block = std::array<Value, CellBricks::Cells>;

  /// Returns the index of a cell in the block of its brick.
  static std::size_t GetIndex(int x, int y, int z)
  {
    return static_cast<std::size_t>((z * CellBricks::Length + y) * CellBricks::Length + x);
  }

  /// The bricks of the set, in ascending order.
  std::vector<std::size_t> Bricks;
  /// The block of each of these bricks.
  std::vector<Block> Blocks;

  /// Whether the set has no bricks.
  bool IsEmpty() const { return this->Bricks.empty(); }
};

/// Tetrahedra of a sampling mesh, for example those that one edit switches off: bit i of the byte
/// of a cell is set if tetrahedron i is in the set.
using TetrahedronSet = BrickSet<unsigned char>;

} // namespace deformvolume

#endif
