// SPDX-License-Identifier: BSD-3-Clause
#include "MeshSpace.h"

#include "ImageAxes.h"
#include "MeshContents.h"
#include "Messages.h"
#include "WorldSpace.h"

#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPointSet.h>
#include <vtkPoints.h>
#include <vtkRectilinearGrid.h>
#include <vtkStringArray.h>

#include <algorithm>

namespace
{
constexpr const char* SpaceName = "SPACE";

WorldAxes FindSpace(const std::string& text, const std::string& before)
{
  return text.find(before + "RAS") != std::string::npos ? WorldAxes::RightAnteriorSuperior
    : text.find(before + "LPS") != std::string::npos    ? WorldAxes::LeftPosteriorSuperior
                                                        : WorldAxes::Unknown;
}

/// The field data array SPACE; null if there is none, or if it is empty.
vtkStringArray* FindSpaceArray(vtkDataObject* object)
{
  auto* array = vtkStringArray::SafeDownCast(object->GetFieldData()->GetAbstractArray(SpaceName));
  return array && array->GetNumberOfValues() > 0 ? array : nullptr;
}

WorldAxes GetSpace(vtkDataObject* object, const std::string& path, Messages& messages)
{
  vtkStringArray* array = FindSpaceArray(object);
  if (!array)
  {
    return WorldAxes::Unknown;
  }
  const WorldAxes space = FindSpace(array->GetValue(0), "");
  if (space == WorldAxes::Unknown)
  {
    messages.Warn("The space of " + path + " is \"" + array->GetValue(0) +
      "\", which is neither LPS nor RAS. It is not used.");
  }
  return space;
}

/// Chooses the world axes of a part. ofFile: the axes that its file states.
WorldAxes Choose(const std::string& optionValue, const std::string& path, WorldAxes ofFile,
  WorldAxes ofVolume, Messages& messages)
{
  if (optionValue.empty() && ofVolume == WorldAxes::Unknown && ofFile != ofVolume)
  {
    messages.Warn(path + " is " + (ofFile == WorldAxes::RightAnteriorSuperior ? "ras" : "lps") +
      ". This is not used, because the file of the volume does not state whether its world "
      "coordinates are lps or ras. Give --volume-space.");
    return ofVolume;
  }
  return ChooseSpace("--mesh-space", optionValue, path, ofFile, ofVolume, messages);
}

vtkSmartPointer<vtkDataArray> Negate(vtkDataArray* array, int components)
{
  auto negated = vtkSmartPointer<vtkDataArray>::Take(
    array->GetDataTypeMin() < 0.0 ? array->NewInstance() : vtkDoubleArray::New());
  negated->DeepCopy(array);
  negated->SetName(array->GetName());
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
  {
    for (int component = 0; component < components; ++component)
    {
      negated->SetComponent(i, component, -array->GetComponent(i, component));
    }
  }
  return negated;
}

}

void FlipWorldAxes(vtkDataSet* data, const std::vector<std::string>& vectors)
{
  // Arrays are copied, because they can be shared with other datasets.
  if (auto* image = vtkImageData::SafeDownCast(data))
  {
    FlipWorldAxes(image);
  }
  else if (auto* grid = vtkRectilinearGrid::SafeDownCast(data))
  {
    grid->SetXCoordinates(Negate(grid->GetXCoordinates(), 1));
    grid->SetYCoordinates(Negate(grid->GetYCoordinates(), 1));
  }
  else if (auto* set = vtkPointSet::SafeDownCast(data))
  {
    if (set->GetPoints())
    {
      vtkNew<vtkPoints> points;
      points->SetData(Negate(set->GetPoints()->GetData(), 2));
      set->SetPoints(points);
    }
  }
  for (const std::string& name : vectors)
  {
    vtkDataArray* array = data->GetPointData()->GetArray(name.c_str());
    if (!name.empty() && array)
    {
      data->GetPointData()->AddArray(Negate(array, std::min(2, array->GetNumberOfComponents())));
    }
  }
}

void KeepSpace(vtkDataObject* object, const char* header)
{
  const WorldAxes space = FindSpace(header ? header : "", std::string(SpaceName) + "=");
  if (object && space != WorldAxes::Unknown)
  {
    vtkNew<vtkStringArray> array;
    array->SetName(SpaceName);
    array->InsertNextValue(space == WorldAxes::RightAnteriorSuperior ? "RAS" : "LPS");
    object->GetFieldData()->AddArray(array);
  }
}

std::string GetSpaceComment(vtkDataObject* object)
{
  vtkStringArray* array = FindSpaceArray(object);
  return array ? std::string(SpaceName) + "=" + array->GetValue(0) : std::string();
}

bool ConvertToWorldOfVolume(vtkDataObject* object, const std::vector<std::string>& vectors,
  const std::string& optionValue, const std::string& path, WorldAxes ofVolume, Messages& messages)
{
  bool isConverted = false;
  const WorldAxes ofAll = GetSpace(object, path, messages);
  // Chooses once for all parts that state the same axes, so that a warning is printed once.
  std::map<WorldAxes, WorldAxes> chosen;
  for (const MeshPart& part : FindParts(object))
  {
    WorldAxes ofFile = part.Data == object ? ofAll : GetSpace(part.Data, path, messages);
    ofFile = ofFile != WorldAxes::Unknown ? ofFile : ofAll;
    if (chosen.count(ofFile) == 0)
    {
      chosen[ofFile] = Choose(optionValue, path, ofFile, ofVolume, messages);
    }
    if (chosen[ofFile] != ofVolume)
    {
      FlipWorldAxes(part.Data, vectors);
      isConverted = true;
    }
  }
  return isConverted;
}
