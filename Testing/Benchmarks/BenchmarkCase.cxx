// SPDX-License-Identifier: BSD-3-Clause
#include "BenchmarkCase.h"

#include <vtkImageData.h>
#include <vtkLatticeTetrahedraSource.h>
#include <vtkPointData.h>
#include <vtkTransform.h>

#include <cmath>
#include <stdexcept>

namespace
{
vtkSmartPointer<vtkImageData> MakeVolume(const std::array<int, 3>& dimensions)
{
  auto volume = vtkSmartPointer<vtkImageData>::New();
  volume->SetDimensions(dimensions.data());
  volume->AllocateScalars(VTK_UNSIGNED_SHORT, 1);
  auto* value = static_cast<unsigned short*>(volume->GetScalarPointer());
  for (int z = 0; z < dimensions[2]; ++z)
  {
    for (int y = 0; y < dimensions[1]; ++y)
    {
      for (int x = 0; x < dimensions[0]; ++x)
      {
        const double wave = std::sin(0.11 * x) + std::sin(0.07 * y) + std::sin(0.05 * z);
        *value++ = static_cast<unsigned short>(2000.0 + 600.0 * wave);
      }
    }
  }
  return volume;
}
}

BenchmarkCase::BenchmarkCase(const std::array<int, 3>& dimensions, int nodesPerAxis)
  : Dimensions(dimensions)
{
  const auto volume = MakeVolume(dimensions);
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetInputData(volume);
  lattice->SetNumberOfNodes(nodesPerAxis, nodesPerAxis, nodesPerAxis);
  lattice->Update();
  this->Mesh = lattice->GetOutput();
  this->Displacements->SetName("Displacement");
  this->Displacements->SetNumberOfComponents(3);
  this->Displacements->SetNumberOfTuples(this->Mesh->GetNumberOfPoints());
  this->Mesh->GetPointData()->SetVectors(this->Displacements);
  this->Filter->SetInputData(volume);
  this->Filter->SetDeformationData(this->Mesh);
}

void BenchmarkCase::Move(Pose pose, double phase)
{
  const double center[3] = { 0.5 * (this->Dimensions[0] - 1), 0.5 * (this->Dimensions[1] - 1),
    0.5 * (this->Dimensions[2] - 1) };
  vtkNew<vtkTransform> transform;
  transform->Translate(center);
  transform->RotateX(7.0 + phase);
  transform->RotateY(7.0);
  transform->RotateZ(7.0);
  transform->Scale(1.03, 1.03, 1.03);
  transform->Translate(-center[0], -center[1], -center[2]);
  for (vtkIdType node = 0; node < this->Mesh->GetNumberOfPoints(); ++node)
  {
    double rest[3];
    this->Mesh->GetPoint(node, rest);
    double moved[3];
    if (pose == Pose::General)
    {
      transform->TransformPoint(rest, moved);
    }
    else
    {
      constexpr double amplitude = 12.0;
      moved[0] = rest[0] + amplitude * std::sin(0.02 * rest[1] + phase);
      moved[1] = rest[1] + amplitude * std::sin(0.02 * rest[2] + phase);
      moved[2] = rest[2] + amplitude * std::sin(0.02 * rest[0] + phase);
    }
    const double displacement[3] = { moved[0] - rest[0], moved[1] - rest[1], moved[2] - rest[2] };
    this->Displacements->SetTypedTuple(node, displacement);
  }
  this->Displacements->Modified();
  this->Mesh->Modified();
}

double BenchmarkCase::Update()
{
  this->Filter->Update();
  if (this->Filter->GetNumberOfCoveredVoxels() == 0)
  {
    throw std::runtime_error("the filter failed");
  }
  return this->Filter->GetMappingTime() + this->Filter->GetResamplingTime();
}

double BenchmarkCase::GetNumberOfVoxels() const
{
  return 1.0 * this->Dimensions[0] * this->Dimensions[1] * this->Dimensions[2];
}
