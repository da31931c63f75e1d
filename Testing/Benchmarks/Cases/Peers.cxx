// SPDX-License-Identifier: BSD-3-Clause
#include "Peers.h"

#include "Timing.h"

#include <vtkDataArray.h>
#include <vtkGridTransform.h>
#include <vtkImageData.h>
#include <vtkImageReslice.h>
#include <vtkLatticeTetrahedraSource.h>
#include <vtkMatrix4x4.h>
#include <vtkMatrixToLinearTransform.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkProbeFilter.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>

namespace
{
std::array<int, 3> GetDimensions(vtkImageData* volume)
{
  std::array<int, 3> dimensions;
  volume->GetDimensions(dimensions.data());
  return dimensions;
}

void SetUp(vtkImageReslice* reslice, vtkImageData* volume)
{
  reslice->SetInputData(volume);
  reslice->SetInterpolationModeToLinear();
  reslice->SetOutputOrigin(volume->GetOrigin());
  reslice->SetOutputSpacing(volume->GetSpacing());
}

class AffineReslice : public Peer
{
public:
  explicit AffineReslice(vtkImageData* volume)
    : Dimensions(GetDimensions(volume))
  {
    SetUp(this->Reslice, volume);
    this->Transform->SetInput(this->Matrix);
    this->Reslice->SetResliceTransform(this->Transform);
  }

  double Update(Pose, int step, const int extent[6]) override
  {
    const PoseMap map(Pose::General, this->Dimensions, step);
    std::copy(map.GetMatrix().begin(), map.GetMatrix().end(), this->Matrix->GetData());
    this->Matrix->Invert();
    this->Reslice->SetOutputExtent(
      extent[0], extent[1], extent[2], extent[3], extent[4], extent[5]);
    return Time([this]() { this->Reslice->Update(); });
  }

  vtkImageData* GetOutput() override { return this->Reslice->GetOutput(); }

private:
  std::array<int, 3> Dimensions;
  vtkNew<vtkImageReslice> Reslice;
  vtkNew<vtkMatrix4x4> Matrix;
  vtkNew<vtkMatrixToLinearTransform> Transform;
};

class GridReslice : public Peer
{
public:
  GridReslice(vtkImageData* volume, int nodesPerAxis, GridDirection direction)
    : Dimensions(GetDimensions(volume))
    , Sign(direction == GridDirection::Backward ? -1.0 : 1.0)
  {
    SetUp(this->Reslice, volume);
    this->Grid->SetDimensions(nodesPerAxis, nodesPerAxis, nodesPerAxis);
    double spacing[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      spacing[axis] = (this->Dimensions[axis] - 1.0) / (nodesPerAxis - 1.0);
    }
    this->Grid->SetSpacing(spacing);
    this->Grid->AllocateScalars(VTK_FLOAT, 3);
    this->Transform->SetDisplacementGridData(this->Grid);
    this->Transform->SetInterpolationModeToLinear();
    if (direction == GridDirection::Backward)
    {
      this->Reslice->SetResliceTransform(this->Transform);
    }
    else
    {
      this->Reslice->SetResliceTransform(this->Transform->GetInverse());
    }
  }

  double Update(Pose pose, int step, const int extent[6]) override
  {
    const PoseMap map(pose, this->Dimensions, step);
    auto* vector = static_cast<float*>(this->Grid->GetScalarPointer());
    for (vtkIdType node = 0; node < this->Grid->GetNumberOfPoints(); ++node)
    {
      std::array<double, 3> rest;
      this->Grid->GetPoint(node, rest.data());
      const auto moved = map(rest);
      for (int axis = 0; axis < 3; ++axis)
      {
        *vector++ = static_cast<float>(this->Sign * (moved[axis] - rest[axis]));
      }
    }
    this->Grid->Modified();
    this->Transform->Modified();
    this->Reslice->SetOutputExtent(
      extent[0], extent[1], extent[2], extent[3], extent[4], extent[5]);
    return Time([this]() { this->Reslice->Update(); });
  }

  vtkImageData* GetOutput() override { return this->Reslice->GetOutput(); }

private:
  std::array<int, 3> Dimensions;
  double Sign;
  vtkNew<vtkImageReslice> Reslice;
  vtkNew<vtkImageData> Grid;
  vtkNew<vtkGridTransform> Transform;
};

class ProbeChain : public Peer
{
public:
  ProbeChain(vtkImageData* volume, int nodesPerAxis)
    : Dimensions(GetDimensions(volume))
    , Volume(volume)
  {
    vtkNew<vtkLatticeTetrahedraSource> lattice;
    lattice->SetInputData(volume);
    lattice->SetNumberOfNodes(nodesPerAxis, nodesPerAxis, nodesPerAxis);
    lattice->EqualSpacingOff();
    lattice->Update();
    this->Mesh->DeepCopy(lattice->GetOutput());
    this->Rest = lattice->GetOutput()->GetPoints();
    this->Rest->GetData()->SetName("Rest");
    this->Mesh->GetPointData()->AddArray(this->Rest->GetData());
    this->FindRest->SetInputData(this->Voxels);
    this->FindRest->SetSourceData(this->Mesh);
    this->FindValue->SetInputData(this->RestPoints);
    this->FindValue->SetSourceData(volume);
    this->Output->SetOrigin(volume->GetOrigin());
    this->Output->SetSpacing(volume->GetSpacing());
    this->Voxels->CopyStructure(this->Output);
  }

  double Update(Pose pose, int step, const int extent[6]) override
  {
    const PoseMap map(pose, this->Dimensions, step);
    for (vtkIdType node = 0; node < this->Rest->GetNumberOfPoints(); ++node)
    {
      std::array<double, 3> rest;
      this->Rest->GetPoint(node, rest.data());
      this->Mesh->GetPoints()->SetPoint(node, map(rest).data());
    }
    this->Mesh->GetPoints()->Modified();
    this->Mesh->Modified();
    this->Voxels->SetExtent(const_cast<int*>(extent));
    this->Output->SetExtent(const_cast<int*>(extent));
    return Time(
      [this]()
      {
        this->FindRest->Update();
        vtkNew<vtkPoints> points;
        points->SetData(this->FindRest->GetOutput()->GetPointData()->GetArray("Rest"));
        this->RestPoints->SetPoints(points);
        this->FindValue->Update();
        this->Output->GetPointData()->SetScalars(
          this->FindValue->GetOutput()->GetPointData()->GetArray(
            this->Volume->GetPointData()->GetScalars()->GetName()));
      });
  }

  vtkImageData* GetOutput() override { return this->Output; }

private:
  std::array<int, 3> Dimensions;
  vtkSmartPointer<vtkImageData> Volume;
  vtkNew<vtkUnstructuredGrid> Mesh;
  vtkSmartPointer<vtkPoints> Rest;
  vtkNew<vtkImageData> Voxels;
  vtkNew<vtkProbeFilter> FindRest;
  vtkNew<vtkPolyData> RestPoints;
  vtkNew<vtkProbeFilter> FindValue;
  vtkNew<vtkImageData> Output;
};
}

std::unique_ptr<Peer> MakeAffineReslice(vtkImageData* volume)
{
  return std::make_unique<AffineReslice>(volume);
}

std::unique_ptr<Peer> MakeGridReslice(
  vtkImageData* volume, int nodesPerAxis, GridDirection direction)
{
  return std::make_unique<GridReslice>(volume, nodesPerAxis, direction);
}

std::unique_ptr<Peer> MakeProbeChain(vtkImageData* volume, int nodesPerAxis)
{
  return std::make_unique<ProbeChain>(volume, nodesPerAxis);
}
