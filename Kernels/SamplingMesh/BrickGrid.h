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

/// Returns the bits that select one section of a brick in a kernel launch, starting at bit 0. In a
/// list of bricks they are shifted by DEFORMVOLUME_BRICK_BITS.
inline std::uint32_t MakeSectionBits(std::uint32_t span, bool upperY, bool upperZ)
{
  return 1U << span | (upperY ? 2U : 1U) << DEFORMVOLUME_SPANS |
    (upperZ ? 2U : 1U) << (DEFORMVOLUME_SPANS + 2);
}

/// The division of the cells of a voxel grid into bricks, or into sub-bricks. Bricks are numbered
/// along x, then y, then z.
struct BrickGrid
{
  BrickGrid() = default;
  explicit BrickGrid(const VoxelGrid& voxelGrid);

  std::array<int, 3> Size{ { 0, 0, 0 } };   // vertices of the voxel grid
  std::array<int, 3> Origin{ { 0, 0, 0 } }; // local index of the first cell of the first brick
  std::array<int, 3> Count{ { 0, 0, 0 } };  // bricks on each axis
  std::array<int, 3> Cells{ { DEFORMVOLUME_BRICK_X, DEFORMVOLUME_BRICK_Y,
    DEFORMVOLUME_BRICK_Z } }; // cells of a brick on each axis
  /// Halo without smooth cuts: the fill rule uses the cells around a vertex.
  static constexpr int LeastHalo = 1;
  /// Halo with smooth cuts: a copy of a vertex is extrapolated from vertices up to two voxels away
  /// (CutPositions.cl). The cells around a vertex do not enlarge the halo. If such a cell lies in
  /// another brick, the vertex lies in both bricks, and a change of the cell changes both.
  static constexpr int HaloOfCuts = 2;
  int Halo = LeastHalo;

  std::size_t GetNumberOfBricks() const
  {
    return static_cast<std::size_t>(this->Count[0]) * static_cast<std::size_t>(this->Count[1]) *
      static_cast<std::size_t>(this->Count[2]);
  }

  /// Returns the number of a brick. x, y, z: its index on each axis.
  std::size_t GetNumber(int x, int y, int z) const
  {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(this->Count[1]) +
             static_cast<std::size_t>(y)) *
      static_cast<std::size_t>(this->Count[0]) +
      static_cast<std::size_t>(x);
  }

  /// Number of bricks above one another that AppendBricks() lists in succession. A work-item that
  /// processes them in succession computes the positions of the vertices between them only once.
  static constexpr int BricksInTurn = 2;
  /// Appends the bricks that contain the cell layers from layersBegin to layersEnd - 1. All
  /// sections of each brick are selected (DEFORMVOLUME_BRICK_BITS).
  void AppendBricks(int layersBegin, int layersEnd, std::vector<std::uint32_t>& bricks) const;

  /// Returns the division into sub-bricks of 16 x 8 x 8 cells.
  BrickGrid GetSubBricks() const;
  /// Returns the brick that contains a sub-brick, and the bits of the section that contains the
  /// sub-brick (MakeSectionBits()).
  std::pair<std::size_t, std::uint32_t> GetBrick(
    const BrickGrid& subBricks, std::size_t subBrick) const;

  /// Returns the local indices of the vertices of a brick and of `halo` vertices beyond each side,
  /// clipped to the voxel grid.
  Extent GetVertices(std::size_t brick, int halo) const;
};

} // namespace deformvolume

#endif
