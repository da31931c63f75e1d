// SPDX-License-Identifier: BSD-3-Clause
#include "ShapedArray.h"

#include "Error.h"

#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"

namespace deformvolume
{

vtkDataArray* CheckShape(
  vtkAbstractArray* array, int components, vtkIdType tuples, const std::string& subject)
{
  vtkDataArray* const numbers = vtkDataArray::SafeDownCast(array);
  if (!numbers || array->GetNumberOfComponents() != components ||
    array->GetNumberOfTuples() != tuples)
  {
    throw Error(subject + " is " + array->GetDataTypeAsString() + ", " +
      std::to_string(array->GetNumberOfTuples()) + " tuples of " +
      std::to_string(array->GetNumberOfComponents()) + " components. Give it a numeric type, " +
      std::to_string(components) + (components == 1 ? " component" : " components") + " and " +
      std::to_string(tuples) + " tuples.");
  }
  return numbers;
}

vtkDataArray* FindShapedArray(vtkDataSetAttributes* attributes, const char* name, int components,
  vtkIdType tuples, const std::string& kind, const std::string& owner)
{
  vtkAbstractArray* array = attributes->GetAbstractArray(name);
  return array
    ? CheckShape(array, components, tuples, "The " + kind + " \"" + name + "\" of " + owner)
    : nullptr;
}

} // namespace deformvolume
