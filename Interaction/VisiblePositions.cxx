// SPDX-License-Identifier: BSD-3-Clause
#include "VisiblePositions.h"

#include "VoxelSize.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInteractorObserver.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace
{

using deformvolume::LineOfSight;

// Finds the voxels along a line of sight. The line is divided into steps.
class VoxelsOnLine
{
public:
  VoxelsOnLine(vtkImageData* image, const LineOfSight& line)
    : Image(image)
    , Scalars(image->GetPointData()->GetScalars())
    , Covered(image->GetPointData()->GetArray("vtkValidPointMask"))
  {
    image->TransformPhysicalPointToContinuousIndex(&line.Near.x, &this->From.x);
    image->TransformPhysicalPointToContinuousIndex(&line.Far.x, &this->To.x);
    const int* extent = image->GetExtent();
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Clip(axis, extent[2 * axis] - 0.5, extent[2 * axis + 1] + 0.5);
    }
    const double length = (this->Last - this->First) * glm::length(line.Far - line.Near);
    const double step = 0.5 * deformvolume::GetSmallestVoxelSize(image);
    this->NumberOfSteps = length > 0.0 ? static_cast<vtkIdType>(std::ceil(length / step)) : 0;
    this->Step = this->NumberOfSteps > 0 ? length / static_cast<double>(this->NumberOfSteps) : 0.0;
  }

  vtkIdType GetNumberOfSteps() const { return this->NumberOfSteps; }
  /// In world units.
  double GetStep() const { return this->Step; }

  /// Returns the voxel at the middle of a step, or at a fraction of the line; -1 if there is none,
  /// or if the deformed volume does not cover it.
  vtkIdType FindVoxelOfStep(vtkIdType step) const
  {
    return this->FindVoxel(this->First +
      (this->Last - this->First) * (static_cast<double>(step) + 0.5) /
        static_cast<double>(this->NumberOfSteps));
  }
  vtkIdType FindVoxel(double part) const
  {
    const glm::dvec3 index = this->From + part * (this->To - this->From);
    const int* extent = this->Image->GetExtent();
    int at[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      at[axis] = static_cast<int>(std::floor(index[axis] + 0.5));
      if (at[axis] < extent[2 * axis] || at[axis] > extent[2 * axis + 1])
      {
        return -1;
      }
    }
    const vtkIdType voxel = this->Image->ComputePointId(at);
    return this->Covered && this->Covered->GetComponent(voxel, 0) == 0.0 ? -1 : voxel;
  }

  double GetValue(vtkIdType voxel) const
  {
    return this->Scalars ? this->Scalars->GetComponent(voxel, 0) : 0.0;
  }

private:
  void Clip(int axis, double low, double high)
  {
    const double slope = this->To[axis] - this->From[axis];
    if (slope == 0.0)
    {
      this->Last = this->From[axis] < low || this->From[axis] > high ? this->First : this->Last;
      return;
    }
    const double a = (low - this->From[axis]) / slope;
    const double b = (high - this->From[axis]) / slope;
    this->First = std::max(this->First, std::min(a, b));
    this->Last = std::max(this->First, std::min(this->Last, std::max(a, b)));
  }

  vtkImageData* Image;
  vtkDataArray* Scalars;
  vtkDataArray* Covered;
  glm::dvec3 From;
  glm::dvec3 To;
  double First = 0.0; // begin and end of the line within the image, as fractions of the line
  double Last = 1.0;
  vtkIdType NumberOfSteps = 0;
  double Step = 0.0;
};

} // namespace

glm::dvec3 deformvolume::DisplayToWorld(vtkRenderer* renderer, double x, double y, double z)
{
  double world[4];
  vtkInteractorObserver::ComputeDisplayToWorld(renderer, x, y, z, world);
  return { world[0], world[1], world[2] };
}

glm::dvec3 deformvolume::WorldToDisplay(vtkRenderer* renderer, const glm::dvec3& position)
{
  double display[3];
  vtkInteractorObserver::ComputeWorldToDisplay(
    renderer, position.x, position.y, position.z, display);
  return { display[0], display[1], display[2] };
}

LineOfSight deformvolume::GetLineOfSight(vtkRenderer* renderer, int x, int y)
{
  return { DisplayToWorld(renderer, x, y, 0.0), DisplayToWorld(renderer, x, y, 1.0) };
}

vtkIdType deformvolume::FindAbsorbingVoxel(
  vtkImageData* image, const LineOfSight& line, vtkPiecewiseFunction* opacity, double unitDistance)
{
  const VoxelsOnLine voxels(image, line);
  std::vector<double> absorbed; // after each step
  double sum = 0.0;
  for (vtkIdType step = 0; step < voxels.GetNumberOfSteps(); ++step)
  {
    const vtkIdType voxel = voxels.FindVoxelOfStep(step);
    if (voxel >= 0)
    {
      const double part =
        opacity ? std::clamp(opacity->GetValue(voxels.GetValue(voxel)), 0.0, 1.0) : 1.0;
      sum += (1.0 - sum) * (1.0 - std::pow(1.0 - part, voxels.GetStep() / unitDistance));
    }
    absorbed.push_back(sum);
  }
  if (sum < 0.1)
  {
    return -1;
  }
  const auto found = std::lower_bound(absorbed.begin(), absorbed.end(), 0.5 * sum);
  return voxels.FindVoxelOfStep(found - absorbed.begin());
}

vtkIdType deformvolume::FindSurfaceVoxel(
  vtkImageData* image, const LineOfSight& line, double isovalue)
{
  const VoxelsOnLine voxels(image, line);
  for (vtkIdType step = 0; step < voxels.GetNumberOfSteps(); ++step)
  {
    const vtkIdType voxel = voxels.FindVoxelOfStep(step);
    if (voxel >= 0 && voxels.GetValue(voxel) >= isovalue)
    {
      return voxel;
    }
  }
  return -1;
}

vtkIdType deformvolume::FindSliceVoxel(
  vtkImageData* image, const LineOfSight& line, const std::vector<SlicePlane>& planes)
{
  const VoxelsOnLine voxels(image, line);
  double first = 1.0;
  vtkIdType found = -1;
  for (const SlicePlane& plane : planes)
  {
    const double along = glm::dot(line.Far - line.Near, plane.Normal);
    const double part =
      along != 0.0 ? glm::dot(plane.Point - line.Near, plane.Normal) / along : -1.0;
    const vtkIdType voxel = part >= 0.0 && part <= first ? voxels.FindVoxel(part) : -1;
    if (voxel >= 0)
    {
      first = part;
      found = voxel;
    }
  }
  return found;
}
