// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWrittenTuples_h
#define DeformVolumeWrittenTuples_h

#include "PointRanges.h"

#include "vtkType.h"

#include <optional>

class vtkAbstractArray;

namespace deformvolume
{

/// Tuples of an array, which may be null, that were written since it had a modification time, where
/// a vtkArrayChanges tells that. last: the array that had it; there is no answer about another one.
std::optional<PointRanges> FindWritten(
  vtkAbstractArray* array, const void* last, vtkMTimeType time);

} // namespace deformvolume

#endif
