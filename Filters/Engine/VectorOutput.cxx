// SPDX-License-Identifier: BSD-3-Clause
#include "VectorOutput.h"

#include "Device.h"

#include "vtkDeviceVectorArray.h"
#include "vtkFloatArray.h"
#include "vtkNew.h"

#include <new>

namespace deformvolume
{

vtkSmartPointer<vtkFloatArray> MakeDisplacements(vtkIdType tuples)
{
  auto array = vtkSmartPointer<vtkFloatArray>::New();
  array->SetName("Displacement");
  array->SetNumberOfComponents(3);
  if (!array->Resize(tuples))
  {
    throw std::bad_alloc();
  }
  array->SetNumberOfTuples(tuples);
  return array;
}

bool VectorOutput::Allocate(const std::string& device, vtkIdType tuples)
{
  const bool isOnDevice = GetDeviceAbilities(device).OwnMemory;
  if (this->Array && this->Device == device && this->Array->GetNumberOfTuples() == tuples &&
    (isOnDevice || this->Array->GetVoidPointer(0) == this->Memory))
  {
    // Keep the array: consumers find changes by comparing arrays.
    return isOnDevice;
  }
  this->Array = nullptr; // frees its memory before new memory is allocated
  this->Vectors.reset();
  this->Device = device;
  if (isOnDevice)
  {
    this->Vectors = std::make_shared<DeviceVectors>(device, static_cast<std::size_t>(tuples));
    vtkNew<vtkDeviceVectorArray> array;
    array->SetDevice(device);
    array->SetVectors(this->Vectors);
    array->SetName("Displacement");
    this->Array = array;
  }
  else
  {
    const vtkSmartPointer<vtkFloatArray> array = MakeDisplacements(tuples);
    this->Memory = array->GetPointer(0);
    this->Array = array;
  }
  return isOnDevice;
}

void VectorOutput::Restore()
{
  auto* const array = vtkDeviceVectorArray::SafeDownCast(this->Array);
  if (array && !array->IsOf(this->Vectors))
  {
    array->SetVectors(this->Vectors);
  }
}

} // namespace deformvolume
