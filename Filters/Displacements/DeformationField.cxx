// SPDX-License-Identifier: BSD-3-Clause
// The part of Deformation for displacement fields.
#include "Deformation.h"

#include "CoarseVolume.h"
#include "FieldChecker.h"
#include "FieldGeometry.h"
#include "FieldReading.h"
#include "MeshStamp.h"
#include "PipelineGeometry.h"
#include "VectorArray.h"
#include "VectorConversion.h"
#include "WrittenTuples.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <utility>

namespace deformvolume
{

namespace
{

// Fields of fewer points are copied and compared with their last values. This is fast, and later
// steps then process only changed blocks.
constexpr vtkIdType MinPointsInPlace = vtkIdType{ 1 } << 18;

} // namespace

DisplacementField Deformation::GetField(const OutsideVoxels& outside) const
{
  DisplacementField field = this->GetFieldShape(outside);
  field.Owner = this->FieldInPlace.Owner;
  field.Vectors = field.Owner ? this->FieldInPlace.Vectors : this->Vectors.data();
  field.ToDisplacement = this->FieldInPlace.ToDisplacement;
  return field;
}

void Deformation::ReadField(vtkImageData* image, const DeformationSource& source)
{
  vtkPointData* pointData = image->GetPointData();
  Stamp stamp{ { image, image->GetMTime() }, { nullptr, pointData->GetMTime() } };
  AddArray(stamp, source.Selector(image));
  AddMasks(stamp, image);
  if (this->VectorsAreCurrent(stamp, source, true))
  {
    return;
  }
  const ImageGeometry geometry = GetGeometry(image);
  vtkDataArray* array = FindFieldVectors(image, source);
  std::vector<unsigned char> undefined = FindHiddenPoints(image);
  this->VectorsStamp.clear(); // if a call below throws, the vectors are those of another grid
  const auto lastDimensions = this->FieldDimensions;
  const auto lastSpacing = this->FieldSpacing;
  const auto lastIndexToField = this->IndexToField;
  image->GetDimensions(this->FieldDimensions.data());
  this->FieldSpacing = glm::abs(geometry.Spacing);
  this->IndexToField =
    GetIndexToField(geometry, source.Volume, source.FieldIsInverse ? &source.ToOutput : nullptr);
  const int stride = source.FieldIsInverse
    ? 1
    : GetFieldStride(source.Volume.PointExtent, this->IndexToField, this->FieldDimensions);
  vtkSmartPointer<vtkDataArray> taken;
  if (stride > 1)
  {
    // Take only the vectors at the voxels: those between them are not used.
    const Extent& voxels = source.Volume.PointExtent;
    Extent points;
    for (int axis = 0; axis < 3; ++axis)
    {
      double& first = this->IndexToField[4 * axis + 3];
      points[2 * axis] = -static_cast<int>(first);
      points[2 * axis + 1] = points[2 * axis] + this->FieldDimensions[axis] - 1;
      this->FieldDimensions[axis] = static_cast<int>(GetSize(voxels, axis));
      this->IndexToField[4 * axis + axis] = 1.0;
      first = -voxels[2 * axis];
    }
    taken = SampleTuples(array, points, voxels, stride);
    array = taken;
    if (!undefined.empty())
    {
      vtkNew<vtkUnsignedCharArray> all;
      all->SetArray(undefined.data(), static_cast<vtkIdType>(undefined.size()), 1);
      const auto some = SampleTuples(all, points, voxels, stride);
      const auto* values = static_cast<unsigned char*>(some->GetVoidPointer(0));
      undefined = std::vector<unsigned char>(values, values + some->GetNumberOfTuples());
    }
  }
  if (undefined != this->UndefinedPoints || lastDimensions != this->FieldDimensions ||
    lastSpacing != this->FieldSpacing || lastIndexToField != this->IndexToField)
  {
    ++this->UndefinedVersion;
  }
  this->UndefinedPoints = std::move(undefined);
  const bool areDefined = this->UndefinedPoints.empty();
  this->Memories.clear();
  if (this->UseVectorsOnDevice(
        source.FieldIsInverse || !areDefined ? nullptr : array, image->GetNumberOfPoints(), source))
  {
    this->RememberVectors(stamp, source, true);
    return;
  }
  if (!areDefined || !this->UseFieldInPlace(array, source))
  {
    ++this->VectorsVersion;
    this->ConvertField(array, source);
  }
  if (source.FieldIsInverse)
  {
    this->EraseUndefinedVectors();
  }
  this->RememberVectors(stamp, source, true);
}

void Deformation::ConvertField(vtkDataArray* array, const DeformationSource& source)
{
  this->Faults.Reset();
  this->ReplaceVectors(
    static_cast<std::size_t>(array->GetNumberOfTuples()),
    [&](const VectorTaker& take)
    {
      ReadFieldVectors(array, this->UndefinedPoints, take);
      if (this->Faults.MayHaveAny())
      {
        ThrowTooFar();
      }
    },
    source);
}

bool Deformation::UseFieldInPlace(vtkDataArray* array, const DeformationSource& source)
{
  const float* floats = FindFloats(array);
  if (source.FieldIsInverse || !floats || array->GetNumberOfTuples() < MinPointsInPlace)
  {
    return false;
  }
  const VoxelGrid voxelGrid{ source.Volume.PointExtent, source.ToOutput, {} };
  DisplacementField field;
  field.Dimensions = this->FieldDimensions;
  field.Vectors = floats;
  field.IndexToField = this->IndexToField;
  field.ToDisplacement = GetRows(GetToDisplacement(source));
  if (!AreVoxelsPoints(voxelGrid, field))
  {
    return false;
  }
  const DisplacementField& last = this->FieldInPlace;
  const bool isSame = last.Owner && this->ArrayInPlace == array && last.Vectors == field.Vectors &&
    last.Dimensions == field.Dimensions && last.IndexToField == field.IndexToField &&
    last.ToDisplacement == field.ToDisplacement && this->HasSameUnits(source);
  std::optional<PointRanges> written =
    isSame ? FindWritten(array, array, this->TimeInPlace) : std::nullopt;
  const FieldCheckResult state =
    this->ScanInPlace.Check(voxelGrid, field, written ? &*written : nullptr);
  if (!state.IsUsable)
  {
    return false; // ConvertField() throws an Error that says what is wrong
  }
  this->ArrayInPlace = array;
  this->TimeInPlace = array->GetMTime();
  array->Register(nullptr);
  field.Owner =
    std::shared_ptr<const void>(array, [](vtkDataArray* owned) { owned->UnRegister(nullptr); });
  this->VectorsStamp.clear();
  this->VectorsAreWhole = false;
  std::vector<float>().swap(this->Vectors);
  this->BlockVersions.clear();
  this->FieldInPlace = field;
  this->FieldBounds = state.Bounds;
  this->VersionBeforeChanges = written ? this->VectorsVersion : NoVersion;
  this->ChangesInPlace = written ? std::move(*written) : PointRanges();
  ++this->VectorsVersion;
  return true;
}

} // namespace deformvolume
