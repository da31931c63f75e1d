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

/// A vtkChainMailDeformation of a volume, and observers of its errors and warnings.
struct Dragged
{
  explicit Dragged(vtkDataObject* volume)
  {
    for (const unsigned long event : { vtkCommand::ErrorEvent, vtkCommand::WarningEvent })
    {
      this->Filter->AddObserver(event, this->Observer);
      this->Filter->GetExecutive()->AddObserver(event, this->ExecutiveObserver);
    }
    this->Filter->SetInputDataObject(volume);
    this->Filter->SetRelaxationSweeps(0);
  }

  /// Updates the filter and returns its error message, or "" without an error.
  std::string TryUpdate()
  {
    this->Filter->Modified();
    this->Filter->Update();
    std::string errors = this->Observer->GetErrorMessage();
    EXPECT_EQ(errors.find("ERROR: "), errors.rfind("ERROR: "));
    if (!errors.empty())
    {
      // The next update reports the error again, although nothing has changed.
      this->Observer->Clear();
      EXPECT_FALSE(this->Filter->GetExecutive()->Update());
      EXPECT_TRUE(this->Observer->GetError());
    }
    this->Observer->Clear();
    this->ExecutiveObserver->Clear();
    EXPECT_TRUE(
      errors.empty() || this->Filter->GetOutput()->GetPointData()->GetNumberOfArrays() == 0);
    return errors;
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

  vtkNew<vtkChainMailDeformation> Filter;
  vtkNew<vtkTest::ErrorObserver> Observer;
  vtkNew<vtkTest::ErrorObserver> ExecutiveObserver;
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
