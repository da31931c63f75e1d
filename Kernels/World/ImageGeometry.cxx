// SPDX-License-Identifier: BSD-3-Clause
#include "ImageGeometry.h"

#include "Error.h"
#include "IndexBounds.h"
#include "ParallelFor.h"

#include <glm/common.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace deformvolume
{

namespace
{

// Rounds to a multiple of 1/4096 if the value is close to one: products of matrices and their
// inverses have rounding errors. Even over 10,000 voxels the change is far below the 2^-16 voxel of
// the kernels.
double DropRoundingError(double value)
{
  constexpr double grain = 4096.0;
  constexpr double tolerance = 1e-10;
  const double simple = std::round(value * grain) / grain;
  return std::abs(value - simple) < tolerance ? simple : value;
}

} // namespace

// GLM stores matrices column by column.
glm::dmat3 MakeDirection(const double* rows)
{
  return glm::transpose(glm::make_mat3(rows));
}

glm::dmat4 ImageGeometry::GetIndexToWorld() const
{
  glm::dmat4 transform(1.0);
  for (int axis = 0; axis < 3; ++axis)
  {
    transform[axis] = glm::dvec4(this->Direction[axis] * this->Spacing[axis], 0.0);
  }
  transform[3] = glm::dvec4(this->Origin, 1.0);
  return transform;
}

glm::dmat4 ImageGeometry::GetWorldToIndex() const
{
  glm::dmat3 inverse = glm::inverse(this->Direction);
  for (int column = 0; column < 3; ++column)
  {
    inverse[column] /= this->Spacing;
  }
  glm::dmat4 transform(inverse);
  transform[3] = glm::dvec4(-(inverse * this->Origin), 1.0);
  return transform;
}

bool ImageGeometry::operator==(const ImageGeometry& other) const
{
  return this->PointExtent == other.PointExtent && this->Origin == other.Origin &&
    this->Spacing == other.Spacing && this->Direction == other.Direction;
}

bool AreSamePositions(const ImageGeometry& first, const ImageGeometry& second, const Extent& extent)
{
  constexpr double tolerance = 1e-3; // far more than the rounding of floats, far less than a voxel
  const glm::dmat4 transform = second.GetWorldToIndex() * first.GetIndexToWorld();
  bool same = true;
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::dvec4 index(
      extent[corner & 1], extent[2 + (corner >> 1 & 1)], extent[4 + (corner >> 2 & 1)], 1.0);
    const glm::dvec4 distance = glm::abs(transform * index - index);
    same = same && distance.x <= tolerance && distance.y <= tolerance && distance.z <= tolerance;
  }
  return same;
}

OutputMap GetOutputMap(const ImageGeometry& image, const ImageGeometry& output)
{
  const bool isParallel = image.Direction == output.Direction;
  const glm::dvec3 scale = image.Spacing / output.Spacing;
  OutputMap map(std::array<double, 3>{ { scale.x, scale.y, scale.z } });
  const glm::dmat3 toOutput(output.GetWorldToIndex());
  const glm::dmat3 matrix = toOutput * glm::dmat3(image.GetIndexToWorld());
  const glm::dvec3 shift = toOutput * (image.Origin - output.Origin);
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3 && !isParallel; ++column)
    {
      map.Matrix[static_cast<std::size_t>(3 * row + column)] =
        DropRoundingError(matrix[column][row]);
    }
    map.Shift[static_cast<std::size_t>(row)] = DropRoundingError(shift[row]);
  }
  return map;
}

double GetLargestCoordinate(const ImageGeometry& image)
{
  const IndexBounds box = TransformBox(image.GetIndexToWorld(), GetBox(image.PointExtent));
  const glm::dvec3 largest = glm::max(glm::abs(box.Min), glm::abs(box.Max));
  return std::max({ largest.x, largest.y, largest.z });
}

double GetSmallestSpacing(const ImageGeometry& image)
{
  const glm::dvec3 spacing = glm::abs(image.Spacing);
  return std::min({ spacing.x, spacing.y, spacing.z });
}

glm::dvec3 GetPositionsOrigin(const ImageGeometry& volume)
{
  // Positions are rounded to floats, and interpolated in single precision.
  const double error = GetLargestCoordinate(volume) / static_cast<double>(1 << 22);
  if (error <= GetSmallestSpacing(volume) / 256.0)
  {
    return glm::dvec3(0.0);
  }
  const IndexBounds box = GetBox(volume.PointExtent);
  return glm::dvec3(volume.GetIndexToWorld() * glm::dvec4(0.5 * (box.Min + box.Max), 1.0));
}

void ComputeWorldPositions(
  const ImageGeometry& image, const glm::dvec3& origin, const std::array<float*, 3>& positions)
{
  const Extent& extent = image.PointExtent;
  const glm::dmat4 toWorld = image.GetIndexToWorld();
  const std::int64_t width = GetSize(extent, 0);
  const std::int64_t height = GetSize(extent, 1);
  ParallelForItems(height * GetSize(extent, 2), 64,
    [&](std::int64_t row)
    {
      glm::dvec4 index(0.0, extent[2] + row % height, extent[4] + row / height, 1.0);
      for (std::int64_t x = 0; x < width; ++x)
      {
        index.x = static_cast<double>(extent[0] + x);
        const glm::dvec3 position = glm::dvec3(toWorld * index) - origin;
        for (std::size_t axis = 0; axis < 3; ++axis)
        {
          positions[axis][row * width + x] = static_cast<float>(position[static_cast<int>(axis)]);
        }
      }
    });
}

std::string DescribeTransform(const ImageGeometry& geometry)
{
  std::ostringstream text;
  text << "origin " << geometry.Origin.x << ", " << geometry.Origin.y << ", " << geometry.Origin.z
       << ", spacing " << geometry.Spacing.x << ", " << geometry.Spacing.y << ", "
       << geometry.Spacing.z << " and direction";
  for (int element = 0; element < 9; ++element)
  {
    text << (element == 0 ? " " : ", ") << geometry.Direction[element % 3][element / 3];
  }
  return text.str();
}

std::string DescribeExtent(const Extent& extent)
{
  std::string text;
  for (int bound : extent)
  {
    text += (text.empty() ? "" : ", ") + std::to_string(bound);
  }
  return text;
}

bool Contains(const Extent& extent, const Extent& other)
{
  bool contains = true;
  for (int axis = 0; axis < 3; ++axis)
  {
    contains = contains && extent[2 * axis] <= other[2 * axis] &&
      extent[2 * axis + 1] >= other[2 * axis + 1];
  }
  return contains;
}

void CheckTransform(const ImageGeometry& geometry, const std::string& what)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    if (!std::isfinite(geometry.Origin[axis]))
    {
      throw Error("The origin of " + what + " is not finite. Set a finite one.");
    }
    if (!std::isfinite(geometry.Spacing[axis]) || geometry.Spacing[axis] == 0.0)
    {
      throw Error("The spacing of " + what + " on axis " + "xyz"[axis] + " is " +
        FormatNumber(geometry.Spacing[axis]) + ". Set one that is not 0.");
    }
  }
  const double determinant = glm::determinant(geometry.Direction);
  const double lengths = glm::length(geometry.Direction[0]) * glm::length(geometry.Direction[1]) *
    glm::length(geometry.Direction[2]);
  constexpr double least = 1e-12; // of the volume of a box with edges of these lengths
  if (!std::isfinite(determinant) || !(std::abs(determinant) > least * lengths))
  {
    throw Error("The direction matrix of " + what +
      " has no inverse. Set one of three independent directions.");
  }
}

void CheckVolume(const ImageGeometry& volume)
{
  // Test each axis: the number of points of an invalid extent may overflow.
  for (int axis = 0; axis < 3; ++axis)
  {
    if (GetSize(volume.PointExtent, axis) == 0)
    {
      throw Error("The volume is empty. Connect a vtkImageData with voxels.");
    }
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    if (GetSize(volume.PointExtent, axis) < 2)
    {
      throw Error(std::string("The volume has one voxel only on axis ") + "xyz"[axis] +
        ". Give a volume of at least two voxels on each axis.");
    }
  }
  CheckTransform(volume, "the volume");
}

} // namespace deformvolume
