// SPDX-License-Identifier: BSD-3-Clause
#include "ImageAxes.h"

#include "Failure.h"
#include "Messages.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkMath.h>
#include <vtkMatrix3x3.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <iomanip>

namespace
{
constexpr double RoundedLength = 2e-7;
constexpr double RoundedShear = 1e-5;
constexpr double MaximumShear = 1e-3;

// The largest cosine of the angles between the axes. columns: unit vectors.
double FindShear(const double columns[3][3])
{
  double shear = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    shear = std::max(shear, std::abs(vtkMath::Dot(columns[axis], columns[(axis + 1) % 3])));
  }
  return shear;
}

// The vector from the first voxel to an index.
void FindOffset(
  const double columns[3][3], const double spacing[3], const double index[3], double offset[3])
{
  for (int row = 0; row < 3; ++row)
  {
    offset[row] = 0.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      offset[row] += columns[axis][row] * spacing[axis] * index[axis];
    }
  }
}

// Makes the columns perpendicular, and keeps the center of the image. shift: the displacement of
// the first voxel. Returns the largest displacement of a corner.
double RemoveShear(
  double columns[3][3], const double spacing[3], const int dimensions[3], double shift[3])
{
  double old[3][3];
  std::copy(&columns[0][0], &columns[0][0] + 9, &old[0][0]);
  // The arrays hold the transposed matrices. The nearest orthogonal matrix of a transposed matrix
  // is the transposed nearest orthogonal matrix.
  vtkMath::Orthogonalize3x3(old, columns);
  double middle[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    middle[axis] = 0.5 * (dimensions[axis] - 1);
  }
  double before[3];
  double after[3];
  FindOffset(old, spacing, middle, before);
  FindOffset(columns, spacing, middle, after);
  vtkMath::Subtract(before, after, shift);
  double farthest = 0.0;
  for (int corner = 0; corner < 8; ++corner)
  {
    const double index[3] = { (corner & 1) * 2 * middle[0], (corner >> 1 & 1) * 2 * middle[1],
      (corner >> 2) * 2 * middle[2] };
    FindOffset(old, spacing, index, before);
    FindOffset(columns, spacing, index, after);
    vtkMath::Add(after, shift, after);
    farthest = std::max(farthest, std::sqrt(vtkMath::Distance2BetweenPoints(before, after)));
  }
  return farthest;
}
}

std::string DescribeSize(vtkImageData* image)
{
  const int* const size = image->GetDimensions();
  return MakeText(size[0], " x ", size[1], " x ", size[2]);
}

vtkSmartPointer<vtkMatrix4x4> GetAxes(vtkImageData* image)
{
  auto axes = vtkSmartPointer<vtkMatrix4x4>::New();
  int extent[6];
  image->GetExtent(extent);
  double first[3];
  image->TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], first);
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      axes->SetElement(row, column, image->GetDirectionMatrix()->GetElement(row, column));
    }
    axes->SetElement(row, 3, first[row]);
  }
  return axes;
}

void SetAxes(vtkImageData* image, vtkMatrix4x4* axes, const std::string& path, Messages& messages,
  const std::string& advice)
{
  double columns[3][3];
  double spacing[3];
  for (int column = 0; column < 3; ++column)
  {
    for (int row = 0; row < 3; ++row)
    {
      columns[column][row] = axes->GetElement(row, column);
    }
    const double length = vtkMath::Normalize(columns[column]);
    // Files hold single precision. A length of 1 up to its rounding does not change the spacing.
    const double factor = std::abs(length - 1.0) < RoundedLength ? 1.0 : length;
    spacing[column] = image->GetSpacing()[column] * factor;
    const bool hasSize = spacing[column] > 0.0 && std::isfinite(spacing[column]);
    if (!hasSize || !std::isfinite(axes->GetElement(column, 3)))
    {
      throw Failure(MakeText("cannot read ", path, ": its header gives the ",
        hasSize ? "position " : "voxel spacing ",
        hasSize ? axes->GetElement(column, 3) : spacing[column],
        hasSize ? " of the first voxel on axis " : " on axis ", column, advice));
    }
  }
  double origin[3] = { axes->GetElement(0, 3), axes->GetElement(1, 3), axes->GetElement(2, 3) };
  const double shear = FindShear(columns);
  if (shear > MaximumShear)
  {
    throw Failure(MakeText(std::setprecision(4), "cannot read ", path, ": its axes are sheared by ",
      vtkMath::DegreesFromRadians(std::asin(std::min(shear, 1.0))),
      " degrees, and a volume of VTK has perpendicular axes. Resample it on perpendicular axes "
      "first, for example with 3D Slicer; a series with gantry tilt is converted and straightened "
      "by dcm2niix",
      advice));
  }
  constexpr double roundingOfSinglePrecision = 1e-7;
  if (shear > roundingOfSinglePrecision)
  {
    double shift[3];
    const double farthest = RemoveShear(columns, spacing, image->GetDimensions(), shift);
    vtkMath::Add(origin, shift, origin);
    if (shear > RoundedShear)
    {
      messages.Warn(MakeText(std::setprecision(4), "The axes of ", path, " are sheared by ", shear,
        ". A volume of VTK has perpendicular axes: the nearest ones are used, which moves voxels "
        "by up to ",
        farthest, "."));
    }
  }
  image->SetSpacing(spacing);
  image->SetOrigin(origin);
  image->SetDirectionMatrix(columns[0][0], columns[1][0], columns[2][0], columns[0][1],
    columns[1][1], columns[2][1], columns[0][2], columns[1][2], columns[2][2]);
}

void FlipWorldAxes(vtkMatrix4x4* axes)
{
  for (int row = 0; row < 2; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      // 0.0 - x, because -x would give a negative zero.
      axes->SetElement(row, column, 0.0 - axes->GetElement(row, column));
    }
  }
}

void FlipWorldAxes(vtkImageData* image)
{
  double direction[9];
  std::copy_n(image->GetDirectionMatrix()->GetData(), 9, direction);
  for (int i = 0; i < 6; ++i) // the rows of x and y
  {
    direction[i] = 0.0 - direction[i];
  }
  image->SetDirectionMatrix(direction);
  const double* const origin = image->GetOrigin();
  image->SetOrigin(0.0 - origin[0], 0.0 - origin[1], origin[2]);
}

void ReverseSlices(vtkImageData* image)
{
  int size[3];
  image->GetDimensions(size);
  const vtkIdType slice = vtkIdType{ size[0] } * size[1];
  vtkDataArray* const values = image->GetPointData()->GetScalars();
  const auto reversed = vtkSmartPointer<vtkDataArray>::Take(values->NewInstance());
  reversed->SetName(values->GetName());
  reversed->SetNumberOfComponents(values->GetNumberOfComponents());
  reversed->SetNumberOfTuples(values->GetNumberOfTuples());
  for (int z = 0; z < size[2]; ++z)
  {
    reversed->InsertTuples(z * slice, slice, (size[2] - 1 - z) * slice, values);
  }
  image->GetPointData()->SetScalars(reversed);
}

void ReverseSlices(vtkMatrix4x4* axes, double depth)
{
  for (int row = 0; row < 3; ++row)
  {
    axes->SetElement(row, 3, axes->GetElement(row, 3) + axes->GetElement(row, 2) * depth);
    axes->SetElement(row, 2, -axes->GetElement(row, 2));
  }
}
