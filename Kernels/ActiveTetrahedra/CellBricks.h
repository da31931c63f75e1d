// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCellBricks_h
#define DeformVolumeCellBricks_h

#include "Extent.h"
#include "FiveTetrahedra.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace deformvolume
{

/// Divides the cells of a volume into bricks of 8 x 8 x 8 cells, the unit of work of edits. Bricks
/// are small, so that most cells that an edit does not hit are skipped as whole bricks. Bricks are
/// numbered along x, then y, then z. Local indices count from 0 at the first cell of the volume.
class CellBricks
{
public:
  /// The number of cells of a whole brick on each axis.
  static constexpr int Length = 8;
  /// The number of cells of a whole brick.
  static constexpr std::size_t Cells = 512;

  /// vertices: structured indices of the voxels of the volume.
  explicit CellBricks(const Extent& vertices)
    : Vertices(vertices)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const auto cells =
        static_cast<int>(std::max<std::int64_t>(deformvolume::GetSize(vertices, axis) - 1, 0));
      this->Size[axis] = cells;
      this->Count[axis] = (cells + Length - 1) / Length;
    }
  }

  /// Returns the structured extent of the voxels of the volume.
  const Extent& GetVertices() const { return this->Vertices; }
  /// Returns the number of cells on each axis.
  const std::array<int, 3>& GetSize() const { return this->Size; }

  /// Returns the number of cells of the volume.
  std::size_t GetNumberOfCells() const { return Multiply(this->Size); }
  /// Returns the number of bricks of the volume, including incomplete ones.
  std::size_t GetNumberOfBricks() const { return Multiply(this->Count); }

  /// Returns the brick of a cell, given by local indices.
  std::size_t FindBrick(const std::array<int, 3>& cell) const
  {
    return static_cast<std::size_t>(cell[0] / Length) +
      static_cast<std::size_t>(this->Count[0]) *
      (static_cast<std::size_t>(cell[1] / Length) +
        static_cast<std::size_t>(this->Count[1]) * static_cast<std::size_t>(cell[2] / Length));
  }

  /// Returns the local indices of the cells of a brick.
  Extent GetCells(std::size_t brick) const
  {
    const std::array<std::size_t, 3> index{ { brick % this->Count[0],
      brick / this->Count[0] % this->Count[1], brick / this->Count[0] / this->Count[1] } };
    Extent cells;
    for (int axis = 0; axis < 3; ++axis)
    {
      cells[2 * axis] = static_cast<int>(index[axis]) * Length;
      cells[2 * axis + 1] = std::min(cells[2 * axis] + Length, this->Size[axis]) - 1;
    }
    return cells;
  }

  /// Returns the axes on which the tetrahedra of a cell are mirrored (FiveTetrahedra.h). cell:
  /// local indices.
  int GetMirror(const std::array<int, 3>& cell) const
  {
    return DEFORMVOLUME_MIRROR(
      this->Vertices[0] + cell[0], this->Vertices[2] + cell[1], this->Vertices[4] + cell[2]);
  }

  /// Returns the structured indices of the vertices of a brick.
  Extent GetVertices(std::size_t brick) const
  {
    Extent box = this->GetCells(brick);
    for (int axis = 0; axis < 3; ++axis)
    {
      box[2 * axis] += this->Vertices[2 * axis];
      box[2 * axis + 1] += this->Vertices[2 * axis] + 1;
    }
    return box;
  }

private:
  static std::size_t Multiply(const std::array<int, 3>& numbers)
  {
    return static_cast<std::size_t>(numbers[0]) * static_cast<std::size_t>(numbers[1]) *
      static_cast<std::size_t>(numbers[2]);
  }

  Extent Vertices;
  std::array<int, 3> Size{ { 0, 0, 0 } };
  std::array<int, 3> Count{ { 0, 0, 0 } };
};

} // namespace deformvolume

#endif
