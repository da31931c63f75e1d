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

/// Throws an Error where an array is none of numbers, or has another shape. subject: what the error
/// calls it, as 'The point array "Pinned" of the volume'.
vtkDataArray* CheckShape(
  vtkAbstractArray* array, int components, vtkIdType tuples, const std::string& subject);

/// The array of a name, checked like that; null where there is none. kind: "point array" or the
/// like; owner: of what.
vtkDataArray* FindShapedArray(vtkDataSetAttributes* attributes, const char* name, int components,
  vtkIdType tuples, const std::string& kind, const std::string& owner);

} // namespace deformvolume

#endif
