// SPDX-License-Identifier: BSD-3-Clause
#include "Stamp.h"

#include "VolumeArrays.h"

#include "vtkDataArray.h"
#include "vtkPoints.h"

namespace deformvolume
{

void AddArray(Stamp& stamp, vtkAbstractArray* array)
{
  stamp.emplace_back(array, array ? array->GetMTime() : 0);
  // Insertions, and SetArray(), which replaces the memory, do not change the modification time.
  vtkDataArray* numbers = vtkDataArray::SafeDownCast(array);
  stamp.emplace_back(numbers ? GetWritableValues(numbers) : nullptr,
    array ? static_cast<vtkMTimeType>(array->GetNumberOfValues()) : 0);
}

void AddPoints(Stamp& stamp, vtkPoints* points)
{
  stamp.emplace_back(points, points ? points->vtkObject::GetMTime() : 0);
  AddArray(stamp, points ? points->GetData() : nullptr);
}

} // namespace deformvolume
