// SPDX-License-Identifier: BSD-3-Clause
// Ten-node tetrahedra, which are split around a derived node in the middle of each cell. The
// reference is a mesh of the same four-node tetrahedra in which the derived nodes are ordinary
// points.
#include "FilterTesting.h"
#include "MeshCells.h"
#include "TenNodeCells.h"
#include "UpdateChecks.h"

#include "vtkDeviceVectorArray.h"

#include <vtkArrayChanges.h>
#include <vtkBiQuadraticQuadraticWedge.h>
#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkLagrangeTetra.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkTriQuadraticHexahedron.h>

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>

using namespace filterTesting;
using deformvolume::Tetrahedron;

namespace
{

using Grid = vtkSmartPointer<vtkUnstructuredGrid>;

glm::dvec3 Curve(const glm::dvec3& p)
{
  const glm::dvec3 move(0.02 * p.y * p.y, 0.5 + 0.01 * p.z * p.x, 0.015 * p.x * p.x);
  return p + glm::round(64.0 * move) / 64.0;
}

Grid MakeCurvedTenNodes(vtkUnstructuredGrid* linear, bool separated = false)
{
  Grid grid = MakeTenNodes(linear, separated);
  SetDisplacements(grid, Curve);
  return grid;
}

// The same mesh with four-node tetrahedra. The derived nodes are appended to the points.
Grid MakeReference(vtkUnstructuredGrid* tenNodes)
{
  Grid grid = Grid::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> vectors;
  vectors->SetName("displacement");
  vectors->SetNumberOfComponents(3);
  for (vtkIdType id = 0; id < tenNodes->GetNumberOfPoints(); ++id)
  {
    points->InsertNextPoint(tenNodes->GetPoint(id));
    const glm::dvec3 vector = GetVector(tenNodes, id);
    vectors->InsertNextTuple(&vector.x);
  }
  for (vtkIdType cell = 0; cell < tenNodes->GetNumberOfCells(); ++cell)
  {
    vtkNew<vtkIdList> ids;
    tenNodes->GetCellPoints(cell, ids);
    glm::dvec3 point(0.0);
    glm::dvec3 vector(0.0);
    for (int i = 0; i < 10; ++i)
    {
      const double weight = i < 4 ? -0.125 : 0.25;
      point += weight * GetPoint(tenNodes, ids->GetId(i));
      vector += weight * GetVector(tenNodes, ids->GetId(i));
    }
    points->InsertNextPoint(&point.x);
    vectors->InsertNextTuple(&vector.x);
  }
  // Use the order of nodes of ReadCells(), because it affects the rounding of the affine maps.
  for (const Tetrahedron& nodes : deformvolume::ReadCells({ tenNodes }, { tenNodes }).Tetrahedra)
  {
    const vtkIdType ids[4] = { nodes[0], nodes[1], nodes[2], nodes[3] };
    grid->InsertNextCell(VTK_TETRA, 4, ids);
  }
  grid->SetPoints(points);
  grid->GetPointData()->SetVectors(vectors);
  return grid;
}

TEST(DeformCells, TenNodes)
{
  const auto volume = MakeVolume({ { 0, 15, 0, 15, 0, 15 } });
  const Grid mesh = MakeCurvedTenNodes(MakeMesh(volume));
  const Grid reference = MakeReference(mesh);
  Deformed expected(volume, reference);
  Deformed found(volume, mesh);
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, mesh);
  blocks->SetBlock(1, MakeReference(mesh)); // hidden by the first block, which it coincides with
  Deformed composite(volume, blocks);
  Deformed twoPorts(volume, MoveToDeformed(mesh));
  twoPorts.Filter->SetRestData(mesh);
  Deformed deformedPoints(volume, MoveToDeformed(mesh));
  deformedPoints.Filter->PointsAreDeformedOn();
  const auto compare = [&](const auto& set)
  {
    for (Deformed* one : { &expected, &found, &twoPorts, &deformedPoints, &composite })
    {
      set(one->Filter);
    }
    vtkImageData* output = expected.Update();
    EXPECT_GT(expected.Filter->GetNumberOfCoveredVoxels(), 100);
    for (Deformed* one : { &found, &twoPorts, &deformedPoints, &composite })
    {
      EXPECT_TRUE(AreEqual(output, one->Update()));
    }
  };
  compare([](vtkDeformVolumeFilter*) {});
  compare([](vtkDeformVolumeFilter* filter) { filter->SetOutsideModeToExtrapolate(); });
  compare(
    [](vtkDeformVolumeFilter* filter)
    {
      filter->SetOutsideModeToDiscard();
      filter->SetSamplingFactor(2);
    });
  compare(
    [](vtkDeformVolumeFilter* filter)
    {
      filter->SetSamplingFactor(1);
      filter->SetResamplerToMeshRasterization();
    });
  // Vectors of a device array.
  vtkNew<vtkDeviceVectorArray> array;
  array->SetName("displacement");
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(mesh->GetNumberOfPoints());
  for (vtkIdType id = 0; id < mesh->GetNumberOfPoints(); ++id)
  {
    array->SetTuple(id, mesh->GetPointData()->GetVectors()->GetTuple(id));
  }
  Grid other = Grid::New();
  other->ShallowCopy(mesh);
  other->GetPointData()->SetVectors(array);
  found.Filter->SetDeformationData(other);
  EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
}

// Updates after changes of displacements, with and without a log, and of the mesh at rest.
TEST(DeformCells, Updates)
{
  const auto volume = MakeVolume({ { 0, 47, 0, 47, 0, 47 } });
  const Grid mesh = MakeCurvedTenNodes(MakeMesh(volume, 5));
  Deformed tested(volume, mesh);
  tested.Filter->SetOutputBoundsModeToVolumeBounds();
  tested.Update();
  auto* vectors = mesh->GetPointData()->GetVectors();
  vtkNew<vtkArrayChanges> changes;
  changes->SetArray(vectors);
  int parts = 0;
  const auto check = [&](const std::string& what)
  {
    Deformed fresh(volume, MakeReference(mesh));
    fresh.Filter->SetOutputBoundsModeToVolumeBounds();
    CompareWithFresh(tested, fresh, what, parts);
  };
  for (const vtkIdType node : { 4, 3, 60, 200 })
  {
    vectors->SetComponent(node, 1, vectors->GetComponent(node, 1) + 0.75);
    changes->AddTuples(node, node);
    check("a node that was logged");
  }
  EXPECT_GT(parts, 2);
  vectors->SetComponent(77, 0, 1.5);
  vectors->Modified();
  check("a node that was not logged");
  const glm::dvec3 point = GetPoint(mesh, 100) + glm::dvec3(0.25, 0.125, -0.25);
  mesh->GetPoints()->SetPoint(100, &point.x);
  mesh->GetPoints()->Modified();
  check("another position at rest");
  // The mesh is split at a mid-side node of a cell: the cell gets a node of its own at that
  // position.
  const vtkIdType cell = mesh->GetNumberOfCells() / 2;
  vtkNew<vtkIdList> ids;
  mesh->GetCellPoints(cell, ids);
  const vtkIdType split = mesh->GetPoints()->InsertNextPoint(mesh->GetPoint(ids->GetId(7)));
  vectors->InsertNextTuple(ids->GetId(7), vectors);
  vectors->SetComponent(split, 0, vectors->GetComponent(split, 0) + 1.0);
  ids->SetId(7, split);
  mesh->GetCells()->ReplaceCellAtId(cell, ids);
  mesh->GetCells()->Modified();
  mesh->GetPoints()->Modified();
  vectors->Modified();
  mesh->Modified();
  check("a split");
  vtkNew<vtkCellArray> fewer;
  for (vtkIdType i = 0; i + 20 < mesh->GetNumberOfCells(); ++i)
  {
    mesh->GetCellPoints(i, ids);
    fewer->InsertNextCell(ids);
  }
  mesh->SetCells(VTK_QUADRATIC_TETRA, fewer);
  mesh->Modified();
  check("fewer cells");
  // Change to cells without mid-side nodes, to a field, and back.
  const Grid linear = MakeMesh(volume, 5);
  SetDisplacements(linear, Curve);
  tested.Filter->SetDeformationData(linear);
  Deformed fresh(volume, linear);
  fresh.Filter->SetOutputBoundsModeToVolumeBounds();
  CompareWithFresh(tested, fresh, "linear cells", parts);
  const auto field = MakeImage({ { 0, 47, 0, 47, 0, 47 } });
  SetDisplacements(field, Curve);
  tested.Filter->SetDeformationData(field);
  Deformed ofField(volume, field);
  ofField.Filter->SetOutputBoundsModeToVolumeBounds();
  CompareWithFresh(tested, ofField, "a field", parts);
  tested.Filter->SetDeformationData(mesh);
  check("the previous mesh again");
  vectors->SetComponent(5, 1, 1e5);
  vectors->Modified();
  tested.VerifyFailure("16,383");
}

// Cells that share no nodes, and move apart.
TEST(DeformCells, Splits)
{
  const auto volume = MakeVolume({ { 0, 15, 0, 15, 0, 15 } });
  const Grid mesh = MakeCurvedTenNodes(MakeMesh(volume), true);
  auto* vectors = mesh->GetPointData()->GetVectors();
  for (vtkIdType id = 0; id < mesh->GetNumberOfPoints(); ++id)
  {
    const double away = id / 10 % 2 == 0 ? 3.0 : 0.0; // ten nodes a cell
    vectors->SetComponent(id, 0, vectors->GetComponent(id, 0) + away);
  }
  Deformed expected(volume, MakeReference(mesh));
  Deformed found(volume, mesh);
  vtkIdType covered[2];
  for (const bool open : { false, true })
  {
    expected.Filter->SetOpenSplits(open);
    found.Filter->SetOpenSplits(open);
    EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
    covered[open ? 1 : 0] = found.Filter->GetNumberOfCoveredVoxels();
  }
  EXPECT_LT(covered[1], covered[0]);
}

// The root mean square of the differences between the displacements of voxels in one cell and those
// of a quadratic function.
double FindError(bool tenNodes, const std::array<glm::dvec3, 4>& corners, int kind)
{
  const auto move = [&](const glm::dvec3& p)
  {
    const double products[6] = { p.x * p.x, p.y * p.y, p.z * p.z, p.x * p.y, p.y * p.z, p.z * p.x };
    return 0.01 * products[kind];
  };
  // The values of the volume are x at rest, and it moves along x. Thus values of the output are
  // rest positions.
  auto volume = MakeImage({ { 0, 40, 0, 40, 0, 40 } });
  AddScalars<float>(volume, "value", [](const glm::dvec3& p) { return p.x; });
  Grid linear = Grid::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  const vtkIdType ids[4] = { 0, 1, 2, 3 };
  for (const glm::dvec3& corner : corners)
  {
    points->InsertNextPoint(&corner.x);
  }
  linear->SetPoints(points);
  linear->InsertNextCell(VTK_TETRA, 4, ids);
  const Grid mesh = tenNodes ? MakeTenNodes(linear) : linear;
  SetDisplacements(mesh, [&](const glm::dvec3& p) { return p + glm::dvec3(move(p), 0.0, 0.0); });
  Deformed deformed(volume, mesh);
  vtkImageData* output = deformed.Update();
  double sum = 0.0;
  int count = 0;
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    if (deformed.IsCovered(id))
    {
      const glm::dvec3 point = GetPoint(output, id);
      const double rest = deformed.GetValues()->GetComponent(id, 0);
      const double error = rest + move({ rest, point.y, point.z }) - point.x;
      sum += error * error;
      ++count;
    }
  }
  EXPECT_GT(count, 200);
  return std::sqrt(sum / count);
}

TEST(DeformCells, Accuracy)
{
  const std::array<glm::dvec3, 4> corners{ { { 4.3, 5.1, 6.2 }, { 35.7, 8.4, 3.3 },
    { 12.6, 36.2, 9.9 }, { 15.4, 12.8, 37.1 } } };
  double worst = 0.0;
  for (int kind = 0; kind < 6; ++kind)
  {
    worst = std::max(worst, FindError(true, corners, kind) / FindError(false, corners, kind));
  }
  std::cout << "Error relative to that of a four-node tetrahedron: " << worst << '\n';
  // The error of linear interpolation is proportional to the squares of edge lengths. In a regular
  // cell with edges of length 1, the edges of the twelve tetrahedra have the length 1 / 2, or
  // sqrt(1 / 8) if they end at the center. The bound is larger than 1 / 4, since the cells of this
  // test are not regular.
  EXPECT_LT(worst, 0.35);
}

// Mid-side nodes in another order than VTK's cause a warning.
TEST(DeformCells, MidSides)
{
  const auto volume = MakeVolume();
  const Grid mesh = MakeCurvedTenNodes(MakeMesh(volume));
  const vtkIdType cells = mesh->GetNumberOfCells();
  Deformed deformed(volume, mesh);
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeWarning(), "");
  for (vtkIdType cell = 0; cell < 7; ++cell)
  {
    vtkNew<vtkIdList> ids;
    mesh->GetCellPoints(cell, ids);
    std::swap(*(ids->begin() + 8), *(ids->begin() + 9));
    mesh->GetCells()->ReplaceCellAtId(cell, ids);
  }
  mesh->GetCells()->Modified();
  mesh->Modified();
  deformed.Filter->Update();
  const std::string warning = deformed.TakeWarning();
  EXPECT_TRUE(HasPart(warning, "7 of " + std::to_string(cells) + " quadratic cells"));
  deformed.Filter->Modified();
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeWarning(), "");
}

// Cells with nodes on faces in the order of other programs overlap themselves. Middles of edges are
// right.
TEST(DeformCells, OrderOfHigherOrderCells)
{
  const auto check = [](vtkCell* cell, const std::vector<vtkIdType>& order)
  {
    const Grid mesh = Grid::New();
    vtkNew<vtkPoints> points;
    const double* parameters = cell->GetParametricCoords();
    for (vtkIdType i = 0; i < cell->GetNumberOfPoints(); ++i)
    {
      points->InsertNextPoint(parameters + 3 * i);
    }
    mesh->SetPoints(points);
    std::vector<vtkIdType> ids(static_cast<std::size_t>(cell->GetNumberOfPoints()));
    for (const bool isWrong : { false, true })
    {
      std::iota(ids.begin(), ids.end(), 0);
      std::copy(order.begin(), isWrong ? order.end() : order.begin(),
        ids.end() - static_cast<std::ptrdiff_t>(order.size()));
      mesh->Reset();
      mesh->InsertNextCell(cell->GetCellType(), cell->GetNumberOfPoints(), ids.data());
      EXPECT_EQ(
        HasPart(deformvolume::ReadCells({ mesh }, { mesh }).WrongOrder, "1 of 1 cells"), isWrong)
        << cell->GetClassName();
    }
  };
  check(vtkNew<vtkTriQuadraticHexahedron>(), { 26, 24, 25, 22, 21, 23, 20 }); // as C3D27 of Abaqus
  check(vtkNew<vtkBiQuadraticQuadraticWedge>(), { 16, 17, 15 });
  vtkNew<vtkLagrangeTetra> tetrahedron;
  tetrahedron->GetPoints()->SetNumberOfPoints(10);
  tetrahedron->GetPointIds()->SetNumberOfIds(10);
  tetrahedron->Initialize();
  check(tetrahedron, { 9, 8 }); // as Gmsh
}

// A hexahedron with the nodes in the order of a voxel causes a warning. A turned, a mirrored and a
// flat one do not.
TEST(DeformCells, OrderOfHexahedra)
{
  const auto volume = MakeVolume();
  double bounds[6];
  volume->GetBounds(bounds);
  const std::pair<std::array<vtkIdType, 8>, bool> orders[] = {
    { { { 0, 1, 3, 2, 4, 5, 7, 6 } }, false }, { { { 1, 3, 2, 0, 5, 7, 6, 4 } }, false },
    { { { 0, 2, 3, 1, 4, 6, 7, 5 } }, false }, { { { 0, 1, 2, 3, 4, 5, 6, 7 } }, true }
  };
  for (const auto& [order, isWrong] : orders)
  {
    vtkNew<vtkPoints> points;
    for (int corner = 0; corner < 8; ++corner)
    {
      points->InsertNextPoint(
        bounds[corner & 1], bounds[2 + (corner >> 1 & 1)], bounds[4 + (corner >> 2)]);
    }
    const auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
    mesh->SetPoints(points);
    mesh->InsertNextCell(VTK_HEXAHEDRON, 8, order.data());
    SetDisplacements(mesh, Shift(0.5, 0.0, 0.0));
    Deformed deformed(volume, mesh);
    deformed.Filter->Update();
    const std::string warning = deformed.TakeWarning();
    EXPECT_EQ(HasPart(warning, "1 of 1 cells of the deformation mesh that are split"), isWrong);
    EXPECT_EQ(warning.empty(), !isWrong);
  }
  // Layers without thickness between two bodies.
  const Grid layers = MakeMesh(volume);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-5.0, 5.0);
  for (int layer = 0; layer < 200; ++layer)
  {
    const auto draw = [&] { return glm::dvec3(uniform(random), uniform(random), uniform(random)); };
    const glm::dvec3 corner = draw();
    const glm::dvec3 one = draw();
    const glm::dvec3 other = draw();
    vtkIdType nodes[8];
    for (int i = 0; i < 8; ++i)
    {
      const glm::dvec3 point = corner + (i % 4 == 1 || i % 4 == 2 ? one : glm::dvec3(0.0)) +
        (i % 4 >= 2 ? other : glm::dvec3(0.0));
      nodes[i] = layers->GetPoints()->InsertNextPoint(&point.x);
    }
    layers->InsertNextCell(VTK_HEXAHEDRON, 8, nodes);
  }
  const deformvolume::MeshCells cells = deformvolume::ReadCells({ layers }, { layers });
  EXPECT_EQ(cells.WrongOrder, std::string());
  EXPECT_GT(cells.Tetrahedra.size(), 1000);
}

} // namespace
