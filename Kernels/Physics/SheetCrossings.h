// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSheetCrossings_h
#define DeformVolumeSheetCrossings_h

#include "BoxTree.h"
#include "Sheet.h"
#include "SnappedPoint.h"
#include "TriangleCrossing.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Maps positions in a mesh to steps, the integer unit in which crossings are decided exactly.
class MeshSteps
{
public:
  /// The number of steps of the longest side of the mesh. Predicates are exact for positions in the
  /// mesh.
  static constexpr std::int64_t Length = TriangleCrossing::LargestBox;

  /// low, high: the bounding box of the mesh, which must not be empty.
  MeshSteps(const glm::dvec3& low, const glm::dvec3& high);

  /// Whether the bounding box has a finite size greater than 0.
  bool IsValid() const { return this->Scale > 0.0; }

  /// Returns a position in steps, not rounded.
  glm::dvec3 Get(const glm::dvec3& position) const { return (position - this->Low) * this->Scale; }

private:
  glm::dvec3 Low;
  double Scale;
};

/// Finds whether a sheet crosses segments within a mesh an odd number of times.
class SheetCrossings
{
public:
  /// depth: a grid of 2^depth cells on each axis of the mesh stores which cells the sheet
  /// intersects. Throws an Error as Sheet does.
  SheetCrossings(const MeshSteps& steps, const std::vector<glm::dvec3>& points,
    const std::vector<Sheet::Triangle>& triangles, int depth);

  /// Whether no triangle is near the mesh.
  bool IsEmpty() const { return this->Crossings.empty(); }

  /// Whether the sheet may intersect a box that lies within the mesh. If false, it certainly does
  /// not. Do not call this function or IsCrossedOddly() if IsEmpty().
  bool MayIntersect(const SnappedBox& box, std::vector<std::size_t>& scratch) const;

  /// Whether the sheet crosses the segment between two points of the mesh an odd number of times.
  /// The points are perturbed symbolically (see TriangleCrossing), so that no segment meets an edge
  /// of the sheet. Any two points are therefore on definite sides of a closed sheet.
  bool IsCrossedOddly(
    const SnappedPoint& p, const SnappedPoint& q, std::vector<std::size_t>& scratch) const;

private:
  /// Marks the cells that triangles intersect, in a cube of 2^level cells on each axis.
  void MarkCells(const SnappedPoint& firstCell, int level, const std::vector<std::size_t>& numbers);
  void SumCells();
  bool HasMarkedCells(const SnappedBox& box) const;
  /// The cell that contains a coordinate in steps. The upper end of the mesh belongs to the last
  /// cell.
  std::int64_t GetCell(std::int64_t steps) const
  {
    return std::min(this->Cells - 1, steps >> this->CellShift);
  }
  std::size_t GetIndex(std::int64_t x, std::int64_t y, std::int64_t z) const
  {
    return static_cast<std::size_t>((z * (this->Cells + 1) + y) * (this->Cells + 1) + x);
  }

  std::vector<TriangleCrossing> Crossings;
  BoxTree<SnappedBox> Tree;
  std::int64_t Cells;    // on each axis
  std::int64_t CellSize; // in steps
  int CellShift;         // log2(CellSize): shifts are faster than divisions
  /// A summed-volume table: for each cell corner, the number of marked cells below it on all axes.
  std::vector<std::int32_t> Sums;
};

} // namespace deformvolume

#endif
