// SPDX-License-Identifier: BSD-3-Clause
#include "Pose.h"

#include <vtkMath.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkTransform.h>

#include <algorithm>
#include <cmath>

namespace
{
// A box of this part of each axis touches 5 % of the blocks of 64 x 16 x 16 voxels of the
// benchmarks' volume: 1 of 3 on x, 7 of 19 on y and 6 of 15 on z.
constexpr double LocalEditFraction = 0.28;

// A window function: 1 in the middle of an interval, 0 outside, with a derivative of 0 at the ends.
double Window(double x, double begin, double end)
{
  if (x <= begin || x >= end)
  {
    return 0.0;
  }
  const double sine = std::sin(vtkMath::Pi() * (x - begin) / (end - begin));
  return sine * sine;
}
}

const char* GetName(Pose pose)
{
  switch (pose)
  {
    case Pose::Undeformed:
      return "undeformed";
    case Pose::NearIdentity:
      return "near";
    case Pose::General:
      return "general";
    case Pose::LocalLoad:
      return "local-load";
    case Pose::Rotated:
      return "rotated-45";
    case Pose::VaryingScale:
      return "varying-scale";
    case Pose::UniformScale:
      return "scale-1.5";
    case Pose::Folded:
      return "folded";
    case Pose::LocalEdit:
      return "local-edit";
    case Pose::LocalEditAtSide:
      return "local-edit-at-side";
  }
  return "";
}

std::array<double, 6> GetLocalEditBox(Pose pose, const std::array<int, 3>& dimensions)
{
  std::array<double, 6> box;
  for (int axis = 0; axis < 3; ++axis)
  {
    box[2 * axis] = 0.5 * (1.0 - LocalEditFraction) * (dimensions[axis] - 1);
    box[2 * axis + 1] = 0.5 * (1.0 + LocalEditFraction) * (dimensions[axis] - 1);
  }
  if (pose == Pose::LocalEditAtSide)
  {
    // Center the box on a side of the volume, and double its length along that axis, so that as
    // much of the volume is in the box.
    box[2] = (1.0 - LocalEditFraction) * (dimensions[1] - 1);
    box[3] = (1.0 + LocalEditFraction) * (dimensions[1] - 1);
  }
  return box;
}

PoseMap::PoseMap(Pose pose, const std::array<int, 3>& dimensions, int step)
  : ThePose(pose)
  , Dimensions(dimensions)
  , Phase(0.01 * (step % 10))
  , Shift(step % 2)
{
  switch (pose)
  {
    case Pose::General:
      this->SetMatrix(7.0 + this->Phase, 7.0, 1.03);
      break;
    case Pose::Rotated:
      this->SetMatrix(45.0 + this->Phase, 45.0, 1.0);
      break;
    case Pose::UniformScale:
      this->SetMatrix(0.0, 0.0, 1.5 + 0.01 * this->Phase);
      break;
    default:
      break;
  }
}

void PoseMap::SetMatrix(double degreesRoundX, double degreesRoundYZ, double scale)
{
  double center[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    center[axis] = 0.5 * (this->Dimensions[axis] - 1);
  }
  vtkNew<vtkTransform> transform;
  transform->Translate(center);
  transform->RotateX(degreesRoundX);
  transform->RotateY(degreesRoundYZ);
  transform->RotateZ(degreesRoundYZ);
  transform->Scale(scale, scale, scale);
  transform->Translate(-center[0], -center[1], -center[2]);
  std::copy_n(transform->GetMatrix()->GetData(), 12, this->Matrix.begin());
}

std::array<double, 3> PoseMap::MoveNearIdentity(
  const std::array<double, 3>& rest, double phase) const
{
  constexpr double amplitude = 12.0;
  return { { rest[0] + amplitude * std::sin(0.02 * rest[1] + phase),
    rest[1] + amplitude * std::sin(0.02 * rest[2] + phase),
    rest[2] + amplitude * std::sin(0.02 * rest[0] + phase) } };
}

std::array<double, 3> PoseMap::operator()(const std::array<double, 3>& rest) const
{
  std::array<double, 3> moved = rest;
  switch (this->ThePose)
  {
    case Pose::Undeformed:
      moved[0] += this->Shift;
      break;
    case Pose::NearIdentity:
      moved = this->MoveNearIdentity(rest, this->Phase);
      break;
    case Pose::General:
    case Pose::Rotated:
    case Pose::UniformScale:
      for (int row = 0; row < 3; ++row)
      {
        const double* matrix = this->Matrix.data() + 4 * row;
        moved[row] = matrix[0] * rest[0] + matrix[1] * rest[1] + matrix[2] * rest[2] + matrix[3];
      }
      break;
    case Pose::LocalLoad:
    {
      constexpr double depth = 25.0;
      const double width =
        0.12 * *std::min_element(this->Dimensions.begin(), this->Dimensions.end());
      const double x = (rest[0] - 0.5 * (this->Dimensions[0] - 1)) / width;
      const double y = (rest[1] - (this->Dimensions[1] - 1)) / (2.0 * width);
      const double z = (rest[2] - 0.5 * (this->Dimensions[2] - 1)) / width;
      moved[0] += this->Shift;
      moved[1] -= depth * std::exp(-0.5 * (x * x + y * y + z * z));
      break;
    }
    case Pose::VaryingScale:
      for (int axis = 0; axis < 3; ++axis)
      {
        const double length = this->Dimensions[axis] - 1;
        const double t = rest[axis] / length;
        // The derivative increases from 0.7 to 1.6.
        moved[axis] = length * t * (0.7 + 0.45 * t) + this->Phase;
      }
      break;
    case Pose::Folded:
    {
      const double crease = 2.0 / 3.0 * (this->Dimensions[0] - 1);
      moved = this->MoveNearIdentity(rest, this->Phase);
      moved[0] -= 2.0 * std::max(0.0, rest[0] - crease);
      break;
    }
    case Pose::LocalEdit:
    case Pose::LocalEditAtSide:
    {
      constexpr double amplitude = 3.0;
      const auto box = GetLocalEditBox(this->ThePose, this->Dimensions);
      moved = this->MoveNearIdentity(rest, 0.0);
      moved[this->ThePose == Pose::LocalEdit ? 0 : 1] += amplitude * std::cos(10.0 * this->Phase) *
        Window(rest[0], box[0], box[1]) * Window(rest[1], box[2], box[3]) *
        Window(rest[2], box[4], box[5]);
      break;
    }
  }
  return moved;
}
