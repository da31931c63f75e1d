// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSheetCrossings_h
#define DeformVolumeSheetCrossings_h

#include "BoxTree.h"
#include "Sheet.h"
#include "SnappedPoint.h"
#include "TriangleCrossing.h"

#include <glm/vec3.hpp>

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
  /// Throws an Error as Sheet does.
  SheetCrossings(const MeshSteps& steps, const std::vector<glm::dvec3>& points,
    const std::vector<Sheet::Triangle>& triangles);

  /// Whether no triangle is near the mesh.
  bool IsEmpty() const { return this->Crossings.empty(); }

  /// Whether the sheet may intersect a box. If false, it certainly does not.
  bool MayIntersect(const SnappedBox& box) const;

  /// Whether the sheet crosses the segment between two points of the mesh an odd number of times.
  /// The points are perturbed symbolically (see TriangleCrossing), so that no segment meets an edge
  /// of the sheet. Any two points are therefore on definite sides of a closed sheet.
  bool IsCrossedOddly(const SnappedPoint& p, const SnappedPoint& q) const;

private:
  std::vector<TriangleCrossing> Crossings;
  BoxTree<SnappedBox> Tree;
};

} // namespace deformvolume

#endif
