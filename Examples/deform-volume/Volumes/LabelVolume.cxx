// SPDX-License-Identifier: BSD-3-Clause
#include "LabelVolume.h"

#include "Coverage.h"
#include "Failure.h"
#include "Files.h"
#include "ImageAxes.h"
#include "Messages.h"
#include "Options.h"
#include "VolumeReading.h"

#include <vtkDataArray.h>
#include <vtkDataArrayRange.h>
#include <vtkDataSetAttributes.h>
#include <vtkDeformVolumeFilter.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkMath.h>
#include <vtkPointData.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <set>

namespace
{
const char* const Mask = "vtkValidPointMask";

// Names that arrays of files are unlikely to have.
std::string GetInnerName(std::size_t array)
{
  return "deform-volume: labels " + std::to_string(array);
}

std::string GetName(vtkAbstractArray* array, int index)
{
  return array->GetName() ? array->GetName() : "array " + std::to_string(index);
}

template <typename Array>
void CheckWhole(Array* array, const std::string& name, const std::string& path)
{
  if (!array)
  {
    return;
  }
  const auto values = vtk::DataArrayValueRange(array);
  const auto fraction = std::find_if(values.begin(), values.end(),
    [](double value) { return !(std::isfinite(value) && value == std::round(value)); });
  if (fraction != values.end())
  {
    throw Failure(MakeText("cannot use the labels ", path, ": its array \"", name, "\" holds ",
      *fraction, ", but labels are integers. Deform an image with other values as VOLUME"));
  }
}

using Position = std::array<double, 3>;

// Returns the position of a voxel at a corner of an image. corner: 0 to 7.
Position GetCorner(vtkImageData* image, int corner)
{
  int extent[6];
  image->GetExtent(extent);
  Position position;
  image->TransformIndexToPhysicalPoint(
    extent[corner & 1], extent[2 + (corner >> 1 & 1)], extent[4 + (corner >> 2)], position.data());
  return position;
}

std::string GetText(const Position& position)
{
  return MakeText(std::setprecision(9), position[0], ", ", position[1], ", ", position[2]);
}

void CheckGrid(vtkImageData* volume, vtkImageData* labels, const std::string& path)
{
  const auto fail = [&](const std::string& words)
  {
    throw Failure("cannot use the labels " + path + ": they are not on the grid of the volume. " +
      words + ". Resample them to that grid, with nearest-neighbor interpolation");
  };
  for (int axis = 0; axis < 3; ++axis)
  {
    const int voxels = labels->GetDimensions()[axis];
    const int ofVolume = volume->GetDimensions()[axis];
    if (voxels != ofVolume)
    {
      fail("They have " + std::to_string(voxels) + " voxels on axis " + "xyz"[axis] +
        ", and the volume has " + std::to_string(ofVolume));
    }
  }
  // Much larger than the rounding of files, and much smaller than visible differences.
  constexpr double tolerance = 0.01;
  const double* const spacing = volume->GetSpacing();
  const double voxel =
    std::min({ std::abs(spacing[0]), std::abs(spacing[1]), std::abs(spacing[2]) });
  for (int corner = 0; corner < 8; ++corner)
  {
    const Position ofLabels = GetCorner(labels, corner);
    const Position ofVolume = GetCorner(volume, corner);
    const double square = vtkMath::Distance2BetweenPoints(ofLabels.data(), ofVolume.data());
    if (!(std::sqrt(square) <= tolerance * voxel))
    {
      fail("The position of a corner is " + GetText(ofLabels) + ", and in the volume " +
        GetText(ofVolume));
    }
  }
}

std::string DescribeArrays(const std::vector<std::string>& names)
{
  std::string text;
  for (const std::string& name : names)
  {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}
}

LabelVolume::LabelVolume(const Options& options, const Volume& volume, Messages& messages)
{
  const std::string& path = options.LabelVolume;
  if (path.empty())
  {
    return;
  }
  ReadingOptions reading;
  reading.FileCoordinates = options.FileCoordinates;
  reading.CanChooseFrame = false;
  const Volume labels = ReadVolume(path, reading, messages, !options.Quiet);
  if (labels.Axes != volume.Axes && labels.Axes != WorldAxes::Unknown &&
    volume.Axes != WorldAxes::Unknown)
  {
    FlipWorldAxes(labels.Image);
  }
  CheckGrid(volume.Image, labels.Image, path);

  vtkPointData* arrays = labels.Image->GetPointData();
  std::vector<std::string> names;
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = arrays->GetArray(i);
    const std::string name = GetName(arrays->GetAbstractArray(i), i);
    if (name == Mask || name == vtkDataSetAttributes::GhostArrayName())
    {
      continue;
    }
    if (!array)
    {
      messages.Warn(
        "The array \"" + name + "\" of the labels " + path + " holds no numbers. It is left out.");
      continue;
    }
    CheckWhole(vtkFloatArray::FastDownCast(array), name, path);
    CheckWhole(vtkDoubleArray::FastDownCast(array), name, path);
    this->Arrays.push_back({ array, name });
    names.push_back(name);
  }
  if (this->Arrays.empty())
  {
    throw Failure("cannot use the labels " + path + ": its voxels have no numeric array");
  }
  vtkDataArray* scalars = arrays->GetScalars();
  this->ActiveName =
    scalars && scalars->GetName() && std::count(names.begin(), names.end(), scalars->GetName()) > 0
    ? scalars->GetName()
    : names.front();
  for (const std::string& output : options.LabelOutputs)
  {
    if (names.size() > 1 && !HasSuffix(output, { ".vti" }))
    {
      throw Failure("cannot write " + output + ": such a file holds one array, and the labels " +
        path + " have " + std::to_string(names.size()) + " (" + DescribeArrays(names) +
        "). Write .vti");
    }
  }
}

vtkDataArray* LabelVolume::GetScalars() const
{
  const auto found = std::find_if(this->Arrays.begin(), this->Arrays.end(),
    [this](const LabelArray& array) { return array.Name == this->ActiveName; });
  return found == this->Arrays.end() ? nullptr : found->Values.Get();
}

vtkSmartPointer<vtkImageData> LabelVolume::AddTo(
  vtkImageData* volume, vtkDeformVolumeFilter* filter) const
{
  if (this->IsEmpty())
  {
    return volume;
  }
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->ShallowCopy(volume);
  for (std::size_t i = 0; i < this->Arrays.size(); ++i)
  {
    const std::string name = GetInnerName(i);
    this->Arrays[i].Values->SetName(name.c_str());
    image->GetPointData()->AddArray(this->Arrays[i].Values);
    filter->AddCategoricalArray(name.c_str());
  }
  return image;
}

vtkSmartPointer<vtkImageData> LabelVolume::TakeFrom(vtkSmartPointer<vtkImageData>& deformed) const
{
  auto labels = vtkSmartPointer<vtkImageData>::New();
  labels->CopyStructure(deformed);
  auto others = vtkSmartPointer<vtkImageData>::New();
  others->ShallowCopy(deformed);
  for (std::size_t i = 0; i < this->Arrays.size(); ++i)
  {
    const std::string name = GetInnerName(i);
    // The filter has filled uncovered voxels with the background of the volume. Labels get 0.
    const vtkSmartPointer<vtkDataArray> values = CopyCovered(deformed, name.c_str());
    values->SetName(this->Arrays[i].Name.c_str());
    labels->GetPointData()->AddArray(values);
    others->GetPointData()->RemoveArray(name.c_str());
  }
  labels->GetPointData()->SetActiveScalars(this->ActiveName.c_str());
  deformed = others;
  return labels;
}

std::string LabelVolume::DescribeLost(vtkImageData* deformed) const
{
  std::set<double> lost;
  std::string text;
  for (std::size_t i = 0; i < this->Arrays.size(); ++i)
  {
    vtkDataArray* values = deformed->GetPointData()->GetArray(GetInnerName(i).c_str());
    if (!values)
    {
      return {}; // the labels are not deformed
    }
    const auto before = vtk::DataArrayValueRange(this->Arrays[i].Values.Get());
    lost.insert(before.begin(), before.end());
    for (const double value : vtk::DataArrayValueRange(values))
    {
      lost.erase(value);
    }
  }
  lost.erase(0.0);
  for (const double label : lost)
  {
    text += (text.empty() ? "" : ", ") + MakeText(label);
  }
  return text;
}

std::string LabelVolume::Describe() const
{
  std::vector<std::string> texts;
  for (const LabelArray& array : this->Arrays)
  {
    texts.push_back(array.Name + ", " + array.Values->GetDataTypeAsString());
  }
  return DescribeArrays(texts);
}
