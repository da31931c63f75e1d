// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorArray_h
#define DeformVolumeVectorArray_h

#include "VectorConversion.h"

#include "vtkType.h"

#include <glm/vec3.hpp>

#include <functional>
#include <string>
#include <vector>

class vtkDataArray;
class vtkDataSet;

namespace deformvolume
{

/// Receives the index of a tuple that is not finite. Called in parallel.
using FaultTaker = std::function<void(vtkIdType tuple)>;

/// The last reading of an array.
struct VectorMemory
{
  const void* Array = nullptr; // null: there was no reading
  vtkMTimeType Time = 0;       // modification time of the array
  vtkIdType Count = 0;         // number of its tuples
  vtkIdType FirstNumber = 0;   // index of its first tuple, counted over the arrays of all parts
};

/// Reads the tuples of an array of three components in blocks, in parallel. Throws an Error that
/// names the first tuple that is not finite: "<kind> 5 of the <owner>".
/// memory: the last reading, which this call updates. The array may have had fewer or more tuples
/// then. Blocks that were not written since, according to the log of the array (vtkArrayChanges),
/// are skipped. Null: all blocks are read.
/// takeFault: called for each tuple that is not finite, after `take` received zeros for it. Empty:
/// a tuple that is not finite is an error.
void ReadVectors(vtkDataArray* array, const VectorTaker& take, const std::string& kind,
  const std::string& owner, VectorMemory* memory = nullptr, const FaultTaker& takeFault = {});

/// Copies the tuples with the indices first to first + count - 1 of an array of three components.
/// May be called by several threads.
using VectorCopier = std::function<void(vtkIdType first, vtkIdType count, glm::dvec3* vectors)>;
VectorCopier MakeVectorCopier(vtkDataArray* array);

/// The point vectors of a dataset, used if no array was selected: the active vectors, or else the
/// only array of three components. Null if there is no such array, or if there are several.
vtkDataArray* FindVectors(vtkDataSet* dataSet);

} // namespace deformvolume

#endif
