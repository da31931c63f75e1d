// SPDX-License-Identifier: BSD-3-Clause
#include "MeshBoundary.h"

#include "BoundaryFinder.h"
#include "FiveTetrahedra.h"
#include "IndexBounds.h" // for GetVoxelsToField

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

} // namespace

MeshBoundary FindFieldBoundary(
  const Extent& part, const Extent& whole, const DisplacementField& field)
{
  const std::array<int, 3>& size = field.Dimensions;
  if (GetNumberOfCells(part) == 0 || std::min({ size[0], size[1], size[2] }) < 2)
  {
    return MeshBoundary();
  }
  const auto& m = field.IndexToField;
  const glm::dmat3 toField = GetVoxelsToField(field);
  const glm::dmat3 toIndex = glm::inverse(toField);
  if (!(std::abs(glm::determinant(toField)) > 0.0))
  {
    return MeshBoundary();
  }
  const glm::dvec3 offset(m[3], m[7], m[11]);
  const auto toVolume = [&](const glm::dvec3& point) { return toIndex * (point - offset); };

  // Two triangles on each side of the field.
  std::vector<Triangle> faces;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int side = 0; side < 2; ++side)
    {
      std::array<glm::dvec3, 4> corners;
      for (int corner = 0; corner < 4; ++corner)
      {
        glm::dvec3 point;
        point[axis] = side * (size[static_cast<std::size_t>(axis)] - 1);
        point[(axis + 1) % 3] = (corner & 1) * (size[static_cast<std::size_t>((axis + 1) % 3)] - 1);
        point[(axis + 2) % 3] =
          (corner >> 1) * (size[static_cast<std::size_t>((axis + 2) % 3)] - 1);
        corners[static_cast<std::size_t>(corner)] = toVolume(point);
      }
      faces.push_back({ { corners[0], corners[1], corners[2] } });
      faces.push_back({ { corners[3], corners[1], corners[2] } });
    }
  }
  BoundaryFinder finder(part, whole);
  // A side of the field that lies on voxels is no boundary, since cells end there. Kernels treat
  // voxels up to FieldTolerance outside the field as inside.
  const double finest =
    std::min({ glm::length(toIndex[0]), glm::length(toIndex[1]), glm::length(toIndex[2]) });
  if (!finder.Cross(faces, std::min(BorderTolerance, 0.5 * FieldTolerance * finest)))
  {
    return MeshBoundary();
  }

  // A lattice with cells of about the size of a piece. A cell of the lattice is a fraction of a
  // cell of the field, or consists of several such cells.
  glm::dvec3 step; // size of a lattice cell, in steps between points of the field
  glm::i64vec3 cells;
  glm::dvec3 last;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double length = glm::length(toIndex[axis]);
    step[axis] = length > FieldPiece ? 1.0 / std::round(length / FieldPiece)
                                     : std::max(1.0, std::floor(FieldPiece / length));
    last[axis] = size[static_cast<std::size_t>(axis)] - 1;
    cells[axis] =
      std::max<std::int64_t>(1, std::llround(std::ceil(last[axis] / step[axis] - 1e-9)));
  }
  // The lattice cells that meet cells near the boundary.
  std::vector<std::int64_t> numbers;
  finder.ForEachNear(
    [&](std::int64_t x, std::int64_t y, std::int64_t z)
    {
      const glm::dvec3 middle = (toField * (glm::dvec3(x, y, z) + 0.5) + offset) / step;
      const glm::dvec3 margin = (0.5 + BoundaryTolerance) *
        (glm::abs(toField[0]) + glm::abs(toField[1]) + glm::abs(toField[2])) / step;
      const glm::i64vec3 first(
        glm::clamp(glm::floor(middle - margin), glm::dvec3(0.0), glm::dvec3(cells)));
      const glm::i64vec3 end(
        glm::clamp(glm::floor(middle + margin) + 1.0, glm::dvec3(0.0), glm::dvec3(cells)));
      for (std::int64_t k = first.z; k < end.z; ++k)
      {
        for (std::int64_t j = first.y; j < end.y; ++j)
        {
          for (std::int64_t i = first.x; i < end.x; ++i)
          {
            numbers.push_back((k * cells.y + j) * cells.x + i);
          }
        }
      }
    });
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return finder.Collect(numbers.size(),
    [&](std::size_t number, const auto& add)
    {
      static constexpr int split[5][4] = DEFORMVOLUME_FIVE_TETRAHEDRA;
      const std::int64_t i = numbers[number];
      const glm::i64vec3 cell(i % cells.x, i / cells.x % cells.y, i / cells.x / cells.y);
      std::array<glm::dvec3, 8> points;
      for (int vertex = 0; vertex < 8; ++vertex)
      {
        const auto offset = vertex ^ DEFORMVOLUME_MIRROR(cell.x, cell.y, cell.z);
        const glm::i64vec3 corner =
          cell + glm::i64vec3(offset & 1, offset >> 2 & 1, offset >> 1 & 1);
        points[static_cast<std::size_t>(vertex)] = glm::min(glm::dvec3(corner) * step, last);
      }
      for (const auto& tetrahedron : split)
      {
        MeshBoundary::Piece piece;
        piece.Tetrahedron = 0;
        for (std::size_t k = 0; k < 4; ++k)
        {
          const glm::dvec3& point = points[static_cast<std::size_t>(tetrahedron[k])];
          piece.Rest[k] = toVolume(point);
          piece.Weights[k] = { { static_cast<float>(point.x), static_cast<float>(point.y),
            static_cast<float>(point.z), 0.0F } };
        }
        add(piece);
      }
    });
}

} // namespace deformvolume
