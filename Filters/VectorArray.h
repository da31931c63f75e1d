// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorArray_h
#define DeformVolumeVectorArray_h

#include "vtkType.h"

#include <glm/vec3.hpp>

#include <functional>
#include <string>

class vtkDataArray;
class vtkDataSet;

namespace deformvolume
{

/// Takes count vectors from the one with number first on; called in parallel.
using VectorTaker =
  std::function<void(vtkIdType first, const glm::dvec3* vectors, vtkIdType count)>;

/// Reads the tuples of an array of three components, in parallel, some at a time. Throws an Error
/// that names the first tuple that is not finite: "<kind> 5 of the <owner>".
void ReadVectors(
  vtkDataArray* array, const VectorTaker& take, const std::string& kind, const std::string& owner);

/// The vectors of a dataset's points where nobody chose: the active ones, or else the only array of
/// three components; null where there is no such array.
vtkDataArray* FindVectors(vtkDataSet* dataSet);

} // namespace deformvolume

#endif
