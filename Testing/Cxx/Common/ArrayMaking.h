// SPDX-License-Identifier: BSD-3-Clause
#ifndef ArrayMaking_h
#define ArrayMaking_h

#include <vtkSmartPointer.h>
#include <vtkType.h>

/// An array of zeros.
template <typename ArrayT>
vtkSmartPointer<ArrayT> MakeArray(const char* name, vtkIdType tuples, int components = 1)
{
  auto array = vtkSmartPointer<ArrayT>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(tuples);
  array->Fill(0.0);
  return array;
}

#endif
