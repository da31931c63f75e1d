// SPDX-License-Identifier: BSD-3-Clause
#include "WrittenTuples.h"

#include "vtkAbstractArray.h"
#include "vtkArrayChanges.h"

namespace deformvolume
{

std::optional<PointRanges> FindWritten(vtkAbstractArray* array, const void* last, vtkMTimeType time)
{
  const vtkArrayChanges* log = array == last ? vtkArrayChanges::FindLog(array) : nullptr;
  PointRanges ranges;
  if (!log || !log->GetTuplesSince(time, ranges))
  {
    return {};
  }
  return ranges;
}

} // namespace deformvolume
