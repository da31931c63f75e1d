// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeShapedArray_h
#define DeformVolumeShapedArray_h

#include "vtkType.h"

#include <string>

class vtkAbstractArray;
class vtkDataArray;
class vtkDataSetAttributes;

namespace deformvolume
{

/// Returns `array` as a vtkDataArray. Throws an Error if it is not numeric, or has another number
/// of components or tuples. subject: names the array in the message, such as 'The point array
/// "Pinned" of the volume'.
vtkDataArray* CheckShape(
  vtkAbstractArray* array, int components, vtkIdType tuples, const std::string& subject);

/// Finds the array of a name and checks it with CheckShape(). Returns null if there is no such
/// array. kind and owner: words for the message, such as "point array" and "the volume".
vtkDataArray* FindShapedArray(vtkDataSetAttributes* attributes, const char* name, int components,
  vtkIdType tuples, const std::string& kind, const std::string& owner);

} // namespace deformvolume

#endif
