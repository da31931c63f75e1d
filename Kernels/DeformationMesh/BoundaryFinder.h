// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBoundaryFinder_h
#define DeformVolumeBoundaryFinder_h

#include "Extent.h"
#include "MeshBoundary.h"
#include "ParallelFor.h"
#include "TetrahedronRaster.h"

#include <glm/vec3.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

using Triangle = std::array<glm::dvec3, 3>;

// Distance, in voxels, by which a tetrahedron may extend into a cell because its nodes are rounded
// to 1/256 voxel.
constexpr double BoundaryTolerance = 1.0 / 64.0;
// Depth inside the volume, in voxels, up to which a face counts as on the border of the volume.
// Voxels on the border are still linked to the mesh then.
constexpr double BorderTolerance = 1.0 / 512.0;

/// A set of cells in a box, with one bit per cell.
class CellSet
{
public:
  // cells: the box, as structured indices of the first and last cell on each axis.
  explicit CellSet(const Extent& cells)
    : Cells(cells)
    , Words(static_cast<std::size_t>((GetNumberOfPoints(cells) + 63) / 64))
  {
  }

  const Extent& GetCells() const { return this->Cells; }
  bool IsEmpty() const
  {
    return std::all_of(this->Words.begin(), this->Words.end(),
      [](const std::atomic<std::uint64_t>& word) { return word == 0; });
  }

  // Thread-safe.
  void Add(std::int64_t x, std::int64_t y, std::int64_t z)
  {
    const std::int64_t number = this->GetRow(y, z) + x - this->Cells[0];
    this->Words[static_cast<std::size_t>(number / 64)].fetch_or(
      std::uint64_t{ 1 } << (number % 64), std::memory_order_relaxed);
  }

  // Whether the set has any cell of a box. The box must lie within GetCells().
  bool HasAny(const VoxelBox& box) const
  {
    for (std::int64_t z = box.Min[2]; z <= box.Max[2]; ++z)
    {
      for (std::int64_t y = box.Min[1]; y <= box.Max[1]; ++y)
      {
        const std::int64_t row = this->GetRow(y, z) - this->Cells[0];
        const std::int64_t end = row + box.Max[0] + 1;
        for (std::int64_t cell = row + box.Min[0]; cell < end;)
        {
          const std::uint64_t word =
            this->Words[static_cast<std::size_t>(cell / 64)] >> (cell % 64);
          const std::int64_t left = std::min(end - cell, 64 - cell % 64);
          if (left == 64 ? word != 0 : (word & ((std::uint64_t{ 1 } << left) - 1)) != 0)
          {
            return true;
          }
          cell += left;
        }
      }
    }
    return false;
  }

  // Calls take(x, y, z) for all cells of the set, in ascending order.
  template <typename Take>
  void ForEach(Take&& take) const
  {
    const std::int64_t size[2] = { GetSize(this->Cells, 0), GetSize(this->Cells, 1) };
    for (std::size_t i = 0; i < this->Words.size(); ++i)
    {
      const std::uint64_t word = this->Words[i];
      for (int bit = 0; word != 0 && bit < 64; ++bit)
      {
        if (word >> bit & 1)
        {
          const std::int64_t number = 64 * static_cast<std::int64_t>(i) + bit;
          take(this->Cells[0] + number % size[0], this->Cells[2] + number / size[0] % size[1],
            this->Cells[4] + number / size[0] / size[1]);
        }
      }
    }
  }

private:
  std::int64_t GetRow(std::int64_t y, std::int64_t z) const
  {
    return ((z - this->Cells[4]) * GetSize(this->Cells, 1) + y - this->Cells[2]) *
      GetSize(this->Cells, 0);
  }

  Extent Cells;
  std::vector<std::atomic<std::uint64_t>> Words;
};

/// Finds the cells that the faces of a boundary cross, and collects the pieces that meet these
/// cells or their neighbors.
class BoundaryFinder
{
public:
  /// part, whole: as in FindMeshBoundary().
  BoundaryFinder(const Extent& part, const Extent& whole);

  /// Finds the cells that faces cross. Returns whether any of these cells is in the part or next to
  /// it. tolerance: how far a face must extend into a cell, in voxels; 0: it is enough to touch the
  /// cell.
  bool Cross(const std::vector<Triangle>& faces, double tolerance);

  /// Calls take(x, y, z) for the crossed cells and their neighbors.
  template <typename Take>
  void ForEachNear(Take&& take) const
  {
    this->Near.ForEach(take);
  }

  /// Makes the boundary. Calls make(number, add) in parallel for numbers 0 to numbers - 1.
  /// make(number, add) must call add(piece) for its pieces, which may have either orientation. The
  /// boundary has the pieces that meet crossed cells or their neighbors, in the order of the
  /// numbers.
  template <typename Make>
  MeshBoundary Collect(std::size_t numbers, Make&& make) const
  {
    MeshBoundary boundary;
    boundary.Pieces = CollectItems<MeshBoundary::Piece>(numbers, 4096,
      [&](std::size_t i, std::vector<MeshBoundary::Piece>& pieces)
      { make(i, [&](const MeshBoundary::Piece& piece) { this->Add(piece, pieces); }); });
    this->ListCells(boundary);
    return boundary;
  }

private:
  /// Appends a piece if it meets cells of Near. A large piece is divided, and each part that meets
  /// cells of Near is appended.
  void Add(const MeshBoundary::Piece& piece, std::vector<MeshBoundary::Piece>& pieces) const;
  void ListCells(MeshBoundary& boundary) const;

  Extent Whole;
  Extent Cells;
  CellSet Crossed;
  CellSet Near;
};

} // namespace deformvolume

#endif
