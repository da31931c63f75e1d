// SPDX-License-Identifier: BSD-3-Clause
// A cuboid whose mesh is split in two parts. With OpenSplits the gap between parts that are pulled
// apart is as wide as their distance; without OpenSplits there is no gap. Both resamplers are
// tested.
#include "FilterTesting.h"

#include <vtkAppendFilter.h>
#include <vtkCellArray.h>
#include <vtkIdList.h>

#include <array>
#include <cmath>
#include <map>
#include <string>

using namespace filterTesting;

namespace
{

constexpr int Pull = 10; // voxels

// A volume, and a lattice that has a plane of nodes between two planes of voxels.
class Block
{
public:
  // voxelsPerEdge: the length of the edges of the lattice.
  Block(const std::array<int, 3>& dimensions, double voxelsPerEdge)
    : Volume(MakeImage({ { 0, dimensions[0] - 1, 0, dimensions[1] - 1, 0, dimensions[2] - 1 } },
        glm::dvec3(1.0, 0.5, 2.0)))
    , Middle(0.5 * dimensions[0] - 0.5)
  {
    AddScalars<short>(
      this->Volume, "value", [](const glm::dvec3& p) { return 50.0 + 10.0 * p.x + p.y; });
    const int cells = 2 * static_cast<int>(0.5 * dimensions[0] / voxelsPerEdge + 1.0);
    this->Mesh = MakeTetrahedra(
      { { this->Middle - 0.5 * cells * voxelsPerEdge, this->Middle + 0.5 * cells * voxelsPerEdge,
        -0.5, 0.5 * dimensions[1], -1.0, 2.0 * dimensions[2] } },
      { { cells + 1, 5, 4 } });
    SetDisplacements(this->Mesh, Shift(0.0, 0.0, 0.0));
  }

  // Splits the nodes of the plane whose world y is less than highestY: cells beyond the plane get
  // nodes of their own.
  void Cut(double highestY = 1e9)
  {
    std::map<vtkIdType, vtkIdType> twins;
    vtkPoints* points = this->Mesh->GetPoints();
    vtkDataArray* vectors = this->Mesh->GetPointData()->GetVectors();
    for (vtkIdType cell = 0; cell < this->Mesh->GetNumberOfCells(); ++cell)
    {
      vtkNew<vtkIdList> ids;
      this->Mesh->GetCellPoints(cell, ids);
      std::array<vtkIdType, 4> nodes;
      double x = 0.0;
      for (int k = 0; k < 4; ++k)
      {
        nodes[k] = ids->GetId(k);
        x += 0.25 * GetPoint(this->Mesh, nodes[k]).x;
      }
      for (vtkIdType& node : nodes)
      {
        const glm::dvec3 point = GetPoint(this->Mesh, node);
        if (x > this->Middle && std::abs(point.x - this->Middle) < 1e-6 && point.y < highestY)
        {
          const auto twin = twins.emplace(node, points->GetNumberOfPoints());
          if (twin.second)
          {
            points->InsertNextPoint(point.x, point.y, point.z);
            vectors->InsertNextTuple3(0.0, 0.0, 0.0);
          }
          node = twin.first->second;
        }
      }
      this->Mesh->GetCells()->ReplaceCellAtId(cell, 4, nodes.data());
    }
    this->FirstTwin = points->GetNumberOfPoints() - static_cast<vtkIdType>(twins.size());
    this->Mesh->GetCells()->Modified();
    points->Modified();
    vectors->Modified();
    this->Mesh->Modified();
  }

  void PullApart()
  {
    vtkDataArray* vectors = this->Mesh->GetPointData()->GetVectors();
    for (vtkIdType node = 0; node < this->Mesh->GetNumberOfPoints(); ++node)
    {
      const double x = GetPoint(this->Mesh, node).x;
      const bool beyond = x > this->Middle + 1e-6 || node >= this->FirstTwin;
      vectors->SetTuple3(node, beyond ? Pull : 0.0, 0.0, 0.0);
    }
    vectors->Modified();
  }

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  double Middle;
  vtkIdType FirstTwin = 0;
};

// The number of voxels in each row that are not covered, or -1 if it differs between rows.
int CountGap(vtkImageData* output)
{
  vtkDataArray* mask = output->GetPointData()->GetArray("vtkValidPointMask");
  const Extent extent = GetExtent(output);
  int gap = -2;
  for (int z = extent[4]; z <= extent[5]; ++z)
  {
    for (int y = extent[2]; y <= extent[3]; ++y)
    {
      int empty = 0;
      for (int x = extent[0]; x <= extent[1]; ++x)
      {
        int index[3] = { x, y, z };
        empty += mask->GetComponent(output->ComputePointId(index), 0) == 0.0;
      }
      gap = gap == -2 || gap == empty ? empty : -1;
    }
  }
  return gap;
}

void CheckPulledApart(const std::array<int, 3>& dimensions, double voxelsPerEdge)
{
  for (const int resampler :
    { vtkDeformVolumeFilter::EXACT, vtkDeformVolumeFilter::MESH_RASTERIZATION })
  {
    Block block(dimensions, voxelsPerEdge);
    Deformed tested(block.Volume, block.Mesh);
    tested.Filter->SetResampler(resampler);
    tested.Filter->OpenSplitsOn();
    const vtkIdType whole = block.Volume->GetNumberOfPoints();
    EXPECT_EQ(CountGap(tested.Update()), 0);
    block.Cut();
    // While the two parts touch, all voxels are covered, although the cells between them are not
    // drawn.
    EXPECT_EQ(CountGap(tested.Update()), 0);
    EXPECT_EQ(tested.Filter->GetNumberOfCoveredVoxels(), whole);
    block.PullApart();
    EXPECT_EQ(CountGap(tested.Update()), Pull);
    EXPECT_EQ(tested.Filter->GetNumberOfCoveredVoxels(), whole);
    // A split does not change positions at rest, so the static mapping is kept.
    EXPECT_EQ(GetReported(tested.Filter, "Static mappings made"),
      resampler == vtkDeformVolumeFilter::EXACT ? 1 : 0);
    if (resampler == vtkDeformVolumeFilter::EXACT)
    {
      tested.Filter->OpenSplitsOff();
      EXPECT_EQ(CountGap(tested.Update()), 0);
      EXPECT_EQ(
        tested.Filter->GetNumberOfCoveredVoxels(), whole + Pull * dimensions[1] * dimensions[2]);
      tested.Filter->OpenSplitsOn();
      EXPECT_EQ(CountGap(tested.Update()), Pull);
    }
  }
}

// A split that ends inside the volume: beyond its end there is no gap.
TEST(DeformSplits, Slit)
{
  Block block({ { 48, 40, 12 } }, 4.0);
  Deformed tested(block.Volume, block.Mesh);
  tested.Filter->SetResamplerToExact();
  tested.Filter->OpenSplitsOn();
  tested.Update();
  block.Cut(10.0);
  block.PullApart();
  vtkImageData* output = tested.Update();
  vtkDataArray* mask = output->GetPointData()->GetArray("vtkValidPointMask");
  const auto countEmpty = [&](int y)
  {
    int empty = 0;
    for (int x = 0; x < 48 + Pull; ++x)
    {
      int index[3] = { x, y, 6 };
      empty += mask->GetComponent(output->ComputePointId(index), 0) == 0.0;
    }
    return empty;
  };
  EXPECT_EQ(countEmpty(4), Pull);
  EXPECT_EQ(countEmpty(38), 0);
}

// Two bodies that touch, whose parts move apart. With different faces, the gap between them is
// empty; only tissue that follows the boundary of the mesh is stretched over it.
TEST(DeformSplits, Warning)
{
  const auto volume = MakeVolume({ { 0, 19, 0, 9, 0, 9 } });
  for (const bool areEqual : { true, false })
  {
    vtkNew<vtkAppendFilter> append;
    append->AddInputData(
      MakeTetrahedra({ { -1.0, 9.5, -1.0, 10.0, -1.0, 10.0 } }, { { 3, 3, 3 } }));
    append->AddInputData(MakeTetrahedra(
      { { 9.5, 20.0, -1.0, 10.0, -1.0, 10.0 } }, { { 3, areEqual ? 3 : 4, areEqual ? 3 : 5 } }));
    append->Update();
    vtkUnstructuredGrid* mesh = append->GetOutput();
    const vtkIdType first = 3 * 3 * 3;
    SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
    for (vtkIdType node = first; node < mesh->GetNumberOfPoints(); ++node)
    {
      mesh->GetPointData()->GetVectors()->SetTuple3(node, 5.0, 0.0, 0.0);
    }
    Deformed tested(volume, mesh);
    EXPECT_EQ(CountGap(tested.Expect(areEqual ? "is split" : "")), areEqual ? 0 : 5);
    Deformed extrapolated(volume, mesh);
    extrapolated.Filter->SetOutsideModeToExtrapolate();
    EXPECT_EQ(CountGap(extrapolated.Expect("is split")), 0);
  }
}

} // namespace

TEST(DeformSplits, PulledApart)
{
  CheckPulledApart({ { 40, 20, 10 } }, 4.0); // by runs
  CheckPulledApart({ { 40, 20, 10 } }, 1.5); // by links
}
