// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorArray_h
#define DeformVolumeVectorArray_h

#include "vtkType.h"

#include <glm/vec3.hpp>

#include <functional>
#include <string>
#include <vector>

class vtkDataArray;
class vtkDataSet;

namespace deformvolume
{

/// Takes count vectors from the one with number first on; called in parallel.
using VectorTaker =
  std::function<void(vtkIdType first, const glm::dvec3* vectors, vtkIdType count)>;

/// Is told of a vector that is not finite; called in parallel.
using FaultTaker = std::function<void(vtkIdType tuple)>;

/// When an array was read last.
struct VectorMemory
{
  const void* Array = nullptr; // null where nothing is known
  vtkMTimeType Time = 0;       // of the array
  vtkIdType Count = 0;         // of its tuples
  vtkIdType FirstNumber = 0;   // what its first tuple counted as
};

/// Reads the tuples of an array of three components, in parallel, some at a time. Throws an Error
/// that names the first tuple that is not finite: "<kind> 5 of the <owner>".
/// memory: of the last reading of this array or of one in its place, which may have had fewer or
/// more tuples. Blocks of tuples that a log of the array (vtkArrayChanges) has as not written since
/// then are left out. Null: all are taken.
/// takeFault: called for tuples that are not finite, after they have been taken as zeros. Empty:
/// they are an error.
void ReadVectors(vtkDataArray* array, const VectorTaker& take, const std::string& kind,
  const std::string& owner, VectorMemory* memory = nullptr, const FaultTaker& takeFault = {});

/// Copies tuples of an array of three components, from the one with number first on; may be called
/// by several threads.
using VectorCopier = std::function<void(vtkIdType first, vtkIdType count, glm::dvec3* vectors)>;
VectorCopier MakeVectorCopier(vtkDataArray* array);

/// The vectors of a dataset's points where nobody chose: the active ones, or else the only array of
/// three components; null where there is no such array.
vtkDataArray* FindVectors(vtkDataSet* dataSet);

} // namespace deformvolume

#endif
