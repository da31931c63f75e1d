// SPDX-License-Identifier: BSD-3-Clause
#include "MaskArray.h"

#include "Error.h"
#include "ShapedArray.h"

#include "vtkCellData.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkPointData.h"

#include <algorithm>

namespace deformvolume
{

ByteArray* FindMask(vtkDataSetAttributes* attributes, const char* name, vtkIdType size,
  const std::string& what, const std::string& owner)
{
  vtkAbstractArray* array = attributes->GetAbstractArray(name);
  auto* mask = vtkArrayDownCast<ByteArray>(array);
  if (array && (!mask || mask->GetNumberOfComponents() != 1 || mask->GetNumberOfTuples() != size))
  {
    throw Error("The " + what + " array \"" + name + "\" of the " + owner + " is " +
      array->GetDataTypeAsString() + ", " + std::to_string(array->GetNumberOfTuples()) +
      " tuples of " + std::to_string(array->GetNumberOfComponents()) +
      " components. Give it type unsigned char, one component and " + std::to_string(size) +
      " tuples, one for each " + what + ".");
  }
  return mask;
}

namespace
{

DistanceValues FindDistances(vtkImageData* volume, const char* name)
{
  DistanceValues distances;
  vtkDataArray* numbers = FindShapedArray(
    volume->GetPointData(), name, 1, volume->GetNumberOfPoints(), "point array", "the volume");
  if (!numbers)
  {
    return distances;
  }
  if (auto* floats = vtkArrayDownCast<vtkAOSDataArrayTemplate<float>>(numbers))
  {
    distances.Values = floats->GetPointer(0);
    return distances;
  }
  const auto values = vtk::DataArrayValueRange<1>(numbers);
  distances.Converted.resize(static_cast<std::size_t>(values.size()));
  std::transform(values.begin(), values.end(), distances.Converted.begin(),
    [](double value) { return static_cast<float>(value); });
  distances.Values = distances.Converted.data();
  return distances;
}

} // namespace

DistanceValues FindBoundaryDistances(vtkImageData* volume)
{
  return FindDistances(volume, BoundaryDistanceName);
}

bool HasCut(vtkImageData* volume)
{
  return volume->GetCellData()->GetAbstractArray(CutTetrahedraName) != nullptr;
}

bool IsCutAnnounced(vtkInformation* volumeInfo)
{
  vtkInformationVector* arrays = volumeInfo->Get(vtkDataObject::CELL_DATA_VECTOR());
  for (int i = 0; arrays && i < arrays->GetNumberOfInformationObjects(); ++i)
  {
    const char* name = arrays->GetInformationObject(i)->Get(vtkDataObject::FIELD_NAME());
    if (name && std::string(name) == CutTetrahedraName)
    {
      return true;
    }
  }
  return false;
}

CutValues FindCut(vtkImageData* volume)
{
  CutValues cut;
  ByteArray* crossed = FindMask(
    volume->GetCellData(), CutTetrahedraName, volume->GetNumberOfCells(), "cell", "volume");
  cut.Distances = FindDistances(volume, CutDistanceName);
  if ((crossed != nullptr) != (cut.Distances.Values != nullptr))
  {
    throw Error(std::string("The volume has only one of the cell array \"") + CutTetrahedraName +
      "\" and the point array \"" + CutDistanceName +
      "\". A smooth cut needs both: pass both on, or remove both.");
  }
  cut.Crossed = crossed ? crossed->GetPointer(0) : nullptr;
  return cut;
}

PointGhosts FindPointGhosts(vtkDataSet* data, const std::string& owner)
{
  const vtkIdType size = data->GetNumberOfPoints();
  ByteArray* array =
    FindMask(data->GetPointData(), vtkDataSetAttributes::GhostArrayName(), size, "point", owner);
  PointGhosts ghosts;
  ghosts.Values = array ? array->GetPointer(0) : nullptr;
  auto* mask = data->GetPointData()->GetArray(ValidPointMaskName);
  if (!mask)
  {
    return ghosts;
  }
  if (mask->GetNumberOfComponents() != 1 || mask->GetNumberOfTuples() != size)
  {
    throw Error(std::string("The point array \"") + ValidPointMaskName + "\" of the " + owner +
      " has " + std::to_string(mask->GetNumberOfTuples()) + " tuples of " +
      std::to_string(mask->GetNumberOfComponents()) +
      " components. Give it one component and one tuple for each point, or remove it.");
  }
  const auto hide = [&](const auto& valid)
  {
    if (std::find(valid.begin(), valid.end(), 0) == valid.end())
    {
      return;
    }
    if (ghosts.Values)
    {
      ghosts.Joined.assign(ghosts.Values, ghosts.Values + size);
    }
    ghosts.Joined.resize(static_cast<std::size_t>(size));
    auto value = ghosts.Joined.begin();
    for (const auto isValid : valid)
    {
      *value++ |= isValid == 0 ? vtkDataSetAttributes::HIDDENPOINT : 0;
    }
    ghosts.Values = ghosts.Joined.data();
  };
  // vtkProbeFilter writes a vtkCharArray: read it without conversion to double.
  if (auto* chars = vtkArrayDownCast<vtkAOSDataArrayTemplate<char>>(mask))
  {
    hide(vtk::DataArrayValueRange<1>(chars));
  }
  else
  {
    hide(vtk::DataArrayValueRange<1>(mask));
  }
  return ghosts;
}

SkippedCells::SkippedCells(vtkDataSet* data, const std::string& owner)
  : NumberOfPoints(data->GetNumberOfPoints())
  , Points(FindPointGhosts(data, owner))
{
  ByteArray* array = FindMask(data->GetCellData(), vtkDataSetAttributes::GhostArrayName(),
    data->GetNumberOfCells(), "cell", owner);
  this->Cells = array ? array->GetPointer(0) : nullptr;
}

bool SkippedCells::Contain(vtkIdType cell) const
{
  constexpr int kinds = vtkDataSetAttributes::DUPLICATECELL | vtkDataSetAttributes::HIDDENCELL;
  return this->Cells && (this->Cells[cell] & kinds) != 0;
}

bool SkippedCells::ContainPointOf(const vtkIdType* points, vtkIdType count) const
{
  return this->Points.Values &&
    std::any_of(points, points + count,
      [this](vtkIdType point)
      {
        return point >= 0 && point < this->NumberOfPoints &&
          (this->Points.Values[point] & vtkDataSetAttributes::HIDDENPOINT) != 0;
      });
}

} // namespace deformvolume
