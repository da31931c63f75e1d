// SPDX-License-Identifier: BSD-3-Clause
// Lattices over boxes and volumes: misuse, then volumes, faces and positions, compared with closed
// forms.
#include "vtkLatticeTetrahedraSource.h"
#include "vtkMaterialFromVolume.h"

#include "MeshChecks.h"

#include <vtkCallbackCommand.h>
#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkPoints.h>
#include <vtkRTAnalyticSource.h>
#include <vtkSphereSource.h>

#include <algorithm>
#include <chrono>

using namespace meshChecks;

namespace
{

void SetRotation(vtkImageData* image, double sign)
{
  // A rotation that changes every axis. With the sign -1 the matrix is left-handed.
  const double m[9] = { 2.0 / 3, -1.0 / 3, 2.0 / 3 * sign, 2.0 / 3, 2.0 / 3, -1.0 / 3 * sign,
    -1.0 / 3, 2.0 / 3, 2.0 / 3 * sign };
  image->SetDirectionMatrix(m);
}

// Checks that the mesh is conforming: faces that belong to only one cell form the surface.
void VerifyConforming(vtkUnstructuredGrid* mesh, const int nodes[3])
{
  const Summary summary = Summarize(mesh);
  const int cells[3] = { nodes[0] - 1, nodes[1] - 1, nodes[2] - 1 };
  EXPECT_EQ(mesh->GetNumberOfPoints(), vtkIdType(nodes[0]) * nodes[1] * nodes[2]);
  EXPECT_EQ(mesh->GetNumberOfCells(), vtkIdType(5) * cells[0] * cells[1] * cells[2]);
  EXPECT_EQ(summary.OverusedFaces, 0);
  EXPECT_EQ(summary.OpenBoundaryEdges, 0);
  EXPECT_EQ(
    summary.BoundaryFaces, 4 * (cells[0] * cells[1] + cells[1] * cells[2] + cells[2] * cells[0]));
  EXPECT_GT(summary.SmallestVolume, 0.0);
}

TEST(LatticeTetrahedraSource, Misuse)
{
  vtkNew<vtkLatticeTetrahedraSource> source;
  FailureCheck check(source);
  source->SetBounds(0, 0, 0, 1, 0, 1);
  check.Fails("Bounds are empty");
  source->SetBounds(0, 1, 2, 1, 0, 1);
  check.Fails("Bounds are empty");
  source->SetBounds(0, std::nan(""), 0, 1, 0, 1);
  check.Fails("not finite");
  source->SetBounds(0, 1, 0, 1, 0, std::numeric_limits<double>::infinity());
  check.Fails("not finite");
  source->SetBounds(0, 1, 0, 1, 0, 1);
  source->SetNumberOfNodes(2, 1, 2);
  check.Fails("at least 2 nodes");
  source->SetNumberOfNodes(-5, 2, 2);
  check.Fails("at least 2 nodes");
  source->SetNumberOfNodes(100000, 100000, 100000);
  check.Fails("more than can be stored");
  source->SetNumberOfNodes(1 << 30, 2, 2);
  source->EqualSpacingOff();
  check.Fails("more than can be stored");
  source->SetNumberOfNodes(2, 2, 2);

  vtkNew<vtkImageData> slice;
  slice->SetExtent(3, 12, -4, 5, 7, 7);
  source->SetInputData(slice);
  check.Fails("fewer than two voxels on axis 2");
  vtkNew<vtkImageData> empty;
  source->SetInputData(empty);
  check.Fails("fewer than two voxels on axis 0");
  vtkNew<vtkImageData> flat;
  flat->SetDimensions(4, 4, 4);
  const double singular[9] = { 1, 0, 0, 0, 1, 1, 0, 0, 0 };
  flat->SetDirectionMatrix(singular);
  source->SetInputData(flat);
  check.Fails("one plane");
  vtkNew<vtkSphereSource> sphere;
  source->SetInputConnection(sphere->GetOutputPort());
  check.IsRefused("vtkImageData");

  source->SetInputConnection(nullptr);
  check.Succeeds();
  EXPECT_EQ(source->GetOutput()->GetNumberOfCells(), 5);
  source->SetMargin(-3.0);
  EXPECT_EQ(source->GetMargin(), 0.0);
}

TEST(LatticeTetrahedraSource, Box)
{
  vtkNew<vtkLatticeTetrahedraSource> source;
  int nodes[3];
  source->GetNumberOfNodes(nodes);
  EXPECT_TRUE(nodes[0] == 13 && nodes[1] == 13 && nodes[2] == 13);
  FailureCheck check(source);
  check.Succeeds();
  EXPECT_NEAR(Summarize(source->GetOutput()).Volume, 1.0, 1e-12);
  VerifyConforming(source->GetOutput(), nodes);
  EXPECT_EQ(source->GetOutput()->GetPoints()->GetDataType(), VTK_DOUBLE);

  source->EqualSpacingOff();
  const int uneven[3] = { 4, 2, 7 };
  source->SetNumberOfNodes(uneven[0], uneven[1], uneven[2]);
  source->SetBounds(-1, 5, 100, 101, -8, -5);
  check.Succeeds();
  vtkUnstructuredGrid* mesh = source->GetOutput();
  VerifyConforming(mesh, uneven);
  EXPECT_NEAR(Summarize(mesh).Volume, 18.0, 1e-11);
  // The volume of corner tetrahedra is one sixth of their cell, that of the central one, which is
  // the last one, is one third.
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    vtkNew<vtkUnstructuredGrid> one;
    one->SetPoints(mesh->GetPoints());
    one->Allocate(1);
    one->InsertNextCell(VTK_TETRA, mesh->GetCell(cell)->GetPointIds());
    EXPECT_NEAR(Summarize(one).Volume, cell % 5 == 4 ? 1.0 / 3 : 1.0 / 6, 1e-12);
  }

  source->SetMargin(0.5);
  check.Succeeds();
  double bounds[6];
  source->GetOutput()->GetBounds(bounds);
  const double expected[6] = { -1.5, 5.5, 99.5, 101.5, -8.5, -4.5 };
  for (int i = 0; i < 6; ++i)
  {
    EXPECT_NEAR(bounds[i], expected[i], 1e-12);
  }
}

TEST(LatticeTetrahedraSource, Volume)
{
  const int nodes[3] = { 5, 6, 3 };
  const int extent[6] = { -7, 12, 4, 9, -3, 20 };
  for (double sign : { 1.0, -1.0 })
  {
    vtkNew<vtkImageData> volume;
    volume->SetExtent(const_cast<int*>(extent));
    volume->SetOrigin(10.0, -20.0, 5.0);
    volume->SetSpacing(0.5, 2.0, 1.25);
    SetRotation(volume, sign);
    vtkNew<vtkLatticeTetrahedraSource> source;
    source->SetInputData(volume);
    source->SetNumberOfNodes(nodes[0], nodes[1], nodes[2]);
    source->EqualSpacingOff();
    FailureCheck check(source);
    check.Succeeds();
    vtkUnstructuredGrid* mesh = source->GetOutput();
    VerifyConforming(mesh, nodes);
    EXPECT_NEAR(Summarize(mesh).Volume, (19 * 0.5) * (5 * 2.0) * (23 * 1.25), 1e-9);
    // Compare each node with the transform of the volume.
    for (vtkIdType node = 0; node < mesh->GetNumberOfPoints(); ++node)
    {
      const vtkIdType ijk[3] = { node % nodes[0], node / nodes[0] % nodes[1],
        node / (nodes[0] * nodes[1]) };
      double index[3];
      for (int axis = 0; axis < 3; ++axis)
      {
        index[axis] = extent[2 * axis] +
          (extent[2 * axis + 1] - extent[2 * axis]) * static_cast<double>(ijk[axis]) /
            (nodes[axis] - 1);
      }
      double expected[3];
      double point[3];
      volume->TransformContinuousIndexToPhysicalPoint(index, expected);
      mesh->GetPoint(node, point);
      EXPECT_NEAR(
        std::hypot(expected[0] - point[0], expected[1] - point[1], expected[2] - point[2]), 0.0,
        1e-12);
    }
    source->SetMargin(2.0);
    check.Succeeds();
    EXPECT_NEAR(Summarize(source->GetOutput()).Volume,
      (19 * 0.5 + 4) * (5 * 2.0 + 4) * (23 * 1.25 + 4), 1e-9);
    // Without a volume the bounds are used again.
    source->SetInputData(nullptr);
    source->SetMargin(0.0);
    check.Succeeds();
    EXPECT_NEAR(Summarize(source->GetOutput()).Volume, 1.0, 1e-12);
  }
}

// A volume with two consumers: the request of the lattice source must not replace that of the
// consumer of both volume and lattice.
TEST(LatticeTetrahedraSource, SharedVolume)
{
  vtkNew<vtkRTAnalyticSource> volume;
  volume->SetWholeExtent(-3, 6, 2, 7, -4, 1);
  vtkNew<vtkLatticeTetrahedraSource> source;
  source->SetInputConnection(volume->GetOutputPort());
  vtkNew<vtkMaterialFromVolume> material;
  material->SetInputConnection(source->GetOutputPort());
  material->SetVolumeConnection(volume->GetOutputPort());
  FailureCheck check(material);
  for (int repeat = 0; repeat < 2; ++repeat)
  {
    check.Succeeds();
    EXPECT_EQ(volume->GetOutput()->GetNumberOfPoints(), 360);
    EXPECT_GT(material->GetOutput()->GetNumberOfCells(), 0);
    source->Modified();
    source->Update();
  }
}

// With EqualSpacing the cells are cubes. They cover the volume, and extend beyond it by the same
// distance on both sides.
TEST(LatticeTetrahedraSource, EqualSpacing)
{
  vtkNew<vtkLatticeTetrahedraSource> source;
  FailureCheck check(source);
  EXPECT_TRUE(source->GetEqualSpacing());
  EXPECT_EQ(source->GetDimensions()[0], 0);
  for (double sign : { 1.0, -1.0 })
  {
    vtkNew<vtkImageData> volume;
    const int extent[6] = { -7, 12, 4, 9, -3, 20 };
    volume->SetExtent(const_cast<int*>(extent));
    volume->SetOrigin(10.0, -20.0, 5.0);
    volume->SetSpacing(0.5, 2.0, 1.25);
    SetRotation(volume, sign);
    source->SetInputData(volume);
    source->SetNumberOfNodes(20, 6, 5);
    check.Succeeds();
    // The volume measures 9.5, 10 and 28.75 mm. Nodes on the axes would have distances of 0.5, 2
    // and 7.1875 mm; the largest is chosen.
    const int nodes[3] = { 3, 3, 5 };
    EXPECT_TRUE(std::equal(nodes, nodes + 3, source->GetDimensions()));
    VerifyConforming(source->GetOutput(), nodes);
    const double edge = 28.75 / 4.0;
    for (vtkIdType node = 0; node < source->GetOutput()->GetNumberOfPoints(); ++node)
    {
      const vtkIdType ijk[3] = { node % 3, node / 3 % 3, node / 9 };
      double index[3];
      for (int axis = 0; axis < 3; ++axis)
      {
        const double middle = 0.5 * (extent[2 * axis] + extent[2 * axis + 1]);
        index[axis] = middle +
          (static_cast<double>(ijk[axis]) - 0.5 * (nodes[axis] - 1)) * edge /
            volume->GetSpacing()[axis];
      }
      double expected[3];
      double point[3];
      volume->TransformContinuousIndexToPhysicalPoint(index, expected);
      source->GetOutput()->GetPoint(node, point);
      EXPECT_NEAR(
        std::hypot(expected[0] - point[0], expected[1] - point[1], expected[2] - point[2]), 0.0,
        1e-12);
    }
    source->SetMargin(3.0);
    check.Succeeds();
    // With the margin the lattice has to cover 15.5, 16 and 34.75 mm.
    EXPECT_TRUE(source->GetDimensions()[0] == 3 && source->GetDimensions()[2] == 5);
    EXPECT_NEAR(
      Summarize(source->GetOutput()).Volume, 2.0 * 2.0 * 4.0 * std::pow(34.75 / 4.0, 3), 1e-8);
    source->SetMargin(0.0);
  }
  // Rounding errors must not add cells: one third of 0.3 is not exact.
  source->SetInputData(nullptr);
  source->SetBounds(0.0, 0.1, 0.1, 0.4, 0.7, 1.0);
  source->SetNumberOfNodes(2, 4, 4);
  check.Succeeds();
  const int nodes[3] = { 2, 4, 4 };
  EXPECT_TRUE(std::equal(nodes, nodes + 3, source->GetDimensions()));
}

TEST(LatticeTetrahedraSource, Abort)
{
  vtkNew<vtkLatticeTetrahedraSource> source;
  vtkNew<vtkCallbackCommand> abort;
  abort->SetCallback(
    [](vtkObject* caller, unsigned long, void*, void* amount)
    {
      if (*static_cast<double*>(amount) > 0.4)
      {
        vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1);
      }
    });
  const unsigned long tag = source->AddObserver(vtkCommand::ProgressEvent, abort);
  source->Update();
  EXPECT_EQ(source->GetOutput()->GetNumberOfPoints(), 0);
  source->RemoveObserver(tag);
  source->SetAbortExecute(0);
  source->Update();
  EXPECT_NEAR(Summarize(source->GetOutput()).Volume, 1.0, 1e-12);
}

// The pieces together are the whole lattice.
TEST(LatticeTetrahedraSource, Pieces)
{
  vtkNew<vtkLatticeTetrahedraSource> source;
  vtkNew<vtkImageData> volume;
  volume->SetDimensions(4, 5, 6);
  source->EqualSpacingOff();
  for (vtkImageData* input : { static_cast<vtkImageData*>(nullptr), volume.Get() })
  {
    source->SetInputData(input);
    for (const int piece : { 2, 0, 1 })
    {
      source->UpdatePiece(piece, 3, 0);
      EXPECT_EQ(source->GetOutput()->GetNumberOfCells(), piece == 0 ? 5 * 12 * 12 * 12 : 0);
      EXPECT_EQ(source->GetOutput()->GetNumberOfPoints(), piece == 0 ? 13 * 13 * 13 : 0);
    }
  }
}

TEST(LatticeTetrahedraSource, Large)
{
  vtkNew<vtkLatticeTetrahedraSource> source;
  source->SetNumberOfNodes(80, 80, 80);
  const auto start = std::chrono::steady_clock::now();
  source->Update();
  const double seconds =
    std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::cout << "80 x 80 x 80 nodes: " << seconds << " s\n";
  vtkUnstructuredGrid* mesh = source->GetOutput();
  EXPECT_EQ(mesh->GetNumberOfPoints(), 512000);
  EXPECT_EQ(mesh->GetNumberOfCells(), 2465195);
  vtkIdType size;
  const vtkIdType* ids;
  mesh->GetCellPoints(2465194, size, ids);
  EXPECT_TRUE(size == 4 && *std::max_element(ids, ids + 4) < 512000);
}

} // namespace
