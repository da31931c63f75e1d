// SPDX-License-Identifier: BSD-3-Clause
#include "Coverage.h"

#include <vtkCharArray.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>

const char* GetCoverage(vtkImageData* result)
{
  return vtkCharArray::SafeDownCast(result->GetPointData()->GetArray("vtkValidPointMask"))
    ->GetPointer(0);
}

vtkSmartPointer<vtkDataArray> CopyCovered(vtkImageData* result, const char* name)
{
  vtkDataArray* values = result->GetPointData()->GetArray(name);
  const auto copy = vtkSmartPointer<vtkDataArray>::Take(values->NewInstance());
  copy->DeepCopy(values);
  const char* covered = GetCoverage(result);
  for (vtkIdType voxel = 0; voxel < copy->GetNumberOfTuples(); ++voxel)
  {
    for (int component = 0; covered[voxel] == 0 && component < copy->GetNumberOfComponents();
         ++component)
    {
      copy->SetComponent(voxel, component, 0.0);
    }
  }
  return copy;
}
