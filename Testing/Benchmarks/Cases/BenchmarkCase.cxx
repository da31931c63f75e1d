// SPDX-License-Identifier: BSD-3-Clause
#include "BenchmarkCase.h"

#include "../Reported.h"
#include "Timing.h"

#include <vtkCallbackCommand.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkLatticeTetrahedraSource.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSMPTools.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace
{
template <typename T>
void FillWaves(vtkImageData* volume, double mean, double amplitude)
{
  constexpr double frequencies[3] = { 0.11, 0.07, 0.05 };
  int dimensions[3];
  volume->GetDimensions(dimensions);
  std::vector<double> waves[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int i = 0; i < dimensions[axis]; ++i)
    {
      waves[axis].push_back(amplitude * std::sin(frequencies[axis] * i));
    }
  }
  auto* value = static_cast<T*>(volume->GetScalarPointer());
  for (const double z : waves[2])
  {
    for (const double y : waves[1])
    {
      for (const double x : waves[0])
      {
        *value++ = static_cast<T>(mean + x + y + z);
      }
    }
  }
}
}

vtkSmartPointer<vtkImageData> MakeVolume(const std::array<int, 3>& dimensions, int type)
{
  auto volume = vtkSmartPointer<vtkImageData>::New();
  volume->SetDimensions(dimensions.data());
  volume->AllocateScalars(type, 1);
  switch (type)
  {
    case VTK_UNSIGNED_SHORT:
      FillWaves<unsigned short>(volume, 2000.0, 600.0);
      break;
    case VTK_UNSIGNED_CHAR:
      FillWaves<unsigned char>(volume, 128.0, 40.0);
      break;
    default:
      throw std::invalid_argument("MakeVolume() supports unsigned short and unsigned char only");
  }
  return volume;
}

BenchmarkCase::BenchmarkCase(vtkImageData* volume, int nodesPerAxis, int resampler)
{
  volume->GetDimensions(this->Dimensions.data());
  if (nodesPerAxis == DenseField)
  {
    vtkNew<vtkImageData> field;
    field->CopyStructure(volume);
    this->Deformation = field;
  }
  else
  {
    vtkNew<vtkLatticeTetrahedraSource> lattice;
    lattice->SetInputData(volume);
    lattice->SetNumberOfNodes(nodesPerAxis, nodesPerAxis, nodesPerAxis);
    lattice->EqualSpacingOff();
    lattice->Update();
    this->Deformation = lattice->GetOutput();
  }
  this->Displacements = vtkSmartPointer<vtkFloatArray>::New();
  this->Displacements->SetName("Displacement");
  this->Displacements->SetNumberOfComponents(3);
  this->Displacements->SetNumberOfTuples(this->Deformation->GetNumberOfPoints());
  this->Deformation->GetPointData()->SetVectors(this->Displacements);
  this->Filter->SetInputData(volume);
  this->Filter->SetDeformationData(this->Deformation);
  this->Filter->SetResampler(resampler);
  vtkNew<vtkCallbackCommand> observer;
  observer->SetClientData(&this->Error);
  observer->SetCallback(
    [](vtkObject*, unsigned long, void* error, void* text)
    {
      // Remove the source file, the line, and the name and address of the filter from the text.
      const std::string words = static_cast<const char*>(text);
      const std::size_t begin = words.find("): ");
      *static_cast<std::string*>(error) =
        begin == std::string::npos ? words : words.substr(begin + 3);
    });
  this->Filter->AddObserver(vtkCommand::ErrorEvent, observer);
}

BenchmarkCase::~BenchmarkCase() = default;

void BenchmarkCase::ConnectRest()
{
  this->Rest = vtkUnstructuredGrid::SafeDownCast(this->Deformation);
  vtkNew<vtkUnstructuredGrid> shape;
  shape->DeepCopy(this->Rest);
  // Deformed positions replace the displacements, with the same number of values.
  vtkNew<vtkPoints> points;
  points->SetDataTypeToFloat();
  points->SetNumberOfPoints(this->Rest->GetNumberOfPoints());
  shape->SetPoints(points);
  this->Deformation = shape;
  this->Displacements = points->GetData();
  this->Filter->SetDeformationData(shape);
  this->Filter->SetRestData(this->Rest);
}

void BenchmarkCase::Move(Pose pose, Grid grid)
{
  const PoseMap map(pose, this->Dimensions, ++this->Step);
  auto* displacement = vtkFloatArray::SafeDownCast(this->Displacements)->GetPointer(0);
  vtkDataSet* points = this->Rest ? this->Rest.Get() : this->Deformation.Get();
  const double share = this->Rest ? 0.0 : 1.0; // 1 subtracts the position at rest
  points->GetPoint(0); // the first call is not thread-safe for some datasets
  vtkSMPTools::For(0, points->GetNumberOfPoints(),
    [&](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType point = begin; point < end; ++point)
      {
        std::array<double, 3> rest;
        points->GetPoint(point, rest.data());
        const auto moved = map(rest);
        for (int axis = 0; axis < 3; ++axis)
        {
          displacement[3 * point + axis] = static_cast<float>(moved[axis] - share * rest[axis]);
        }
      }
    });
  this->Displacements->Modified();
  if (this->Rest)
  {
    this->Deformation->Modified();
  }
  if (grid == Grid::Same)
  {
    return;
  }
  const auto next = vtkSmartPointer<vtkDataSet>::Take(this->Deformation->NewInstance());
  next->ShallowCopy(this->Deformation);
  this->Deformation = next;
  this->Filter->SetDeformationData(next);
}

UpdateTimes BenchmarkCase::Update()
{
  UpdateTimes times;
  times.Update = Time([this]() { this->Filter->Update(); });
  if (!this->Error.empty())
  {
    std::string error;
    error.swap(this->Error);
    throw std::runtime_error(error);
  }
  if (this->Filter->GetNumberOfCoveredVoxels() == 0)
  {
    throw std::runtime_error("no voxel is covered");
  }
  times.Mapping = GetReportedSeconds(this->Filter, "Seconds for mapping");
  times.Resampling = GetReportedSeconds(this->Filter, "Seconds for resampling");
  times.Transfer = GetReportedSeconds(this->Filter, "Seconds for transfer");
  times.Preprocessing = GetReportedSeconds(this->Filter, "Seconds for the static mapping");
  return times;
}

vtkIdType BenchmarkCase::GetNumberOfVoxels() const
{
  return static_cast<vtkIdType>(this->Dimensions[0]) * this->Dimensions[1] * this->Dimensions[2];
}

vtkIdType BenchmarkCase::GetNumberOfTetrahedra() const
{
  vtkUnstructuredGrid* mesh = vtkUnstructuredGrid::SafeDownCast(this->Deformation);
  return mesh ? mesh->GetNumberOfCells() : 0;
}
