// SPDX-License-Identifier: BSD-3-Clause
// What Deformation does with a displacement field.
#include "Deformation.h"

#include "Error.h"
#include "FieldScan.h"
#include "VectorArray.h"

#include "vtkAOSDataArrayTemplate.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <cmath>

namespace deformvolume
{

namespace
{

const char* const FIELD = "displacement field on input port 1";

// Fields of fewer points are converted and compared with what they were: that takes no time, and
// then only what changed is made anew.
constexpr vtkIdType LeastPointsInPlace = vtkIdType{ 1 } << 18;

// Products of matrices and their inverses miss the simple numbers that are meant, and then the
// last row of voxels is outside a field of the same extent. The grain is far below a voxel.
double DropRoundingError(double value)
{
  constexpr double grain = 4294967296.0;
  return std::round(value * grain) / grain;
}

// The values of an array of floats that lies in memory tuple by tuple; null for others.
const float* FindFloats(vtkDataArray* array)
{
  auto* floats = vtkAOSDataArrayTemplate<float>::FastDownCast(array);
  return floats ? floats->GetPointer(0) : nullptr;
}

} // namespace

DisplacementField Deformation::GetField(bool extrapolate) const
{
  DisplacementField field = this->FieldInPlace;
  if (!field.Owner)
  {
    field.Dimensions = this->FieldDimensions;
    field.Vectors = this->Vectors.data();
    field.IndexToField = this->IndexToField;
  }
  field.Extrapolate = extrapolate;
  return field;
}

void Deformation::ReadField(vtkImageData* image, const DeformationSource& source)
{
  vtkPointData* pointData = image->GetPointData();
  Stamp stamp{ { image, image->GetMTime() }, { nullptr, pointData->GetMTime() } };
  // An array that gets other memory, or is cut off, keeps its time.
  vtkDataArray* chosen = source.Selector(image);
  stamp.emplace_back(
    FindFloats(chosen), chosen ? static_cast<vtkMTimeType>(chosen->GetNumberOfValues()) : 0);
  if (this->VectorsAreCurrent(stamp, source, true))
  {
    return;
  }
  if (image->GetNumberOfPoints() == 0)
  {
    throw Error("The displacement field on input port 1 is empty. Connect a vtkImageData with a "
                "point array of three components.");
  }
  const ImageGeometry geometry = GetGeometry(image);
  CheckTransform(geometry, "the displacement field on input port 1");
  vtkDataArray* array = FindVectors(image, source.Selector, source.Wanted, FIELD);
  image->GetDimensions(this->FieldDimensions.data());
  glm::dmat4 toField = geometry.GetWorldToIndex() * source.Volume.GetIndexToWorld();
  for (int axis = 0; axis < 3 && source.FieldIsInverse; ++axis)
  {
    toField[axis] /= source.Scale[axis];
  }
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      const double first = column == 3 ? geometry.PointExtent[2 * row] : 0.0;
      this->IndexToField[4 * row + column] = DropRoundingError(toField[column][row] - first);
    }
  }
  this->Memories.clear();
  if (!this->UseFieldInPlace(array, source))
  {
    this->SetVectors(
      static_cast<std::size_t>(image->GetNumberOfPoints()),
      [&](const VectorTaker& take) { ReadVectors(array, take, "Vector", FIELD); },
      source.DisplacementScale, source);
  }
  this->RememberVectors(stamp, source, true);
}

bool Deformation::UseFieldInPlace(vtkDataArray* array, const DeformationSource& source)
{
  const float* floats = FindFloats(array);
  if (source.FieldIsInverse || !floats || array->GetNumberOfTuples() < LeastPointsInPlace)
  {
    return false;
  }
  const VoxelGrid voxelGrid{ source.Volume.PointExtent,
    { { source.Scale.x, source.Scale.y, source.Scale.z } }, {} };
  DisplacementField field;
  field.Dimensions = this->FieldDimensions;
  field.Vectors = floats;
  field.IndexToField = this->IndexToField;
  const glm::dmat3 transform = GetToDisplacement(source, source.DisplacementScale);
  for (int i = 0; i < 9; ++i)
  {
    field.ToDisplacement[i] = transform[i % 3][i / 3];
  }
  if (!AreVoxelsPoints(voxelGrid, field))
  {
    return false;
  }
  const FieldScan scan = ScanField(voxelGrid, field);
  if (!scan.IsUsable)
  {
    return false; // to convert them tells what is wrong
  }
  array->Register(nullptr);
  field.Owner =
    std::shared_ptr<const void>(array, [](vtkDataArray* owned) { owned->UnRegister(nullptr); });
  this->VectorsStamp.clear();
  this->VectorsAreWhole = false;
  std::vector<float>().swap(this->Vectors);
  this->BlockVersions.clear();
  this->FieldInPlace = field;
  this->FieldBounds = scan.Bounds;
  ++this->VectorsVersion;
  return true;
}

} // namespace deformvolume
