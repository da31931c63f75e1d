// SPDX-License-Identifier: BSD-3-Clause
// How a producer says what it has written to an array: by a log where the array has one.
#ifndef Fuzz_WrittenTuples_h
#define Fuzz_WrittenTuples_h

#include <vtkArrayChanges.h>
#include <vtkDataArray.h>
#include <vtkNew.h>

namespace fuzz
{

inline void MarkWritten(vtkDataArray* array, vtkIdType first, vtkIdType last)
{
  if (vtkArrayChanges* log = vtkArrayChanges::FindLog(array))
  {
    log->AddTuples(first, last);
  }
  else
  {
    array->Modified();
  }
}

inline void StartLog(vtkDataArray* array)
{
  if (!vtkArrayChanges::FindLog(array))
  {
    vtkNew<vtkArrayChanges> log;
    log->SetArray(array); // which keeps it
  }
}

} // namespace fuzz

#endif
