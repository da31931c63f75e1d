// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWrittenTuples_h
#define DeformVolumeWrittenTuples_h

#include "PointRanges.h"

#include "vtkType.h"

#include <optional>

class vtkAbstractArray;

namespace deformvolume
{

/// The tuples of an array that were written after `time`, according to its log (vtkArrayChanges).
/// Empty if there is no log, `array` is null, or `array` is not `last`, the array that had this
/// modification time.
std::optional<PointRanges> FindWritten(
  vtkAbstractArray* array, const void* last, vtkMTimeType time);

} // namespace deformvolume

#endif
