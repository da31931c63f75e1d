// SPDX-License-Identifier: BSD-3-Clause
#include "FieldGeometry.h"

#include "IndexBounds.h" // for OutputTransform

#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <cmath>

namespace deformvolume
{

namespace
{

// Rounds to multiples of 2^-32, far below a voxel. Products of matrices and their inverses have
// rounding errors, which would put the last row of voxels outside a field of the same extent.
double RoundIndex(double index)
{
  constexpr double partsOfVoxel = 4294967296.0; // 2^32
  return std::round(index * partsOfVoxel) / partsOfVoxel;
}

// Converts a transform that takes indices of the volume to one that takes indices of the output.
glm::dmat4 FromOutput(const glm::dmat4& fromVolume, const OutputMap& toOutput)
{
  const OutputTransform transform(toOutput);
  glm::dmat4 fromOutput = fromVolume;
  for (int axis = 0; axis < 3; ++axis)
  {
    if (toOutput.IsDiagonal())
    {
      fromOutput[axis] /= toOutput.Get(axis, axis);
    }
    else
    {
      fromOutput[axis] = fromVolume * glm::dvec4(transform.GetInverse()[axis], 0.0);
    }
  }
  fromOutput[3] -= fromOutput * glm::dvec4(transform.GetShift(), 0.0);
  return fromOutput;
}

} // namespace

std::array<double, 12> GetIndexToField(
  const ImageGeometry& field, const ImageGeometry& volume, const OutputMap* toOutput)
{
  glm::dmat4 toField = field.GetWorldToIndex() * volume.GetIndexToWorld();
  if (toOutput)
  {
    toField = FromOutput(toField, *toOutput);
  }
  std::array<double, 12> indexToField{};
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      const double first = column == 3 ? field.PointExtent[2 * row] : 0.0;
      indexToField[4 * row + column] = RoundIndex(toField[column][row] - first);
    }
  }
  return indexToField;
}

ImageGeometry GetGridAtRest(const ImageGeometry& volume)
{
  // A single cell, from one voxel before the first voxel to one voxel past the last: all voxels lie
  // within it, even with rounding errors.
  glm::dvec3 before;
  ImageGeometry geometry = volume;
  for (int axis = 0; axis < 3; ++axis)
  {
    before[axis] = volume.PointExtent[2 * axis] - 1.0;
    geometry.Spacing[axis] *= volume.PointExtent[2 * axis + 1] + 1.0 - before[axis];
  }
  geometry.Origin = glm::dvec3(volume.GetIndexToWorld() * glm::dvec4(before, 1.0));
  geometry.PointExtent = { { 0, 1, 0, 1, 0, 1 } };
  return geometry;
}

WorldField MakeWorldField(const ImageGeometry& grid)
{
  const Extent& points = grid.PointExtent;
  WorldField field;
  for (int axis = 0; axis < 3; ++axis)
  {
    field.Dimensions[static_cast<std::size_t>(axis)] = static_cast<int>(GetSize(points, axis));
  }
  field.IndexToWorld =
    glm::translate(grid.GetIndexToWorld(), glm::dvec3(points[0], points[2], points[4]));
  field.Tolerance = FieldTolerance;
  return field;
}

} // namespace deformvolume
