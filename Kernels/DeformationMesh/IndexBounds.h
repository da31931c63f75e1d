// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeIndexBounds_h
#define DeformVolumeIndexBounds_h

#include "DisplacementField.h"
#include "Extent.h"
#include "OutsideVoxels.h" // for GetFadedWeight
#include "VoxelGrid.h"

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace deformvolume
{

/// A bounding box of points with floating-point or integer coordinates.
template <typename Point>
struct BoundingBox
{
  /// The lowest coordinate on each axis.
  Point Min{ 1 };
  /// The highest coordinate on each axis.
  Point Max{ -1 };
  /// Whether nothing has been added.
  bool IsEmpty() const { return this->Min.x > this->Max.x; }
  /// Enlarges the box to contain a point.
  void Add(const Point& point)
  {
    const bool isEmpty = this->IsEmpty();
    this->Min = isEmpty ? point : glm::min(this->Min, point);
    this->Max = isEmpty ? point : glm::max(this->Max, point);
  }
  /// Enlarges the box to contain another box.
  void Add(const BoundingBox& other)
  {
    if (!other.IsEmpty())
    {
      this->Add(other.Min);
      this->Add(other.Max);
    }
  }
  /// Whether the box contains another box. False if it is empty.
  bool Contains(const BoundingBox& other) const
  {
    return !this->IsEmpty() && glm::all(glm::lessThanEqual(this->Min, other.Min)) &&
      glm::all(glm::greaterThanEqual(this->Max, other.Max));
  }
  /// Whether the boxes overlap. False if one of them is empty.
  bool Overlaps(const BoundingBox& other) const
  {
    return !this->IsEmpty() && !other.IsEmpty() &&
      glm::all(glm::lessThanEqual(this->Min, other.Max)) &&
      glm::all(glm::lessThanEqual(other.Min, this->Max));
  }
  /// Returns the length of the longest edge.
  typename Point::value_type GetLength() const
  {
    const Point size = this->Max - this->Min;
    return std::max({ size.x, size.y, size.z });
  }
};

/// A bounding box, in continuous output indices unless stated otherwise.
using IndexBounds = BoundingBox<glm::dvec3>;

/// Returns the bounding box of some points.
template <typename Point, std::size_t Count>
BoundingBox<Point> GetBox(const std::array<Point, Count>& points)
{
  BoundingBox<Point> box;
  for (const Point& point : points)
  {
    box.Add(point);
  }
  return box;
}

/// Largest absolute index of a vertex at rest on each axis of the output. Indices in units of 1/256
/// voxel, and their differences, then fit into 32 bits.
inline constexpr double MaxOutputIndex = 1 << 21;

/// Returns the bounding box of the points of an extent, in continuous indices.
inline IndexBounds GetBox(const Extent& extent)
{
  return { glm::dvec3(extent[0], extent[2], extent[4]),
    glm::dvec3(extent[1], extent[3], extent[5]) };
}

/// Returns the bounding box of the volume, in continuous indices of the volume.
inline IndexBounds GetBox(const VoxelGrid& voxelGrid)
{
  return GetBox(voxelGrid.VertexExtent);
}

/// Returns the bounding box of the eight transformed corners of a box.
inline IndexBounds TransformBox(const glm::dmat4& transform, const IndexBounds& box)
{
  IndexBounds bounds;
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::dvec4 point((corner & 1) != 0 ? box.Max.x : box.Min.x,
      (corner & 2) != 0 ? box.Max.y : box.Min.y, (corner & 4) != 0 ? box.Max.z : box.Min.z, 1.0);
    bounds.Add(glm::dvec3(transform * point));
  }
  return bounds;
}

/// The transform VoxelGrid::ToOutput and its inverse, for points and boxes.
class OutputTransform
{
public:
  /// map: must be invertible.
  explicit OutputTransform(const OutputMap& map)
    : Shift(map.Shift[0], map.Shift[1], map.Shift[2])
    , IsDiagonal(map.IsDiagonal())
  {
    for (int row = 0; row < 3; ++row)
    {
      for (int column = 0; column < 3; ++column)
      {
        this->Matrix[column][row] = map.Get(row, column);
      }
    }
    this->Scale = glm::dvec3(this->Matrix[0].x, this->Matrix[1].y, this->Matrix[2].z);
    if (this->IsDiagonal)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        this->Inverse[axis][axis] = 1.0 / this->Scale[axis];
      }
    }
    else
    {
      this->Inverse = glm::inverse(this->Matrix);
    }
  }

  /// Transforms a continuous index of the volume to one of the output.
  glm::dvec3 ToOutput(const glm::dvec3& index) const
  {
    return (this->IsDiagonal ? this->Scale * index : this->Matrix * index) + this->Shift;
  }
  /// Transforms a continuous index of the output to one of the volume.
  glm::dvec3 ToIndex(const glm::dvec3& position) const
  {
    const glm::dvec3 moved = position - this->Shift;
    return this->IsDiagonal ? moved / this->Scale : this->Inverse * moved;
  }
  /// Returns the bounding box of a transformed box.
  IndexBounds ToOutput(const IndexBounds& box) const
  {
    IndexBounds bounds;
    bounds.Min = bounds.Max = this->Shift;
    for (int axis = 0; axis < 3; ++axis)
    {
      const glm::dvec3 first = this->Matrix[axis] * box.Min[axis];
      const glm::dvec3 last = this->Matrix[axis] * box.Max[axis];
      bounds.Min += glm::min(first, last);
      bounds.Max += glm::max(first, last);
    }
    return bounds;
  }
  /// The linear part. Column k is the step in the output between neighboring voxels on axis k.
  const glm::dmat3& GetMatrix() const { return this->Matrix; }
  /// The inverse of GetMatrix().
  const glm::dmat3& GetInverse() const { return this->Inverse; }
  /// Position of the index (0, 0, 0) of the volume in the output.
  const glm::dvec3& GetShift() const { return this->Shift; }
  /// Converts a tolerance in output voxels, on each axis of the output, to a tolerance in voxels of
  /// the volume on each of its axes. At most 1.
  glm::dvec3 GetTolerance(double ofOutput) const
  {
    const glm::dvec3 sum =
      glm::abs(this->Inverse[0]) + glm::abs(this->Inverse[1]) + glm::abs(this->Inverse[2]);
    return glm::min(glm::dvec3(1.0), sum * ofOutput);
  }

private:
  glm::dmat3 Matrix{ 1.0 };
  glm::dmat3 Inverse{ 1.0 };
  glm::dvec3 Scale{ 1.0 };
  glm::dvec3 Shift;
  bool IsDiagonal;
};

/// Returns the transform of a voxel grid.
inline OutputTransform GetOutputTransform(const VoxelGrid& voxelGrid)
{
  return OutputTransform(voxelGrid.ToOutput);
}

/// Whether all coordinates are finite.
inline bool IsFinite(const glm::dvec3& v)
{
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Returns a vector from an array of three numbers per vector.
template <typename Number>
glm::dvec3 GetVector(const Number* vectors, std::int64_t index)
{
  return glm::dvec3(vectors[3 * index], vectors[3 * index + 1], vectors[3 * index + 2]);
}

/// The transform DisplacementField::IndexToField and its inverse.
struct FieldTransform
{
  /// Copies the transform of a field.
  explicit FieldTransform(const DisplacementField& field)
    : Last(field.Dimensions[0] - 1, field.Dimensions[1] - 1, field.Dimensions[2] - 1)
  {
    const auto& m = field.IndexToField;
    this->Matrix = glm::dmat3(m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]);
    this->Inverse = glm::inverse(this->Matrix);
    this->Offset = glm::dvec3(m[3], m[7], m[11]);
  }
  /// Transforms a continuous index of the volume to one of the field.
  glm::dvec3 ToField(const glm::dvec3& index) const { return this->Matrix * index + this->Offset; }
  /// Transforms a continuous index of the field to one of the volume.
  glm::dvec3 ToIndex(const glm::dvec3& position) const
  {
    return this->Inverse * (position - this->Offset);
  }

  /// The last point of the field on each axis.
  glm::dvec3 Last;
  /// From vectors in voxels of the volume to vectors in steps between points of the field.
  glm::dmat3 Matrix{ 1.0 };
  /// The inverse of Matrix; not finite if Matrix is singular.
  glm::dmat3 Inverse{ 1.0 };
  /// Position of the index (0, 0, 0) of the volume in the field.
  glm::dvec3 Offset{ 0.0 };
};

/// Returns the displacement of a point of a field.
inline glm::dvec3 GetVector(const DisplacementField& field, std::int64_t point)
{
  const std::array<float, 3> displacement = GetDisplacement(field, point);
  return glm::dvec3(displacement[0], displacement[1], displacement[2]);
}

/// Returns the factor by which the displacement of the border has faded at a position outside a
/// field. position: continuous index of the field. tolerance: distance up to which a position
/// counts as inside.
inline double GetWeightBeyond(
  const DisplacementField& field, const glm::dvec3& position, double tolerance)
{
  if (!IsFading(field))
  {
    return 1.0;
  }
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const auto i = static_cast<std::size_t>(axis);
    const double beyond = std::max(-position[axis], position[axis] - (field.Dimensions[i] - 1));
    const double distance = std::max(beyond - tolerance, 0.0) * field.Fading[i];
    square += distance * distance;
  }
  return GetFadedWeight(std::sqrt(square));
}

/// Whether a field contains a box of continuous indices of the volume. tolerance: in steps between
/// points of the field.
inline bool HoldsBox(const DisplacementField& field, const IndexBounds& box, double tolerance)
{
  const FieldTransform transform(field);
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::dvec3 cornerPoint((corner & 1) != 0 ? box.Max.x : box.Min.x,
      (corner & 2) != 0 ? box.Max.y : box.Min.y, (corner & 4) != 0 ? box.Max.z : box.Min.z);
    const glm::dvec3 position = transform.ToField(cornerPoint);
    if (!glm::all(glm::greaterThan(position, glm::dvec3(-tolerance))) ||
      !glm::all(glm::lessThan(position, transform.Last + tolerance)))
    {
      return false;
    }
  }
  return true;
}

/// Interpolates a vector trilinearly at a continuous index within a field. getVector(point) returns
/// the vector of a point. It is not called for points with weight 0, which may be undefined.
template <typename Function>
glm::dvec3 Interpolate(
  const DisplacementField& field, const glm::dvec3& position, const Function& getVector)
{
  const glm::i64vec3 low(position);
  const glm::dvec3 t = position - glm::dvec3(low);
  glm::dvec3 vector(0.0);
  for (int corner = 0; corner < 8; ++corner)
  {
    double weight = 1.0;
    std::int64_t point = 0;
    for (int axis = 2; axis >= 0; --axis)
    {
      const int upper = corner >> axis & 1;
      weight *= upper ? t[axis] : 1.0 - t[axis];
      point = point * field.Dimensions[static_cast<std::size_t>(axis)] + low[axis] + upper;
    }
    if (weight != 0.0)
    {
      vector += weight * getVector(point);
    }
  }
  return vector;
}

} // namespace deformvolume

#endif
