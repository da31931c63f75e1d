// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeHigherOrderCells_h
#define DeformVolumeHigherOrderCells_h

#include "CellParts.h"
#include "DeformVolumeExport.h"

#include <array>
#include <cstdint>
#include <map>
#include <utility>

namespace deformvolume
{

/// Divides quadratic and Lagrange cells into parts. The parts for each type, number of points and
/// degree are kept.
class DEFORMVOLUME_EXPORT HigherOrderCells
{
public:
  /// Whether a type is a three-dimensional quadratic or Lagrange cell.
  static bool Contain(int cellType);

  /// Whether a type is a three-dimensional Bezier cell. The control points of such a cell do not
  /// lie on its shape.
  static bool IsBezier(int cellType);

  /// Returns the parts of a quadratic or Lagrange cell. degrees: the degrees of a Lagrange cell
  /// along its three axes; null: the same degree on all axes, derived from the number of points.
  /// Empty if a cell of that type and degree does not have this number of points. The reference is
  /// valid as long as this object.
  const CellParts& GetParts(
    int cellType, std::int64_t numberOfPoints, const std::array<int, 3>* degrees);

  /// Returns the edges of a quadratic cell type that have a mid-side node: two corners and the
  /// mid-side node, as indices in the cell's list of points. Empty for all other types.
  static const std::vector<std::array<int, 3>>& GetMidSides(int cellType);

private:
  using Key = std::pair<std::pair<int, std::int64_t>, std::array<int, 3>>;
  std::map<Key, CellParts> Known;
};

} // namespace deformvolume

#endif
