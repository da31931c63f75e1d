// SPDX-License-Identifier: BSD-3-Clause
// Marks tuples of an array as written: in its log, if it has one, or by Modified().
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
    log->SetArray(array); // the array keeps a reference to the log
  }
}

} // namespace fuzz

#endif
