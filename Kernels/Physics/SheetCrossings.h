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

/// Where a mesh lies, in numbers that cutting can be decided with exactly.
class MeshSteps
{
public:
  /// How many steps its longest side has: predicates are exact for all that lies within the mesh.
  static constexpr std::int64_t Length = TriangleCrossing::LargestBox;

  /// The corners of a box, which is not empty, around the mesh.
  MeshSteps(const glm::dvec3& low, const glm::dvec3& high);

  /// Whether the mesh has a size.
  bool IsValid() const { return this->Scale > 0.0; }

  /// In steps, not rounded.
  glm::dvec3 Get(const glm::dvec3& position) const { return (position - this->Low) * this->Scale; }

private:
  glm::dvec3 Low;
  double Scale;
};

/// Counts how often a sheet crosses segments within a mesh.
class SheetCrossings
{
public:
  /// depth: places near the sheet are known as well as 2^depth parts of the mesh's longest side
  /// can tell them. Throws Error as Sheet does.
  SheetCrossings(const MeshSteps& steps, const std::vector<glm::dvec3>& points,
    const std::vector<Sheet::Triangle>& triangles, int depth);

  /// No triangle is near the mesh.
  bool IsEmpty() const { return this->Crossings.empty(); }

  /// False only where the sheet does not reach a box, which lies within that of the mesh. This and
  /// the next one may not be called where IsEmpty().
  bool MayIntersect(const SnappedBox& box, std::vector<std::size_t>& scratch) const;

  /// Whether the sheet crosses the segment between two points of the mesh an odd number of times.
  /// The points count as moved, see TriangleCrossing: no segment meets an edge of the sheet. So a
  /// closed sheet has an inside and an outside for any points.
  bool IsCrossedOddly(
    const SnappedPoint& p, const SnappedPoint& q, std::vector<std::size_t>& scratch) const;

private:
  /// Counts the cells of a block that triangles reach, of 2^level cells an axis.
  void MarkCells(const SnappedPoint& firstCell, int level, const std::vector<std::size_t>& numbers);
  void SumCells();
  bool HasMarkedCells(const SnappedBox& box) const;
  /// The cell that a coordinate of the mesh lies in; at the upper end it is the last one.
  std::int64_t GetCell(std::int64_t steps) const
  {
    return std::min(this->Cells - 1, steps >> this->CellShift);
  }
  std::size_t GetPlace(std::int64_t x, std::int64_t y, std::int64_t z) const
  {
    return static_cast<std::size_t>((z * (this->Cells + 1) + y) * (this->Cells + 1) + x);
  }

  std::vector<TriangleCrossing> Crossings;
  BoxTree<SnappedBox> Tree;
  std::int64_t Cells;    // an axis
  std::int64_t CellSize; // steps
  int CellShift;         // its logarithm: divisions would take most of the time
  /// Of each corner of a cell: how many marked cells there are below it on all axes.
  std::vector<std::int32_t> Sums;
};

} // namespace deformvolume

#endif
