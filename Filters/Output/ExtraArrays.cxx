// SPDX-License-Identifier: BSD-3-Clause
#include "ExtraArrays.h"

#include "Background.h"
#include "Densities.h"
#include "Error.h"
#include "ParallelFor.h"

#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkUnsignedIntArray.h"

#include <algorithm>

namespace deformvolume
{

namespace
{

const char* const POSITIONS = "RestPosition";
const std::array<const char*, 3> POSITION_AXES{ { "RestPosition x", "RestPosition y",
  "RestPosition z" } };
const char* const JACOBIAN = "Jacobian";
const char* const FOLD_COUNT = "FoldCount";
constexpr int NoIndex = -2; // not an index, and not the -1 of attribute roles without an array

bool HasName(vtkDataArray* array, const std::string& name)
{
  return array->GetName() && array->GetName() == name;
}

vtkSmartPointer<vtkFloatArray> MakeArray(const char* name, int components, vtkIdType tuples)
{
  auto array = vtkSmartPointer<vtkFloatArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(tuples);
  return array;
}

// 1 for each voxel of an output that is covered, else 0.
const signed char* GetCoverage(vtkImageData* output)
{
  return static_cast<const signed char*>(
    output->GetPointData()->GetArray(ValidPointMaskName)->GetVoidPointer(0));
}

} // namespace

void ExtraArrays::Select(const ExtraArraysRequest& request, const ImageGeometry& whole,
  const Extent& part, const Deformation& deformation, std::vector<SourceArray>& arrays)
{
  this->Request = request;
  this->Copies.erase(
    std::remove_if(this->Copies.begin(), this->Copies.end(),
      [&](const Copy& copy) { return request.Densities.count(copy.Values->GetName()) == 0; }),
    this->Copies.end());
  for (const std::string& name : request.Densities)
  {
    const auto found = std::find_if(arrays.begin(), arrays.end(),
      [&](const SourceArray& array) { return HasName(array.Array, name); });
    if (found == arrays.end())
    {
      throw Error("The density array \"" + name +
        "\" is not a numeric point array of the volume on input port 0. Remove it with "
        "RemoveDensityArray(), or correct its name.");
    }
    if (found->Categorical)
    {
      throw Error("The density array \"" + name +
        "\" is categorical, and labels cannot be divided by the Jacobian. Remove it from the "
        "density arrays or from the categorical arrays. With nearest interpolation all arrays are "
        "categorical.");
    }
    found->Array = this->FindCopy(found->Array, deformation.IsInverseField());
    found->IsDensity = true;
  }
  const auto checkName = [&](const char* name)
  {
    if (std::any_of(arrays.begin(), arrays.end(),
          [&](const SourceArray& array) { return HasName(array.Array, name); }))
    {
      throw Error("The volume on input port 0 has a point array \"" + std::string(name) +
        "\", which is the name of an array that the filter generates. Rename or remove it.");
    }
  };
  if (request.RestPositions)
  {
    checkName(POSITIONS);
    std::for_each(POSITION_AXES.begin(), POSITION_AXES.end(), checkName);
    this->UpdateRestPositions(whole, part);
    for (const auto& positions : this->Positions)
    {
      arrays.push_back({ positions, NoIndex, false });
    }
  }
  else
  {
    this->Positions = {};
  }
  if (request.NeedsJacobian())
  {
    checkName(JACOBIAN);
  }
  if (request.FoldCount)
  {
    checkName(FOLD_COUNT);
  }
  const vtkIdType voxels = GetNumberOfPoints(part);
  if (!request.NeedsJacobian() || deformation.IsInverseField())
  {
    this->Jacobians = nullptr;
    this->MeshJacobians = VoxelJacobians();
    this->MappingVersion = 0;
  }
  else
  {
    if (!this->Jacobians || this->Jacobians->GetNumberOfTuples() != voxels)
    {
      this->Jacobians = MakeArray(JACOBIAN, 1, voxels);
      this->KeyOfJacobians = {};
    }
    arrays.push_back({ this->Jacobians, NoIndex, false });
  }
}

void ExtraArrays::UpdateRestPositions(const ImageGeometry& whole, const Extent& part)
{
  ImageGeometry volume = whole;
  volume.PointExtent = part;
  const glm::dvec3 origin = GetPositionsOrigin(whole);
  if (this->Positions[0] && this->PositionsGeometry == volume && this->PositionsOrigin == origin)
  {
    return;
  }
  std::array<float*, 3> positions;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    this->Positions[axis] = MakeArray(POSITION_AXES[axis], 1, GetNumberOfPoints(part));
    positions[axis] = this->Positions[axis]->GetPointer(0);
  }
  ComputeWorldPositions(volume, origin, positions);
  this->PositionsGeometry = volume;
  this->PositionsOrigin = origin;
}

vtkDataArray* ExtraArrays::FindCopy(vtkDataArray* density, bool isInverse)
{
  const int type = density->GetDataType() == VTK_DOUBLE ? VTK_DOUBLE : VTK_FLOAT;
  if (isInverse && type == density->GetDataType())
  {
    return density;
  }
  const auto last = std::find_if(this->Copies.begin(), this->Copies.end(),
    [&](const Copy& copy) { return HasName(copy.Values, density->GetName()); });
  Copy& copy = last != this->Copies.end() ? *last : this->Copies.emplace_back();
  copy.Density = density;
  if (!copy.Values || copy.Values->GetDataType() != type ||
    copy.Values->GetNumberOfComponents() != density->GetNumberOfComponents() ||
    copy.Values->GetNumberOfTuples() != density->GetNumberOfTuples())
  {
    copy.Values = vtk::TakeSmartPointer(vtkDataArray::CreateDataArray(type));
    copy.Values->SetNumberOfComponents(density->GetNumberOfComponents());
    copy.Values->SetNumberOfTuples(density->GetNumberOfTuples());
    copy.ValuesStamp.clear();
  }
  CopyDescription(density, copy.Values);
  return copy.Values;
}

void ExtraArrays::UpdateCopies()
{
  for (Copy& copy : this->Copies)
  {
    Stamp stamp;
    AddArray(stamp, copy.Density);
    AddArray(stamp, this->Jacobians);
    if (copy.ValuesStamp == stamp)
    {
      continue;
    }
    copy.Values->DeepCopy(copy.Density);
    const auto divide = [&](auto* values)
    {
      const float* divisors =
        this->Ratios.empty() ? this->Jacobians->GetPointer(0) : this->Ratios.data();
      DivideByJacobian(values, copy.Values->GetNumberOfComponents(), divisors, nullptr,
        copy.Values->GetNumberOfTuples());
    };
    if (this->Jacobians && copy.Values->GetDataType() == VTK_DOUBLE)
    {
      divide(static_cast<double*>(copy.Values->GetVoidPointer(0)));
    }
    else if (this->Jacobians)
    {
      divide(static_cast<float*>(copy.Values->GetVoidPointer(0)));
    }
    copy.Values->Modified();
    copy.ValuesStamp = stamp;
  }
}

void ExtraArrays::Compute(const Deformation& deformation, MappingCache& mapping,
  const MappedVolume& volume, vtkImageData* maskedVolume, bool openSplits,
  const OutputMap& toOutput, const std::function<bool(double)>& progress)
{
  if (this->Jacobians)
  {
    this->UpdateJacobians(
      deformation, mapping, volume, maskedVolume, openSplits, toOutput, progress);
  }
  this->UpdateCopies();
}

void ExtraArrays::UpdateJacobians(const Deformation& deformation, MappingCache& mapping,
  const MappedVolume& volume, vtkImageData* maskedVolume, bool openSplits,
  const OutputMap& toOutput, const std::function<bool(double)>& progress)
{
  const bool isMesh = !deformation.IsField();
  if (isMesh &&
    !(this->MappingVersion == mapping.GetVersion() &&
      mapping.IsCurrent(deformation.GetMeshAtRest(), volume)))
  {
    mapping.Update(deformation.GetMeshAtRest(), volume, progress);
    this->MeshJacobians.SetMapping(volume.Part, volume.Whole.Spacing, mapping.GetMapping(),
      deformation.GetRestPoints(), deformation.GetTetrahedra());
    this->MappingVersion = mapping.GetVersion();
  }
  const bool needsRatios = isMesh && !this->Request.Densities.empty();
  const JacobiansKey key{ isMesh ? mapping.GetVersion() : 0, deformation.GetVectorsVersion(),
    deformation.GetUndefinedVersion(), volume.Whole, toOutput, volume.Outside,
    GetMasksStamp(maskedVolume), openSplits, needsRatios };
  if (this->KeyOfJacobians == key)
  {
    return;
  }
  const VolumeMasks masks = ReadMasks(maskedVolume, {});
  const HiddenTetrahedra hidden{ masks.Blanked, masks.BlankedBits, masks.Active, masks.Cut.Crossed,
    openSplits };
  float* jacobians = this->Jacobians->GetPointer(0);
  this->Ratios.resize(needsRatios ? static_cast<std::size_t>(GetNumberOfPoints(volume.Part)) : 0);
  if (isMesh)
  {
    this->MeshJacobians.Compute(toOutput, deformation.GetRestPoints(), deformation.GetTetrahedra(),
      deformation.GetNodeDisplacements(), hidden, jacobians,
      this->Ratios.empty() ? nullptr : this->Ratios.data());
  }
  else
  {
    ComputeFieldJacobians({ volume.Part, toOutput, volume.Whole.PointExtent },
      deformation.GetField(volume.Outside), deformation.GetUndefinedPoints(), hidden, jacobians);
  }
  this->Jacobians->Modified();
  this->KeyOfJacobians = key;
}

ExtraArrays::Loss ExtraArrays::Finish(const Deformation& deformation, const OutsideVoxels& outside,
  double background, vtkImageData* output)
{
  if (this->Request.RestPositions)
  {
    this->FinishRestPositions(background, output);
  }
  if (this->Request.FoldCount)
  {
    this->FinishFoldCounts(output);
  }
  return this->Request.NeedsJacobian()
    ? this->FinishDensities(deformation, outside, background, output)
    : Loss();
}

std::uint32_t* ExtraArrays::MakeFoldCounts(vtkIdType numberOfPoints)
{
  if (!this->Request.FoldCount)
  {
    return nullptr;
  }
  this->FoldCounts = vtkSmartPointer<vtkUnsignedIntArray>::New();
  this->FoldCounts->SetName(FOLD_COUNT);
  this->FoldCounts->SetNumberOfTuples(numberOfPoints);
  this->FoldCounts->Fill(0.0);
  return this->FoldCounts->GetPointer(0);
}

void ExtraArrays::FinishFoldCounts(vtkImageData* output)
{
  // Only overlaps were counted. Other covered voxels have the count 1.
  const signed char* valid = GetCoverage(output);
  std::uint32_t* counts = this->FoldCounts->GetPointer(0);
  for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
  {
    counts[i] = std::max(counts[i], valid[i] ? 1U : 0U);
  }
  output->GetPointData()->AddArray(this->FoldCounts);
  this->FoldCounts = nullptr;
}

void ExtraArrays::FinishRestPositions(double background, vtkImageData* output) const
{
  const vtkIdType voxels = output->GetNumberOfPoints();
  const auto join = [&](auto* joined, const auto& convert)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const auto* values = static_cast<const float*>(
        output->GetPointData()->GetArray(POSITION_AXES[axis])->GetVoidPointer(0));
      ParallelForItems(static_cast<std::size_t>(voxels), 1 << 16,
        [&](std::size_t i)
        { joined[3 * i + axis] = convert(values[i], i, static_cast<int>(axis)); });
    }
  };
  vtkSmartPointer<vtkDataArray> positions;
  if (this->PositionsOrigin == glm::dvec3(0.0))
  {
    const auto floats = MakeArray(POSITIONS, 3, voxels);
    join(floats->GetPointer(0), [](float value, std::size_t, int) { return value; });
    positions = floats;
  }
  else
  {
    const auto doubles = vtkSmartPointer<vtkDoubleArray>::New();
    doubles->SetName(POSITIONS);
    doubles->SetNumberOfComponents(3);
    doubles->SetNumberOfTuples(voxels);
    const signed char* valid = GetCoverage(output);
    join(doubles->GetPointer(0),
      [&](float value, std::size_t i, int axis)
      { return valid[i] ? this->PositionsOrigin[axis] + static_cast<double>(value) : background; });
    positions = doubles;
  }
  for (const char* name : POSITION_AXES)
  {
    output->GetPointData()->RemoveArray(name);
  }
  output->GetPointData()->AddArray(positions);
}

ExtraArrays::Loss ExtraArrays::FinishDensities(const Deformation& deformation,
  const OutsideVoxels& outside, double background, vtkImageData* output)
{
  Loss loss;
  vtkPointData* pointData = output->GetPointData();
  const vtkIdType voxels = output->GetNumberOfPoints();
  const signed char* valid = GetCoverage(output);
  vtkSmartPointer<vtkDataArray> jacobian = pointData->GetArray(JACOBIAN);
  if (!this->Jacobians)
  {
    auto made = MakeArray(JACOBIAN, 1, voxels);
    Extent extent;
    output->GetExtent(extent.data());
    ComputeInverseFieldJacobians(extent, deformation.GetField(outside), made->GetPointer(0));
    for (vtkIdType i = 0; i < voxels; ++i)
    {
      if (!valid[i])
      {
        made->SetValue(i, ClampTo<float>(background));
      }
    }
    jacobian = made;
    pointData->AddArray(made);
  }
  const auto* jacobians = static_cast<const float*>(jacobian->GetVoidPointer(0));
  for (const std::string& name : this->Request.Densities)
  {
    // Do not change the resampled array: the next update may write only a part of it.
    const auto density = vtk::TakeSmartPointer(pointData->GetArray(name.c_str())->NewInstance());
    density->DeepCopy(pointData->GetArray(name.c_str()));
    const auto finish = [&](auto* values, auto zero)
    {
      const int components = density->GetNumberOfComponents();
      if (deformation.IsInverseField())
      {
        DivideByJacobian(values, components, jacobians, valid, voxels);
      }
      loss.NumberOfVoxels = ClearInverted(values, components, jacobians, valid, voxels, zero);
    };
    if (density->GetDataType() == VTK_DOUBLE)
    {
      finish(static_cast<double*>(density->GetVoidPointer(0)), 0.0);
    }
    else
    {
      finish(static_cast<float*>(density->GetVoidPointer(0)), 0.0F);
    }
    pointData->AddArray(density);
  }
  if (!this->Request.Jacobian)
  {
    pointData->RemoveArray(JACOBIAN);
  }
  return loss;
}

void ExtraArrays::Forget()
{
  *this = ExtraArrays();
}

} // namespace deformvolume
