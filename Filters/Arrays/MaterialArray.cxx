// SPDX-License-Identifier: BSD-3-Clause
#include "MaterialArray.h"

#include "Error.h"
#include "MaskArray.h"
#include "ParallelFor.h"
#include "ShapedArray.h"

#include "vtkArrayDispatch.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <atomic>
#include <limits>
#include <sstream>
#include <type_traits>

namespace deformvolume
{

namespace
{

constexpr vtkIdType NoTuple = std::numeric_limits<vtkIdType>::max();

// Calls function(first, values) for ranges of an array, in parallel. first: index of the first
// value.
struct TakeValues
{
  template <typename Array, typename Function>
  void operator()(Array* array, const Function& function) const
  {
    ParallelFor(0, array->GetNumberOfTuples(), 0,
      [&](std::int64_t first, std::int64_t last)
      { function(first, vtk::DataArrayValueRange<1>(array, first, last)); });
  }
};

template <typename Function>
void ForValues(vtkDataArray* array, const Function& function)
{
  if (!vtkArrayDispatch::Dispatch::Execute(array, TakeValues{}, function))
  {
    TakeValues{}(array, function);
  }
}

std::string GetText(vtkDataArray* array, vtkIdType tuple)
{
  std::ostringstream text;
  text << "Voxel " << tuple << " has the value " << array->GetVariantValue(tuple).ToString()
       << " in the array \"" << (array->GetName() ? array->GetName() : "") << "\"";
  return text.str();
}

} // namespace

vtkDataArray* FindMaterialArray(vtkImageData* volume, const std::string& name, bool hasRanges)
{
  const vtkIdType voxels = volume->GetNumberOfPoints();
  vtkPointData* pointData = volume->GetPointData();
  if (!name.empty())
  {
    vtkDataArray* array =
      FindShapedArray(pointData, name.c_str(), 1, voxels, "point array", "the volume");
    if (!array)
    {
      throw Error("The volume has no point array \"" + name +
        "\", which MaterialArrayName names. Add the array, or set another name.");
    }
    return array;
  }
  vtkDataArray* scalars = hasRanges ? pointData->GetScalars() : nullptr;
  if (hasRanges && !scalars)
  {
    throw Error("There are ranges of materials, but the volume has no active scalars. Set "
                "MaterialArrayName, or remove the ranges.");
  }
  if (scalars)
  {
    CheckShape(scalars, 1, voxels,
      std::string("The point array \"") + (scalars->GetName() ? scalars->GetName() : "") +
        "\" of the volume");
  }
  return scalars;
}

std::vector<unsigned char> ReadMaterials(vtkDataArray* array, vtkIdType voxels,
  const std::vector<MaterialRange>& ranges, int fallback, const std::array<bool, 256>& exists,
  const unsigned char* ghosts)
{
  std::vector<unsigned char> materials(
    static_cast<std::size_t>(voxels), static_cast<unsigned char>(fallback));
  if (!array)
  {
    return materials;
  }
  const MaterialRule rule{ ranges, fallback, exists };
  std::atomic<vtkIdType> firstWithout{ NoTuple };
  ForValues(array,
    [&](vtkIdType first, const auto& values)
    {
      const std::int64_t without =
        WriteMaterials(values, rule, &materials[static_cast<std::size_t>(first)],
          ghosts ? ghosts + first : nullptr, IgnoredPointBits);
      if (without >= 0)
      {
        Lower(firstWithout, first + static_cast<vtkIdType>(without));
      }
    });
  if (firstWithout != NoTuple)
  {
    throw Error(GetText(array, firstWithout) +
      ", for which there is no material. Set the material with SetMaterial(), or give the voxel "
      "another value.");
  }
  return materials;
}

std::vector<unsigned char> ReadFlags(vtkDataArray* array)
{
  std::vector<unsigned char> flags(static_cast<std::size_t>(array->GetNumberOfTuples()));
  ForValues(array,
    [&](vtkIdType first, const auto& values)
    {
      using Value = typename std::decay_t<decltype(values)>::ValueType;
      auto tuple = static_cast<std::size_t>(first);
      for (const Value value : values)
      {
        flags[tuple++] = value != 0 ? 1 : 0;
      }
    });
  return flags;
}

} // namespace deformvolume
