// SPDX-License-Identifier: BSD-3-Clause
#include "MaskArray.h"

#include "Error.h"

#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

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

const unsigned char* FindPointGhosts(vtkImageData* volume)
{
  ByteArray* ghosts = FindMask(volume->GetPointData(), vtkDataSetAttributes::GhostArrayName(),
    volume->GetNumberOfPoints(), "point", "volume");
  return ghosts ? ghosts->GetPointer(0) : nullptr;
}

} // namespace deformvolume
