// SPDX-License-Identifier: BSD-3-Clause
#include "DeformedBounds.h"

#include "BarycentricMap.h"
#include "FiveTetrahedra.h"
#include "ParallelFor.h"
#include "TetrahedronClipping.h"

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace deformvolume
{

namespace
{

// Calls body(item, bounds) in parallel for items 0 to count - 1, and returns the union of the
// bounds.
template <typename Body>
IndexBounds ComputeInParallel(std::int64_t count, Body&& body)
{
  const std::int64_t blocks = std::min<std::int64_t>(count, 64);
  std::vector<IndexBounds> bounds(blocks);
  ParallelForItems(blocks, 1,
    [&](std::int64_t block)
    {
      IndexBounds found;
      for (std::int64_t i = count * block / blocks; i < count * (block + 1) / blocks; ++i)
      {
        body(i, found);
      }
      bounds[block] = found;
    });
  IndexBounds all;
  for (const IndexBounds& found : bounds)
  {
    all.Add(found);
  }
  return all;
}

// Distance from the field, in cells of the field, up to which a voxel counts as inside. Larger than
// the rounding error of the device.
constexpr double BoundsTolerance = 2.0 * FieldTolerance;
// Distance up to which a position counts as on a voxel, or on a point of the field.
constexpr double OnPoint = 1e-6;

bool IsInvertible(const FieldTransform& transform)
{
  const glm::dmat3& inverse = transform.Inverse;
  return IsFinite(inverse[0]) && IsFinite(inverse[1]) && IsFinite(inverse[2]);
}

// Whether the voxels lie on the points of the field.
bool IsOnGrid(const FieldTransform& transform)
{
  bool identity = true;
  for (int column = 0; column < 3; ++column)
  {
    const double offset = transform.Offset[column];
    identity = identity && std::abs(offset - std::round(offset)) < OnPoint;
    for (int row = 0; row < 3; ++row)
    {
      identity =
        identity && std::abs(transform.Matrix[column][row] - (row == column ? 1.0 : 0.0)) < 1e-9;
    }
  }
  return identity;
}

// Returns the bounding box of a transformed box. center: the transformed center of the box.
IndexBounds Surround(const glm::dvec3& center, const glm::dmat3& matrix, const IndexBounds& box)
{
  const glm::dvec3 half = 0.5 * (box.Max - box.Min);
  const glm::dvec3 extended =
    glm::abs(matrix[0]) * half.x + glm::abs(matrix[1]) * half.y + glm::abs(matrix[2]) * half.z;
  IndexBounds bounds;
  bounds.Add(center - extended);
  bounds.Add(center + extended);
  return bounds;
}

// Shrinks a box to the voxels that it contains. Returns false if it contains none.
bool ShrinkToVoxels(IndexBounds& box)
{
  box.Min = glm::ceil(box.Min - OnPoint);
  box.Max = glm::floor(box.Max + OnPoint);
  return box.Min.x <= box.Max.x && box.Min.y <= box.Max.y && box.Min.z <= box.Max.z;
}

// Returns the bounds, at rest, of the part of the volume that the field covers.
IndexBounds GetCoveredBox(
  const DisplacementField& field, const FieldTransform& geometry, const IndexBounds& box)
{
  if (field.Extrapolate || !IsInvertible(geometry))
  {
    return box;
  }
  const glm::dvec3 last = geometry.Last;
  std::vector<glm::dvec3> corners;
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::dvec3 upper(
      DEFORMVOLUME_OFFSET_X(corner), DEFORMVOLUME_OFFSET_Y(corner), DEFORMVOLUME_OFFSET_Z(corner));
    corners.push_back(
      geometry.ToIndex(upper * last + (2.0 * upper - 1.0) * glm::dvec3(BoundsTolerance)));
  }
  IndexBounds bounds;
  for (const auto& tetrahedron : FiveTetrahedra)
  {
    std::array<MovedPoint, 4> nodes;
    for (int node = 0; node < 4; ++node)
    {
      nodes[node].Rest = corners[tetrahedron[node]];
      nodes[node].Moved = nodes[node].Rest;
    }
    BarycentricMap map;
    if (map.SetTetrahedron(
          { { tetrahedron[0], tetrahedron[1], tetrahedron[2], tetrahedron[3] } }, corners))
    {
      AddClippedTetrahedron(nodes, map, box, bounds);
    }
  }
  return bounds;
}

// Whether the field ends within the volume, between voxels. The deformed volume then ends at the
// border of the field.
bool EndsBetweenVoxels(
  const VoxelGrid& voxelGrid, const DisplacementField& field, const FieldTransform& geometry)
{
  return !field.Extrapolate && IsInvertible(geometry) && !IsOnGrid(geometry) &&
    !HoldsBox(field, GetBox(voxelGrid), BoundsTolerance);
}

// Returns the displacement at a position: interpolated trilinearly within the field, and faded
// outside it.
glm::dvec3 Interpolate(const DisplacementField& field, const glm::dvec3& position)
{
  const glm::dvec3 last(field.Dimensions[0] - 1, field.Dimensions[1] - 1, field.Dimensions[2] - 1);
  const glm::dvec3 inside = glm::clamp(position, glm::dvec3(0.0), last);
  const glm::dvec3 nearest = glm::round(inside);
  const auto isOnPoint = glm::lessThan(glm::abs(inside - nearest), glm::dvec3(OnPoint));
  const double weight = GetWeightBeyond(field, position, FieldTolerance);
  return weight > 0.0 ? weight *
      Interpolate(field, glm::mix(inside, nearest, isOnPoint),
        [&](std::int64_t point) { return GetVector(field, point); })
                      : glm::dvec3(0.0);
}

// Computes bounds from the positions of all voxels. Used for fields with at least as many points as
// the volume has voxels, and for fields that fade: bounds from the cells of a fading field would be
// far too large, since a cell has voxels that move and voxels that do not.
IndexBounds ComputeBoundsOfVoxels(
  const VoxelGrid& voxelGrid, const DisplacementField& field, const FieldTransform& geometry)
{
  const Extent& extent = voxelGrid.VertexExtent;
  const OutputTransform transform = GetOutputTransform(voxelGrid);
  return ComputeInParallel(GetSize(extent, 1) * GetSize(extent, 2),
    [&](std::int64_t row, IndexBounds& bounds)
    {
      glm::dvec3 index = GetBox(voxelGrid).Min;
      index.y += static_cast<double>(row % GetSize(extent, 1));
      index.z += static_cast<double>(row / GetSize(extent, 1));
      for (std::int64_t x = 0; x < GetSize(extent, 0); ++x, index.x += 1.0)
      {
        const glm::dvec3 position = geometry.ToField(index);
        if (!field.Extrapolate &&
          (glm::any(glm::lessThan(position, glm::dvec3(-BoundsTolerance))) ||
            glm::any(glm::greaterThan(position, geometry.Last + BoundsTolerance))))
        {
          continue;
        }
        const glm::dvec3 moved = transform.ToOutput(index) + Interpolate(field, position);
        if (IsFinite(moved))
        {
          bounds.Add(moved);
        }
      }
    });
}

// Computes bounds from the cells of the field: each displacement in a cell lies between those of
// its corners.
IndexBounds ComputeBoundsOfCells(
  const VoxelGrid& voxelGrid, const DisplacementField& field, const FieldTransform& geometry)
{
  const IndexBounds box = GetBox(voxelGrid);
  IndexBounds covered = GetCoveredBox(field, geometry, box);
  const bool endsBetween = EndsBetweenVoxels(voxelGrid, field, geometry);
  if (covered.IsEmpty() || (!endsBetween && !ShrinkToVoxels(covered)))
  {
    return IndexBounds();
  }
  // Cells at the border of the field extend to where voxels count as inside or follow the border.
  IndexBounds extended =
    Surround(geometry.ToField(0.5 * (box.Min + box.Max)), geometry.Matrix, box);
  if (!field.Extrapolate)
  {
    extended.Min = glm::dvec3(0.0);
    extended.Max = geometry.Last;
  }
  extended.Min = glm::min(extended.Min, glm::dvec3(0.0)) - BoundsTolerance;
  extended.Max = glm::max(extended.Max, geometry.Last) + BoundsTolerance;

  const OutputTransform transform = GetOutputTransform(voxelGrid);
  std::int64_t cells[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    cells[axis] = std::max(1, field.Dimensions[axis] - 1);
  }
  return ComputeInParallel(cells[0] * cells[1] * cells[2],
    [&](std::int64_t cell, IndexBounds& bounds)
    {
      const std::int64_t index[3] = { cell % cells[0], cell / cells[0] % cells[1],
        cell / (cells[0] * cells[1]) };
      IndexBounds rest = covered;
      if (IsInvertible(geometry))
      {
        IndexBounds cellBox;
        for (int axis = 0; axis < 3; ++axis)
        {
          const double low = static_cast<double>(index[axis]);
          cellBox.Min[axis] = index[axis] == 0 ? extended.Min[axis] : low;
          cellBox.Max[axis] = index[axis] == cells[axis] - 1 ? extended.Max[axis] : low + 1.0;
        }
        rest =
          Surround(geometry.ToIndex(0.5 * (cellBox.Min + cellBox.Max)), geometry.Inverse, cellBox);
        rest.Min = glm::max(rest.Min, covered.Min);
        rest.Max = glm::min(rest.Max, covered.Max);
        if (rest.Min.x > rest.Max.x || rest.Min.y > rest.Max.y || rest.Min.z > rest.Max.z ||
          (!endsBetween && !ShrinkToVoxels(rest)))
        {
          return;
        }
      }
      IndexBounds displacement;
      for (int corner = 0; corner < 8; ++corner)
      {
        std::int64_t point[3];
        for (int axis = 0; axis < 3; ++axis)
        {
          point[axis] =
            std::min<std::int64_t>(index[axis] + (corner >> axis & 1), field.Dimensions[axis] - 1);
        }
        const glm::dvec3 vector = GetVector(
          field, (point[2] * field.Dimensions[1] + point[1]) * field.Dimensions[0] + point[0]);
        if (IsFinite(vector))
        {
          displacement.Add(vector);
        }
      }
      if (!displacement.IsEmpty())
      {
        const IndexBounds outputRest = transform.ToOutput(rest);
        bounds.Add(outputRest.Min + displacement.Min);
        bounds.Add(outputRest.Max + displacement.Max);
      }
    });
}

} // namespace

IndexBounds ComputeDeformedBounds(const VoxelGrid& voxelGrid, const std::vector<VertexLink>& links,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements)
{
  const Extent& extent = voxelGrid.VertexExtent;
  const std::int64_t size = GetSize(extent, 0);
  const std::int64_t rows = size > 0 ? GetSize(extent, 1) * GetSize(extent, 2) : 0;
  const OutputTransform transform = GetOutputTransform(voxelGrid);
  return ComputeInParallel(rows,
    [&](std::int64_t row, IndexBounds& bounds)
    {
      glm::dvec3 index(
        0.0, extent[2] + row % GetSize(extent, 1), extent[4] + row / GetSize(extent, 1));
      for (std::int64_t x = 0; x < size; ++x)
      {
        const VertexLink& link = links[row * size + x];
        if (link.Tetrahedron < 0)
        {
          continue;
        }
        const Tetrahedron& nodes = tetrahedra[link.Tetrahedron];
        glm::dvec3 sum(0.0);
        double last = 1.0;
        for (int node = 0; node < 3; ++node)
        {
          const double weight = link.Weights[node];
          sum += weight * GetVector(displacements, nodes[node]);
          last -= weight;
        }
        sum += last * GetVector(displacements, nodes[3]);
        index.x = static_cast<double>(extent[0] + x);
        const glm::dvec3 moved = transform.ToOutput(index) + sum;
        if (IsFinite(moved))
        {
          bounds.Add(moved);
        }
      }
    });
}

IndexBounds ComputeDeformedBounds(const VoxelGrid& voxelGrid, const DisplacementField& field)
{
  std::int64_t points = 1;
  for (const int dimension : field.Dimensions)
  {
    points *= std::max(0, dimension);
  }
  if (points == 0 || GetNumberOfPoints(voxelGrid.VertexExtent) == 0)
  {
    return IndexBounds();
  }
  const FieldTransform geometry(field);
  // A field on the voxels of the volume may cover only a part of them, and then has fewer points.
  const bool coLocated = IsOnGrid(geometry);
  return coLocated || IsFading(field) ||
      (points >= GetNumberOfPoints(voxelGrid.VertexExtent) &&
        !EndsBetweenVoxels(voxelGrid, field, geometry))
    ? ComputeBoundsOfVoxels(voxelGrid, field, geometry)
    : ComputeBoundsOfCells(voxelGrid, field, geometry);
}

} // namespace deformvolume
