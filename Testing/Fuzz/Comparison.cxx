// SPDX-License-Identifier: BSD-3-Clause
#include "Comparison.h"

#include <vtkDataArray.h>
#include <vtkMatrix3x3.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

namespace fuzz
{

namespace
{

std::string DescribeExtent(vtkImageData* image)
{
  std::ostringstream text;
  for (int i = 0; i < 6; ++i)
  {
    text << image->GetExtent()[i] << ' ';
  }
  return text.str();
}

// Calls a function for each voxel of a part, with its index in the part and in the whole.
template <typename Function>
void ForEachVoxel(vtkImageData* part, vtkImageData* whole, Function&& function)
{
  const int* extent = part->GetExtent();
  vtkIdType next = 0;
  for (int z = extent[4]; z <= extent[5]; ++z)
  {
    for (int y = extent[2]; y <= extent[3]; ++y)
    {
      for (int x = extent[0]; x <= extent[1]; ++x)
      {
        int index[3] = { x, y, z };
        function(next++, whole->ComputePointId(index), index);
      }
    }
  }
}

std::string CompareGeometry(vtkImageData* part, vtkImageData* whole)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    if (part->GetOrigin()[axis] != whole->GetOrigin()[axis] ||
      part->GetSpacing()[axis] != whole->GetSpacing()[axis])
    {
      return "origin " + std::to_string(part->GetOrigin()[axis]) + " and spacing " +
        std::to_string(part->GetSpacing()[axis]) + " on axis " + std::to_string(axis) +
        " instead of " + std::to_string(whole->GetOrigin()[axis]) + " and " +
        std::to_string(whole->GetSpacing()[axis]);
    }
    if (part->GetExtent()[2 * axis] < whole->GetExtent()[2 * axis] ||
      part->GetExtent()[2 * axis + 1] > whole->GetExtent()[2 * axis + 1])
    {
      return "extent " + DescribeExtent(part) + "is not within " + DescribeExtent(whole);
    }
  }
  if (!std::equal(part->GetDirectionMatrix()->GetData(), part->GetDirectionMatrix()->GetData() + 9,
        whole->GetDirectionMatrix()->GetData()))
  {
    return "the direction matrices differ";
  }
  if (part->GetPointData()->GetNumberOfArrays() != whole->GetPointData()->GetNumberOfArrays())
  {
    return std::to_string(part->GetPointData()->GetNumberOfArrays()) + " arrays instead of " +
      std::to_string(whole->GetPointData()->GetNumberOfArrays());
  }
  return "";
}

} // namespace

std::string CompareBits(vtkImageData* part, vtkImageData* whole)
{
  const std::string geometry = CompareGeometry(part, whole);
  if (!geometry.empty())
  {
    return geometry;
  }
  for (int i = 0; i < whole->GetPointData()->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* first = part->GetPointData()->GetArray(i);
    vtkDataArray* second = whole->GetPointData()->GetArray(i);
    const std::string name = second && second->GetName() ? second->GetName() : "?";
    if (!first || !second || first->GetDataType() != second->GetDataType() ||
      first->GetNumberOfComponents() != second->GetNumberOfComponents() ||
      first->GetNumberOfTuples() != part->GetNumberOfPoints() ||
      std::string(first->GetName() ? first->GetName() : "?") != name)
    {
      return "point array " + std::to_string(i) + " is not \"" + name +
        "\" with the same type and size";
    }
    const auto size = static_cast<std::size_t>(first->GetNumberOfComponents()) *
      static_cast<std::size_t>(first->GetDataTypeSize());
    const auto* a = static_cast<const unsigned char*>(first->GetVoidPointer(0));
    const auto* b = static_cast<const unsigned char*>(second->GetVoidPointer(0));
    std::ostringstream text;
    int differences = 0;
    ForEachVoxel(part, whole,
      [&](vtkIdType inPart, vtkIdType inWhole, const int* index)
      {
        if (std::memcmp(a + static_cast<std::size_t>(inPart) * size,
              b + static_cast<std::size_t>(inWhole) * size, size) != 0 &&
          ++differences <= 3)
        {
          text << "array " << name << " at " << index[0] << ' ' << index[1] << ' ' << index[2]
               << " is " << first->GetComponent(inPart, 0) << " instead of "
               << second->GetComponent(inWhole, 0) << "; ";
        }
      });
    if (differences > 0)
    {
      return text.str() + std::to_string(differences) + " voxels differ";
    }
  }
  return "";
}

std::string CheckValues(vtkImageData* output, vtkImageData* volume, const Settings& settings)
{
  vtkDataArray* mask = output->GetPointData()->GetArray("vtkValidPointMask");
  if (!mask || mask->GetNumberOfTuples() != output->GetNumberOfPoints())
  {
    return "vtkValidPointMask is missing or has another size than the output";
  }
  for (int i = 0; i < output->GetPointData()->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = output->GetPointData()->GetArray(i);
    vtkDataArray* source = volume->GetPointData()->GetArray(array->GetName());
    if (array == mask || !source)
    {
      continue;
    }
    const std::string name = array->GetName();
    if (settings.HasDensity && name == "value")
    {
      continue;
    }
    const bool exact = IsCategorical(settings, name);
    for (int component = 0; component < array->GetNumberOfComponents(); ++component)
    {
      std::vector<double> values;
      bool finite = true;
      for (vtkIdType id = 0; id < source->GetNumberOfTuples(); ++id)
      {
        values.push_back(source->GetComponent(id, component));
        finite = finite && std::abs(values.back()) < 1e30;
      }
      if (!finite ||
        (!exact && settings.Interpolation == vtkDeformVolumeFilter::CUBIC_INTERPOLATION))
      {
        continue;
      }
      if (exact)
      {
        std::sort(values.begin(), values.end());
      }
      const auto [least, most] = std::minmax_element(values.begin(), values.end());
      const double slack = 1e-5 * std::max(std::abs(*least), std::abs(*most));
      for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
      {
        const double covered = mask->GetComponent(id, 0);
        const double value = array->GetComponent(id, component);
        if (covered != 0.0 && covered != 1.0)
        {
          return "vtkValidPointMask is " + std::to_string(covered) + " at point " +
            std::to_string(id) + " instead of 0 or 1";
        }
        const bool right = covered == 0.0
          ? std::isnan(settings.BackgroundValue) ||
            array->GetDataTypeMin() > settings.BackgroundValue ||
            array->GetDataTypeMax() < settings.BackgroundValue ||
            value == static_cast<double>(static_cast<float>(settings.BackgroundValue)) ||
            value == settings.BackgroundValue
          : (exact ? std::binary_search(values.begin(), values.end(), value)
                   : value >= *least - slack && value <= *most + slack);
        if (!right)
        {
          return "array " + name + " has the value " + std::to_string(value) + " at point " +
            std::to_string(id) +
            (covered == 0.0 ? ", which is not covered, instead of the background value " +
                  std::to_string(settings.BackgroundValue)
                            : ", which is covered. The volume has values from " +
                  std::to_string(*least) + " to " + std::to_string(*most));
        }
      }
    }
  }
  return "";
}

} // namespace fuzz
