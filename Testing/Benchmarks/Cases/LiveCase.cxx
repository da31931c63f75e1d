// SPDX-License-Identifier: BSD-3-Clause
#include "LiveCase.h"

#include "BenchmarkCase.h"
#include "Timing.h"

#include <vtkArrayChanges.h>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkCommand.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkLatticeTetrahedraSource.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <stdexcept>

LiveCase::LiveCase(const std::array<int, 3>& dimensions, int nodesPerAxis, bool logged)
  : Dimensions(dimensions)
  , NodesPerAxis(nodesPerAxis)
  , IsLogged(logged)
  , Volume(vtkSmartPointer<vtkImageData>::New())
  , Mesh(vtkSmartPointer<vtkUnstructuredGrid>::New())
{
  this->Volume->ShallowCopy(MakeVolume(dimensions));
  this->Active->SetName("ActiveTetrahedra");
  this->Active->SetNumberOfTuples(this->Volume->GetNumberOfCells());
  this->Active->Fill(31);
  this->Volume->GetCellData()->AddArray(this->Active);
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetInputData(this->Volume);
  lattice->SetNumberOfNodes(nodesPerAxis, nodesPerAxis, nodesPerAxis);
  lattice->EqualSpacingOff();
  lattice->Update();
  this->Mesh->DeepCopy(lattice->GetOutput());
  this->Displacements->SetName("Displacement");
  this->Displacements->SetNumberOfComponents(3);
  this->Displacements->SetNumberOfTuples(this->Mesh->GetNumberOfPoints());
  this->Displacements->Fill(0.25);
  this->Mesh->GetPointData()->SetVectors(this->Displacements);
  this->Filter->SetInputData(this->Volume);
  this->Filter->SetDeformationData(this->Mesh);
  this->Filter->SetResamplerToExact();
  vtkNew<vtkCallbackCommand> observer;
  observer->SetClientData(&this->HasFailed);
  observer->SetCallback([](vtkObject*, unsigned long, void* hasFailed, void*)
    { *static_cast<bool*>(hasFailed) = true; });
  this->Filter->AddObserver(vtkCommand::ErrorEvent, observer);
}

LiveCase::~LiveCase() = default;

void LiveCase::Log(vtkDataArray* array, vtkIdType first, vtkIdType last)
{
  if (!this->IsLogged)
  {
    return;
  }
  if (!vtkArrayChanges::FindLog(array))
  {
    vtkNew<vtkArrayChanges> log;
    log->SetArray(array);
  }
  vtkArrayChanges::FindLog(array)->AddTuples(first, last);
}

void LiveCase::Finish(vtkDataArray* array)
{
  if (!this->IsLogged)
  {
    array->Modified();
  }
}

void LiveCase::MoveAll()
{
  this->MoveSome({ { 2.0, 2.0, 2.0 } });
}

void LiveCase::MoveSome(const std::array<double, 3>& fractions)
{
  ++this->Step;
  double* bounds = this->Volume->GetBounds();
  const vtkIdType nodes = this->Mesh->GetNumberOfPoints();
  for (vtkIdType node = 0; node < nodes; ++node)
  {
    double point[3];
    this->Mesh->GetPoint(node, point);
    bool isMoved = true;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double middle = 0.5 * (bounds[2 * axis] + bounds[2 * axis + 1]);
      const double size = bounds[2 * axis + 1] - bounds[2 * axis];
      isMoved = isMoved && 2.0 * std::abs(point[axis] - middle) <= fractions[axis] * size;
    }
    if (isMoved)
    {
      const auto move = static_cast<float>(
        0.25 + 0.2 * std::sin(0.05 * (point[0] + point[1] + point[2]) + 0.7 * this->Step));
      this->Displacements->SetTypedComponent(node, this->Step % 3, move);
      this->Log(this->Displacements, node, node);
    }
  }
  this->Finish(this->Displacements);
}

void LiveCase::Split(int tetrahedra, int nodes)
{
  const vtkIdType perAxis = this->NodesPerAxis;
  const vtkIdType plane = 3 + this->Step++ % (perAxis - 6);
  // Nodes in the middle of the plane, in a rectangle that is about as wide as high.
  const auto width = static_cast<vtkIdType>(std::sqrt(static_cast<double>(nodes)));
  const vtkIdType first = (perAxis - width) / 2;
  const auto isSplit = [&](vtkIdType node)
  {
    const vtkIdType x = node % perAxis;
    const vtkIdType y = node / perAxis % perAxis;
    return node < perAxis * perAxis * perAxis && node / perAxis / perAxis == plane && x >= first &&
      x < first + width && y >= first && y < first + width;
  };
  // Tetrahedra above the plane, five for each cell.
  const vtkIdType cells = perAxis - 1;
  std::map<vtkIdType, vtkIdType> twins;
  vtkCellArray* connectivity = this->Mesh->GetCells();
  for (vtkIdType row = 0; row < cells && tetrahedra > 0; ++row)
  {
    const vtkIdType begin = 5 * ((plane * cells + row) * cells);
    for (vtkIdType cell = begin; cell < begin + 5 * cells && tetrahedra > 0; ++cell)
    {
      vtkIdType size;
      const vtkIdType* points;
      connectivity->GetCellAtId(cell, size, points);
      std::array<vtkIdType, 4> changed{ { points[0], points[1], points[2], points[3] } };
      bool isChanged = false;
      for (vtkIdType& node : changed)
      {
        if (!isSplit(node))
        {
          continue;
        }
        const auto twin = twins.emplace(node, this->Mesh->GetNumberOfPoints());
        if (twin.second)
        {
          double point[3];
          this->Mesh->GetPoint(node, point);
          this->Mesh->GetPoints()->InsertNextPoint(point);
          const double* moved = this->Displacements->GetTuple3(node);
          this->Displacements->InsertNextTuple3(moved[0], moved[1], moved[2] + 0.1);
        }
        node = twin.first->second;
        isChanged = true;
      }
      if (isChanged)
      {
        connectivity->ReplaceCellAtId(cell, 4, changed.data());
        --tetrahedra;
      }
    }
  }
  connectivity->Modified();
  this->Mesh->GetPoints()->Modified();
  this->Finish(this->Displacements);
  this->Mesh->Modified();
}

void LiveCase::MoveAtRest()
{
  const vtkIdType node = this->Mesh->GetNumberOfPoints() / 2 + this->Step++;
  std::array<double, 3> point;
  this->Mesh->GetPoint(node, point.data());
  this->Mesh->GetPoints()->SetPoint(node, point[0] + 0.1, point[1], point[2]);
  this->Mesh->GetPoints()->Modified();
  this->Mesh->Modified();
}

void LiveCase::ChangeMask(const std::array<int, 3>& cells)
{
  ++this->Step;
  std::array<int, 3> first;
  for (int axis = 0; axis < 3; ++axis)
  {
    first[axis] = (this->Dimensions[axis] - cells[axis]) / 2;
  }
  // Switch the previous box on again.
  for (const int step : { this->Step - 1, this->Step })
  {
    for (int k = 0; k < cells[2]; ++k)
    {
      for (int j = 0; j < cells[1]; ++j)
      {
        for (int i = 0; i < cells[0]; ++i)
        {
          const vtkIdType x = first[0] + i + step % 20;
          const vtkIdType y = first[1] + j;
          const vtkIdType z = first[2] + k;
          const vtkIdType place =
            (z * (this->Dimensions[1] - 1) + y) * (this->Dimensions[0] - 1) + x;
          this->Active->SetValue(place, step == this->Step ? 0 : 31);
        }
        const vtkIdType row =
          ((first[2] + k) * (this->Dimensions[1] - 1) + first[1] + j) * (this->Dimensions[0] - 1) +
          first[0] + step % 20;
        this->Log(this->Active, row, row + cells[0] - 1);
      }
    }
  }
  this->Finish(this->Active);
}

void LiveCase::Touch()
{
  this->Displacements->Modified();
  this->Mesh->Modified();
}

double LiveCase::Update()
{
  const double seconds = Time([this]() { this->Filter->Update(); });
  if (this->HasFailed)
  {
    throw std::runtime_error("the filter has failed");
  }
  return seconds;
}
