// SPDX-License-Identifier: BSD-3-Clause
// Handles and a filter for the tests of vtkChainMailDeformation.
#ifndef ChainMailTesting_h
#define ChainMailTesting_h

#include "FilterTesting.h"
#include "vtkChainMailDeformation.h"

#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkPolyData.h>

#include <vector>

namespace chainMailTesting
{

struct Handle
{
  glm::dvec3 Rest;
  glm::dvec3 Now;
};

inline vtkSmartPointer<vtkPolyData> MakeHandles(const std::vector<Handle>& handles)
{
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> rest;
  rest->SetName("RestPosition");
  rest->SetNumberOfComponents(3);
  for (const Handle& handle : handles)
  {
    points->InsertNextPoint(&handle.Now.x);
    rest->InsertNextTuple(&handle.Rest.x);
  }
  data->SetPoints(points);
  data->GetPointData()->AddArray(rest);
  return data;
}

/// A vtkChainMailDeformation of a volume.
struct Dragged : Observed<vtkChainMailDeformation>
{
  explicit Dragged(vtkDataObject* volume)
  {
    this->Filter->SetInputDataObject(volume);
    this->Filter->SetRelaxationSweeps(0);
  }

  /// The displacements of the output. They may be on a device.
  vtkDataArray* GetArray()
  {
    return this->Filter->GetOutput()->GetPointData()->GetArray("Displacement");
  }
  /// The displacements of the output on the host: the array itself, or a copy of an array on a
  /// device.
  vtkFloatArray* GetFloats()
  {
    vtkDataArray* array = this->GetArray();
    auto* const floats = vtkFloatArray::SafeDownCast(array);
    if (array && !floats)
    {
      this->Copied->DeepCopy(array);
      return this->Copied;
    }
    return floats;
  }
  vtkFloatArray* Update()
  {
    EXPECT_EQ(this->TryUpdate(), "");
    return this->GetFloats();
  }
  vtkFloatArray* Drag(const std::vector<Handle>& handles)
  {
    this->Filter->SetHandlesData(MakeHandles(handles));
    return this->Update();
  }

  vtkNew<vtkFloatArray> Copied;
};

inline vtkSmartPointer<vtkFloatArray> Copy(vtkDataArray* array)
{
  auto copy = vtkSmartPointer<vtkFloatArray>::New();
  copy->DeepCopy(array);
  return copy;
}

} // namespace chainMailTesting

#endif
