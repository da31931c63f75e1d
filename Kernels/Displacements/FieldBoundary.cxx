// SPDX-License-Identifier: BSD-3-Clause
#include "MeshBoundary.h"

#include "BoundaryFinder.h"
#include "FiveTetrahedra.h"
#include "IndexBounds.h" // for FieldTransform

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace deformvolume
{

namespace
{

// Approximate size of a piece on an axis, in cells of the volume. In a piece the field is
// approximated as linear.
constexpr double FieldPiece = 4.0;

// Returns two triangles on each side of the field.
std::vector<Triangle> MakeSides(const FieldTransform& grid)
{
  std::vector<Triangle> sides;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int side = 0; side < 2; ++side)
    {
      std::array<glm::dvec3, 4> corners;
      for (int corner = 0; corner < 4; ++corner)
      {
        glm::dvec3 point;
        point[axis] = side * grid.Last[axis];
        point[(axis + 1) % 3] = (corner & 1) * grid.Last[(axis + 1) % 3];
        point[(axis + 2) % 3] = (corner >> 1) * grid.Last[(axis + 2) % 3];
        corners[static_cast<std::size_t>(corner)] = grid.ToIndex(point);
      }
      sides.push_back({ { corners[0], corners[1], corners[2] } });
      sides.push_back({ { corners[3], corners[1], corners[2] } });
    }
  }
  return sides;
}

// A lattice with cells of about the size of a piece. A cell of the lattice is a fraction of a cell
// of the field, or consists of several such cells.
class PieceLattice
{
public:
  explicit PieceLattice(const FieldTransform& grid)
    : Grid(grid)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const double length = glm::length(grid.Inverse[axis]);
      this->Step[axis] = length > FieldPiece ? 1.0 / std::round(length / FieldPiece)
                                             : std::max(1.0, std::floor(FieldPiece / length));
      this->Cells[axis] = std::max<std::int64_t>(
        1, std::llround(std::ceil(grid.Last[axis] / this->Step[axis] - 1e-9)));
    }
  }

  // Adds the numbers of the lattice cells that meet a cell of the volume.
  void AddNumbers(const glm::dvec3& cellOfVolume, std::vector<std::int64_t>& numbers) const
  {
    const glm::dmat3& toField = this->Grid.Matrix;
    const glm::dvec3 middle = this->Grid.ToField(cellOfVolume + 0.5) / this->Step;
    const glm::dvec3 margin = (0.5 + BoundaryTolerance) *
      (glm::abs(toField[0]) + glm::abs(toField[1]) + glm::abs(toField[2])) / this->Step;
    const glm::dvec3 least(0.0);
    const glm::dvec3 most(this->Cells);
    const glm::i64vec3 first(glm::clamp(glm::floor(middle - margin), least, most));
    const glm::i64vec3 end(glm::clamp(glm::floor(middle + margin) + 1.0, least, most));
    for (std::int64_t k = first.z; k < end.z; ++k)
    {
      for (std::int64_t j = first.y; j < end.y; ++j)
      {
        for (std::int64_t i = first.x; i < end.x; ++i)
        {
          numbers.push_back((k * this->Cells.y + j) * this->Cells.x + i);
        }
      }
    }
  }

  // Calls add with each of the five pieces of a lattice cell.
  template <typename Add>
  void AddPieces(std::int64_t number, const Add& add) const
  {
    const glm::i64vec3 cell(number % this->Cells.x, number / this->Cells.x % this->Cells.y,
      number / this->Cells.x / this->Cells.y);
    std::array<glm::dvec3, 8> points;
    for (int vertex = 0; vertex < 8; ++vertex)
    {
      const auto offset = vertex ^ DEFORMVOLUME_MIRROR(cell.x, cell.y, cell.z);
      const glm::i64vec3 corner = cell +
        glm::i64vec3(DEFORMVOLUME_OFFSET_X(offset), DEFORMVOLUME_OFFSET_Y(offset),
          DEFORMVOLUME_OFFSET_Z(offset));
      points[static_cast<std::size_t>(vertex)] =
        glm::min(glm::dvec3(corner) * this->Step, this->Grid.Last);
    }
    for (const auto& tetrahedron : FiveTetrahedra)
    {
      MeshBoundary::Piece piece;
      piece.Tetrahedron = 0;
      for (std::size_t k = 0; k < 4; ++k)
      {
        const glm::dvec3& point = points[static_cast<std::size_t>(tetrahedron[k])];
        piece.Rest[k] = this->Grid.ToIndex(point);
        piece.Weights[k] = { { static_cast<float>(point.x), static_cast<float>(point.y),
          static_cast<float>(point.z), 0.0F } };
      }
      add(piece);
    }
  }

private:
  const FieldTransform& Grid;
  glm::dvec3 Step; // size of a cell, in steps between points of the field
  glm::i64vec3 Cells;
};

} // namespace

MeshBoundary FindFieldBoundary(
  const Extent& part, const Extent& whole, const DisplacementField& field)
{
  const std::array<int, 3>& size = field.Dimensions;
  if (GetNumberOfCells(part) == 0 || std::min({ size[0], size[1], size[2] }) < 2)
  {
    return MeshBoundary();
  }
  const FieldTransform grid(field);
  if (!(std::abs(glm::determinant(grid.Matrix)) > 0.0))
  {
    return MeshBoundary();
  }
  BoundaryFinder finder(part, whole);
  // A side of the field that lies on voxels is no boundary, since cells end there. Kernels treat
  // voxels up to FieldTolerance outside the field as inside.
  const double finest = std::min(
    { glm::length(grid.Inverse[0]), glm::length(grid.Inverse[1]), glm::length(grid.Inverse[2]) });
  if (!finder.Cross(MakeSides(grid), std::min(BorderTolerance, 0.5 * FieldTolerance * finest)))
  {
    return MeshBoundary();
  }

  const PieceLattice lattice(grid);
  std::vector<std::int64_t> numbers; // of lattice cells that meet cells near the boundary
  finder.ForEachNear([&](std::int64_t x, std::int64_t y, std::int64_t z)
    { lattice.AddNumbers(glm::dvec3(x, y, z), numbers); });
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return finder.Collect(
    numbers.size(), [&](std::size_t i, const auto& add) { lattice.AddPieces(numbers[i], add); });
}

} // namespace deformvolume
