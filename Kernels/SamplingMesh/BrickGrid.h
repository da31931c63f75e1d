// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBrickGrid_h
#define DeformVolumeBrickGrid_h

#include "Extent.h"
#include "KernelParameters.h"
#include "VoxelGrid.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace deformvolume
{

/// The bits that a section of a brick is run by, from the lowest one on (DEFORMVOLUME_BRICK_BITS).
inline std::uint32_t MakeSectionBits(std::uint32_t span, bool upperY, bool upperZ)
{
  return 1U << span | (upperY ? 2U : 1U) << DEFORMVOLUME_SPANS |
    (upperZ ? 2U : 1U) << (DEFORMVOLUME_SPANS + 2);
}

/// The bricks of cells that a voxel grid is worked on in, or the sub-bricks of these. Their
/// numbers grow with x, then y, then z.
struct BrickGrid
{
  BrickGrid() = default;
  explicit BrickGrid(const VoxelGrid& voxelGrid);

  std::array<int, 3> Size{ { 0, 0, 0 } };   // vertices of the voxel grid
  std::array<int, 3> Origin{ { 0, 0, 0 } }; // local index of the first cell of the first brick
  std::array<int, 3> Count{ { 0, 0, 0 } };  // bricks on each axis
  std::array<int, 3> Cells{ { DEFORMVOLUME_BRICK_X, DEFORMVOLUME_BRICK_Y,
    DEFORMVOLUME_BRICK_Z } }; // of a brick
  /// How far a brick looks beyond its vertices: the fill rule asks the cells round a vertex.
  static constexpr int LeastHalo = 1;
  /// Or where there is a smooth cut: it moves vertices by others that are so many voxels away
  /// (CutPositions.cl). The cells round a vertex add nothing: what a cut changes of those that are
  /// in another brick, that brick has changed, and the vertex lies in both.
  static constexpr int HaloOfCuts = 2;
  int Halo = LeastHalo;

  std::size_t GetNumberOfBricks() const
  {
    return static_cast<std::size_t>(this->Count[0]) * static_cast<std::size_t>(this->Count[1]) *
      static_cast<std::size_t>(this->Count[2]);
  }

  /// So many bricks, each above the one before, are worked on one after the other where all are:
  /// the positions of vertices between them are found once.
  static constexpr int BricksInTurn = 2;
  /// Appends the bricks of some layers of cells, whole ones (DEFORMVOLUME_BRICK_BITS), in that
  /// order.
  void AppendBricks(int layersBegin, int layersEnd, std::vector<std::uint32_t>& bricks) const;

  /// What bricks consist of, 16 x 8 x 8 cells each.
  BrickGrid GetSubBricks() const;
  /// The brick that a sub-brick is of, and the bits of its section, from the lowest one on
  /// (DEFORMVOLUME_BRICK_BITS).
  std::pair<std::size_t, std::uint32_t> GetBrick(
    const BrickGrid& subBricks, std::size_t subBrick) const;

  /// Local indices of the vertices of a brick, and so many beyond them on each side, within the
  /// voxel grid.
  Extent GetVertices(std::size_t brick, int halo) const;
};

} // namespace deformvolume

#endif
