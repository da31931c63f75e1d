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

// Voxels by which a tetrahedron may reach into a cell since its nodes are rounded to 1/256 voxel.
constexpr double BoundaryTolerance = 1.0 / 64.0;
// Voxels by which a face may lie within the volume and count as on its border: voxels there are
// still linked.
constexpr double BorderTolerance = 1.0 / 512.0;

/// A set of cells in a box of them, a bit each.
class CellSet
{
public:
  // cells: structured indices of the first and the last one on each axis.
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

  // May be called on several threads.
  void Add(std::int64_t x, std::int64_t y, std::int64_t z)
  {
    const std::int64_t number = this->GetRow(y, z) + x - this->Cells[0];
    this->Words[static_cast<std::size_t>(number / 64)].fetch_or(
      std::uint64_t{ 1 } << (number % 64), std::memory_order_relaxed);
  }

  // Whether it has any of the cells of a box that lies within its own.
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

  // Calls take(x, y, z) for all cells, in ascending order.
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

/// Finds which cells the faces of a boundary cross, and collects the pieces that meet these.
class BoundaryFinder
{
public:
  /// See FindMeshBoundary.
  BoundaryFinder(const Extent& part, const Extent& whole);

  /// Returns whether any cell is crossed. tolerance: voxels by which a face has to reach into a
  /// cell; 0: cells that it touches are crossed as well.
  bool Cross(const std::vector<Triangle>& faces, double tolerance);

  /// Calls take(x, y, z) for the cells that are crossed and those beside them.
  template <typename Take>
  void ForEachNear(Take&& take) const
  {
    this->Near.ForEach(take);
  }

  /// Makes the boundary of these cells. For numbers of a range, in parallel, make(number, add)
  /// calls add for pieces, oriented either way; those that meet the cells are taken, in the order
  /// of the numbers.
  template <typename Make>
  MeshBoundary Collect(std::size_t numbers, Make&& make) const
  {
    constexpr std::size_t step = 4096;
    std::vector<std::vector<MeshBoundary::Piece>> parts((numbers + step - 1) / step);
    ParallelForParts(numbers, step,
      [&](std::size_t begin, std::size_t end)
      {
        for (std::size_t i = begin; i < end; ++i)
        {
          make(i, [&](const MeshBoundary::Piece& piece) { this->Add(piece, parts[begin / step]); });
        }
      });
    MeshBoundary boundary;
    for (const std::vector<MeshBoundary::Piece>& part : parts)
    {
      boundary.Pieces.insert(boundary.Pieces.end(), part.begin(), part.end());
    }
    this->ListCells(boundary);
    return boundary;
  }

private:
  /// Adds a piece, or of a large one the parts, that meet cells near the boundary.
  void Add(const MeshBoundary::Piece& piece, std::vector<MeshBoundary::Piece>& pieces) const;
  void ListCells(MeshBoundary& boundary) const;

  Extent Whole;
  Extent Cells;
  CellSet Crossed;
  CellSet Near;
};

} // namespace deformvolume

#endif
