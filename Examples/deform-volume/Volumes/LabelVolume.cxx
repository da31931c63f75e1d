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
#include <vtkPointData.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>

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

/// A number in which two grids of the same dimensions differ.
struct GridDifference
{
  std::string Name;
  double OfVolume = 0.0;
  double OfLabels = 0.0;
  /// Displacement of the farthest voxel by this difference alone, in voxels.
  double Voxels = 0.0;
};

GridDifference FindLargestDifference(vtkImageData* volume, vtkImageData* labels)
{
  const auto ofVolume = GetAxes(volume);
  const auto ofLabels = GetAxes(labels);
  GridDifference largest;
  const auto look = [&](const std::string& name, double first, double second, double voxels)
  {
    if (!(voxels <= largest.Voxels))
    {
      largest = { name, first, second, voxels };
    }
  };
  double shortest = std::abs(volume->GetSpacing()[0]);
  for (int axis = 1; axis < 3; ++axis)
  {
    shortest = std::min(shortest, std::abs(volume->GetSpacing()[axis]));
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    const std::string name(1, "xyz"[axis]);
    const double cells = volume->GetDimensions()[axis] - 1;
    const double spacing = volume->GetSpacing()[axis];
    const double other = labels->GetSpacing()[axis];
    look("spacing on axis " + name, spacing, other, std::abs((other / spacing - 1.0) * cells));
    for (int row = 0; row < 3; ++row)
    {
      const double first = ofVolume->GetElement(row, axis);
      const double second = ofLabels->GetElement(row, axis);
      look("direction of axis " + name + " (its component " + "xyz"[row] + ")", first, second,
        std::abs((second - first) * spacing) * cells / shortest);
    }
    const double first = ofVolume->GetElement(axis, 3);
    const double second = ofLabels->GetElement(axis, 3);
    look("first voxel, on axis " + name + " of the world,", first, second,
      std::abs(second - first) / shortest);
  }
  return largest;
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
  const GridDifference difference = FindLargestDifference(volume, labels);
  if (!(difference.Voxels <= tolerance))
  {
    fail(MakeText("Their ", difference.Name, " is ", std::setprecision(9), difference.OfLabels,
      ", and that of the volume is ", difference.OfVolume));
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

std::string LabelVolume::Describe() const
{
  std::vector<std::string> texts;
  for (const LabelArray& array : this->Arrays)
  {
    texts.push_back(array.Name + ", " + array.Values->GetDataTypeAsString());
  }
  return DescribeArrays(texts);
}
