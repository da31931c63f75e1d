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

/// The parts of quadratic and Lagrange cells. Keeps those of each type, number of points and
/// degree.
class DEFORMVOLUME_EXPORT HigherOrderCells
{
public:
  /// Whether a type is that of a three-dimensional quadratic or Lagrange cell.
  static bool Contain(int cellType);

  /// Whether a type is that of a three-dimensional Bezier cell. The points of these control the
  /// shape and do not lie on it.
  static bool IsBezier(int cellType);

  /// The parts of a cell of such a type with so many points. degrees: of a Lagrange cell along its
  /// three axes; null: one degree, which follows from the number of points. Empty where a cell of
  /// that type and degree does not have so many points. Valid as long as this object.
  const CellParts& GetParts(
    int cellType, std::int64_t numberOfPoints, const std::array<int, 3>* degrees);

  /// The edges of a quadratic type of fixed shape that have a node in their middle: two corners,
  /// then that node, by positions in the cell's list of points.
  static const std::vector<std::array<int, 3>>& GetMidSides(int cellType);

private:
  using Key = std::pair<std::pair<int, std::int64_t>, std::array<int, 3>>;
  std::map<Key, CellParts> Known;
};

} // namespace deformvolume

#endif
