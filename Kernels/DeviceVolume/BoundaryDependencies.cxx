// SPDX-License-Identifier: BSD-3-Clause
#include "BoundaryDependencies.h"

#include <algorithm>
#include <cmath>

namespace deformvolume
{

BoundaryDependencies FindBoundaryDependencies(
  const MeshBoundary& boundary, bool isField, const Extent& vertices, const BrickGrid& subBricks)
{
  BoundaryDependencies found;
  if (boundary.IsEmpty())
  {
    return found;
  }
  const auto getIndex = [&](int axis, double cell)
  {
    return std::clamp((static_cast<int>(std::clamp(cell, 0.0, GetSize(vertices, axis) - 2.0)) -
                        subBricks.Origin[axis]) /
        subBricks.Cells[axis],
      0, subBricks.Count[axis] - 1);
  };
  std::vector<unsigned char> isNear(subBricks.GetNumberOfBricks());
  for (const std::int64_t cell : boundary.Near)
  {
    const std::int64_t size[2] = { GetSize(vertices, 0) - 1, GetSize(vertices, 1) - 1 };
    isNear[subBricks.GetNumber(getIndex(0, static_cast<double>(cell % size[0])),
      getIndex(1, static_cast<double>(cell / size[0] % size[1])),
      getIndex(2, static_cast<double>(cell / size[0] / size[1])))] = 1;
  }
  found.Tetrahedra.resize(isField ? 0 : isNear.size());
  found.FieldPoints.resize(isField ? isNear.size() : 0, EmptyExtent);
  for (const MeshBoundary::Piece& piece : boundary.Pieces)
  {
    Extent near;
    Extent points;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const auto getEnds = [](const auto& corners, auto k) {
        return std::minmax({ corners[0][k], corners[1][k], corners[2][k], corners[3][k] });
      };
      const auto rest = getEnds(piece.Rest, static_cast<glm::length_t>(axis));
      const int begin = vertices[2 * axis];
      // The box is one cell larger than the piece on each side: nodes are rounded, and a cell
      // beside those that the piece moves may be crossed by the boundary, too. If the piece
      // changes, ChangeTracker::IsChangeInterior() must be false for all of these cells.
      near[2 * axis] = getIndex(static_cast<int>(axis), std::floor(rest.first - begin) - 1.0);
      near[2 * axis + 1] = getIndex(static_cast<int>(axis), std::floor(rest.second - begin) + 1.0);
      const auto indices = getEnds(piece.Weights, axis);
      points[2 * axis] = static_cast<int>(std::floor(indices.first));
      points[2 * axis + 1] = static_cast<int>(std::ceil(indices.second));
    }
    ForEachPoint(near,
      [&](int x, int y, int z)
      {
        const std::size_t subBrick = subBricks.GetNumber(x, y, z);
        if (!isNear[subBrick])
        {
          return;
        }
        if (isField)
        {
          Include(found.FieldPoints[subBrick], points);
          return;
        }
        std::vector<std::int32_t>& list = found.Tetrahedra[subBrick];
        if (list.empty() || list.back() != piece.Tetrahedron)
        {
          list.push_back(piece.Tetrahedron);
        }
      });
  }
  return found;
}

} // namespace deformvolume
