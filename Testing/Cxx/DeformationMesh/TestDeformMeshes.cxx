// SPDX-License-Identifier: BSD-3-Clause
// Meshes as other programs write them: nodes that no cell uses, blocks without displacements,
// structured and rectilinear grids, points that are deformed already, other length units, and
// warnings about vectors and tensors of the volume, which the filter does not rotate.
#include "ArrayMaking.h"
#include "FilterTesting.h"
#include "TenNodeCells.h"
#include "UpdateChecks.h"

#include <vtkArrayChanges.h>
#include <vtkCarveVolume.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkCompositeDataSet.h>
#include <vtkDeformGeometryFilter.h>
#include <vtkDoubleArray.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkPartitionedDataSet.h>
#include <vtkPartitionedDataSetCollection.h>
#include <vtkPolyData.h>
#include <vtkRectilinearGrid.h>
#include <vtkSphere.h>
#include <vtkStructuredGrid.h>
#include <vtkUnsignedCharArray.h>

#include <glm/common.hpp>

#include <algorithm>
#include <limits>

using namespace filterTesting;

namespace
{

using Grid = vtkSmartPointer<vtkUnstructuredGrid>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
const char* const name = "displacement";

glm::dvec3 Bend(const glm::dvec3& p)
{
  return p + glm::dvec3(0.4 * std::sin(0.5 * p.y), 0.3 * std::cos(0.4 * p.z), 1.0 + 0.03 * p.x);
}

// A copy of a mesh, with an additional first and last node that no cell uses.
Grid AddUnusedNodes(vtkUnstructuredGrid* mesh, const glm::dvec3& point, const glm::dvec3& vector)
{
  Grid more = Grid::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> vectors;
  vectors->SetName(name);
  vectors->SetNumberOfComponents(3);
  const auto add = [&]
  {
    points->InsertNextPoint(&point.x);
    vectors->InsertNextTuple(&vector.x);
  };
  add();
  for (vtkIdType id = 0; id < mesh->GetNumberOfPoints(); ++id)
  {
    points->InsertNextPoint(mesh->GetPoint(id));
    vectors->InsertNextTuple(mesh->GetPointData()->GetArray(name)->GetTuple(id));
  }
  add();
  more->SetPoints(points);
  more->GetPointData()->SetVectors(vectors);
  vtkNew<vtkCellArray> cells;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    vtkNew<vtkIdList> ids;
    mesh->GetCellPoints(cell, ids);
    for (vtkIdType& id : *ids)
    {
      ++id;
    }
    cells->InsertNextCell(ids);
  }
  more->SetCells(VTK_TETRA, cells);
  return more;
}

Grid MakeBentMesh(vtkImageData* volume)
{
  Grid mesh = MakeMesh(volume);
  SetDisplacements(mesh, Bend);
  return mesh;
}

TEST(DeformMeshes, UnusedNodes)
{
  const auto volume = MakeVolume();
  const Grid mesh = MakeBentMesh(volume);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const auto& [place, vector] :
    { std::pair(glm::dvec3(50.0), glm::dvec3(nan)), std::pair(glm::dvec3(nan), glm::dvec3(0.0)),
      std::pair(glm::dvec3(1.0, infinity, nan), glm::dvec3(nan, 0.0, -infinity)),
      std::pair(glm::dvec3(50.0), glm::dvec3(1e30, 0.0, 0.0)) })
  {
    const Grid more = AddUnusedNodes(mesh, place, vector);
    vtkNew<vtkMultiBlockDataSet> inner;
    inner->SetBlock(1, more);
    vtkNew<vtkMultiBlockDataSet> blocks;
    blocks->SetBlock(0, vtkNew<vtkUnstructuredGrid>());
    blocks->SetBlock(1, inner);
    Deformed expected(volume, mesh);
    Deformed found(volume, more);
    Deformed composite(volume, blocks);
    Deformed twoPorts(volume, MoveToDeformed(more));
    twoPorts.Filter->SetRestData(more);
    Deformed expectedOfTwo(volume, MoveToDeformed(mesh));
    expectedOfTwo.Filter->SetRestData(mesh);
    const auto compare = [&](const auto& set)
    {
      for (Deformed* one : { &expected, &found, &composite, &twoPorts, &expectedOfTwo })
      {
        set(one->Filter);
      }
      vtkImageData* output = expected.Update();
      EXPECT_GT(expected.Filter->GetNumberOfCoveredVoxels(), 300);
      EXPECT_TRUE(AreEqual(output, found.Update()));
      EXPECT_TRUE(AreEqual(output, composite.Update()));
      EXPECT_TRUE(AreEqual(expectedOfTwo.Update(), twoPorts.Update()));
    };
    compare([](vtkDeformVolumeFilter*) {});
    compare([](vtkDeformVolumeFilter* filter) { filter->SetBoundsGranularity(8); });
    compare([](vtkDeformVolumeFilter* filter) { filter->OpenSplitsOn(); });
    compare([](vtkDeformVolumeFilter* filter) { filter->SetOutsideModeToExtrapolate(); });
    compare(
      [](vtkDeformVolumeFilter* filter)
      {
        filter->SetOutsideModeToDiscard();
        filter->SetResamplerToMeshRasterization();
      });
    compare([](vtkDeformVolumeFilter* filter) { filter->SetOutputBoundsModeToVolumeBounds(); });
  }
}

// Partial updates of a mesh with unused nodes, and a cell that begins to use one of these nodes.
TEST(DeformMeshes, UnusedNodesThatChange)
{
  const auto volume = MakeVolume({ { 0, 40, 0, 40, 0, 40 } });
  const Grid mesh = MakeBentMesh(volume);
  const Grid more = AddUnusedNodes(mesh, glm::dvec3(nan), glm::dvec3(nan));
  Deformed tested(volume, more);
  tested.Filter->SetBoundsGranularity(16);
  tested.Update();
  int parts = 0;
  auto* vectors = more->GetPointData()->GetArray(name);
  const vtkIdType last = more->GetNumberOfPoints() - 1;
  for (int step = 0; step < 4; ++step)
  {
    vectors->SetComponent(1, 2, 1.0 + 0.1 * step);
    vectors->SetComponent(last, 2, step == 2 ? 1.0 : nan);
    vectors->Modified();
    Deformed fresh(volume, more);
    fresh.Filter->SetOutputBoundsModeToCustomBounds();
    fresh.Filter->SetCustomBounds(tested.Filter->GetOutput()->GetBounds());
    tested.Update();
    fresh.Filter->SetCustomBounds(tested.Filter->GetOutput()->GetBounds());
    CompareWithFresh(tested, fresh, "a step of a mesh with unused nodes", parts);
  }
  EXPECT_GT(parts, 1);
  // A node of the last cell is replaced by the last node, whose position and displacement are then
  // set to valid values.
  vtkNew<vtkIdList> before;
  const vtkIdType cell = more->GetNumberOfCells() - 1;
  more->GetCellPoints(cell, before);
  vtkNew<vtkIdList> after;
  after->DeepCopy(before);
  after->SetId(0, last);
  more->GetCells()->ReplaceCellAtId(cell, after);
  more->GetCells()->Modified();
  more->Modified();
  tested.VerifyFailure("Point " + std::to_string(last) + " of the deformation mesh");
  more->GetPoints()->SetPoint(last, more->GetPoint(before->GetId(0)));
  more->GetPoints()->Modified();
  tested.VerifyFailure("Displacement " + std::to_string(last) + " of the deformation mesh");
  vectors->SetTuple(last, before->GetId(0), vectors);
  vectors->SetComponent(last, 0, 1e30);
  vectors->Modified();
  tested.VerifyFailure("more than 16,383 output voxels");
  vectors->SetTuple(last, before->GetId(0), vectors);
  vectors->Modified();
  Deformed fresh(volume, more);
  fresh.Filter->SetBoundsGranularity(16);
  tested.Filter->SetBoundsGranularity(15);
  tested.Update();
  tested.Filter->SetBoundsGranularity(16);
  CompareWithFresh(tested, fresh, "the use of a node", parts);
}

// Nodes that are added or removed move the derived nodes of other cells, which are the same.
TEST(DeformMeshes, NodesBesideDerivedNodes)
{
  const auto volume = MakeVolume({ { 0, 12, 0, 12, 0, 12 } });
  const Grid mesh = MakeTenNodes(MakeMesh(volume));
  SetDisplacements(mesh, Bend);
  const Grid more = Grid::New();
  more->DeepCopy(mesh);
  for (int i = 0; i < 3; ++i)
  {
    more->GetPoints()->InsertNextPoint(6.0, 6.0, 6.0);
    more->GetPointData()->GetVectors()->InsertNextTuple3(0.0, 0.0, 0.0);
  }
  vtkNew<vtkMultiBlockDataSet> one;
  one->SetBlock(0, mesh);
  vtkNew<vtkMultiBlockDataSet> two;
  two->SetBlock(0, mesh);
  two->SetBlock(1, MakeBentMesh(volume));
  Deformed tested(volume, mesh);
  tested.Update();
  int parts = 0;
  for (vtkDataObject* next : std::initializer_list<vtkDataObject*>{ more, mesh, one, two, one })
  {
    tested.Filter->SetDeformationData(next);
    Deformed fresh(volume, next);
    CompareWithFresh(tested, fresh, next->GetClassName(), parts);
  }
}

Grid MakeShells()
{
  Grid shells = Grid::New();
  vtkNew<vtkPoints> points;
  for (const glm::dvec3& p :
    { glm::dvec3(0, 0, 0), glm::dvec3(1, 0, 0), glm::dvec3(1, 1, 0), glm::dvec3(0, 1, 0) })
  {
    points->InsertNextPoint(&p.x);
  }
  shells->SetPoints(points);
  const vtkIdType quad[4] = { 0, 1, 2, 3 };
  shells->InsertNextCell(VTK_QUAD, 4, quad);
  return shells;
}

// SetArray() replaces the values of displacements and of points without changing a modification
// time.
TEST(DeformMeshes, ReplacedValues)
{
  const auto volume = MakeVolume();
  for (const bool ofPoints : { false, true })
  {
    const Grid mesh = MakeBentMesh(volume);
    const Grid rest = Grid::New();
    rest->DeepCopy(mesh);
    Deformed tested(volume, mesh);
    Deformed expected(volume, mesh);
    for (Deformed* deformed : { &tested, &expected })
    {
      deformed->Filter->SetRestData(ofPoints ? rest : nullptr);
      deformed->Filter->SetOutputBoundsModeToVolumeBounds();
    }
    tested.Update();
    vtkDataArray* array =
      ofPoints ? mesh->GetPoints()->GetData() : mesh->GetPointData()->GetVectors();
    const auto moved = vtkSmartPointer<vtkDataArray>::Take(array->NewInstance());
    moved->DeepCopy(array);
    for (vtkIdType id = 0; id < moved->GetNumberOfTuples(); ++id)
    {
      moved->SetComponent(id, 0, moved->GetComponent(id, 0) + 0.25);
    }
    array->SetVoidArray(moved->GetVoidPointer(0), array->GetNumberOfValues(), 1);
    tested.Filter->Modified();
    EXPECT_TRUE(AreEqual(expected.Update(), tested.Update()));
  }
}

TEST(DeformMeshes, WrongData)
{
  const auto volume = MakeVolume();
  Deformed surface(volume, vtkNew<vtkPolyData>());
  surface.VerifyFailure("The deformation mesh is a vtkPolyData. Connect a vtkUnstructuredGrid");
  const Grid mesh = Grid::New();
  mesh->DeepCopy(MakeBentMesh(volume));
  const auto array = MakeArray<vtkDoubleArray>(name, mesh->GetNumberOfCells(), 3);
  array->Fill(1.0);
  mesh->GetCellData()->AddArray(array);
  mesh->GetPointData()->Initialize();
  Deformed(volume, mesh)
    .VerifyFailure(
      "It has no point arrays. Cell arrays are not used: \"displacement\". To use one, "
      "convert it with vtkCellDataToPointData");
}

TEST(DeformMeshes, Blocks)
{
  const auto volume = MakeVolume();
  const Grid mesh = MakeBentMesh(volume);
  Deformed expected(volume, mesh);
  vtkImageData* output = expected.Update();
  const Grid solids = Grid::New();
  solids->DeepCopy(mesh);
  solids->GetPointData()->Initialize();
  // In other blocks an array of this name may contain something else.
  const Grid other = MakeShells();
  const auto thickness = MakeArray<vtkDoubleArray>(name, other->GetNumberOfPoints());
  thickness->Fill(2.0);
  other->GetPointData()->AddArray(thickness);
  for (const Grid& shells : { MakeShells(), other })
  {
    for (const unsigned int first : { 0U, 1U })
    {
      vtkNew<vtkMultiBlockDataSet> blocks;
      blocks->SetBlock(first, mesh);
      blocks->SetBlock(1 - first, shells);
      Deformed found(volume, blocks);
      found.Filter->SetInputArrayToProcess(0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, name);
      found.Filter->Update();
      EXPECT_TRUE(HasPart(found.TakeWarning(), "1 quad"));
      EXPECT_TRUE(AreEqual(output, found.Update()));
      // A block that contains solid cells needs displacements.
      blocks->SetBlock(1 - first, solids);
      found.VerifyFailure("The block with flat index " + std::to_string(2 - first) +
        " of the deformation mesh has no point array \"displacement\"");
      blocks->GetMetaData(1 - first)->Set(vtkCompositeDataSet::NAME(), "liver");
      blocks->Modified();
      found.VerifyFailure("Block \"liver\" of the deformation mesh has no point array");
      blocks->SetBlock(1 - first, shells);
      EXPECT_TRUE(AreEqual(output, found.Update()));
    }
  }
  vtkNew<vtkPartitionedDataSetCollection> collection;
  collection->SetPartition(0, 0, mesh);
  collection->SetPartition(1, 0, solids);
  collection->GetMetaData(1)->Set(vtkCompositeDataSet::NAME(), "bone");
  Deformed named(volume, collection);
  named.VerifyFailure("Block \"bone\" of the deformation mesh");
  // The error has the index of the node in its block.
  solids->GetPointData()->ShallowCopy(mesh->GetPointData());
  const Grid spoilt = Grid::New();
  spoilt->DeepCopy(mesh);
  spoilt->GetPointData()->GetArray(name)->SetComponent(3, 1, nan);
  collection->SetPartition(1, 0, spoilt);
  collection->Modified();
  named.VerifyFailure("Displacement 3 of block \"bone\" of the deformation mesh");
}

// The number of nodes of a grid on each axis. They are unevenly spaced.
const std::array<int, 3> nodes{ { 4, 5, 3 } };
double GetCoordinate(int axis, int i)
{
  return -0.5 + 10.0 * std::pow(i / (nodes[axis] - 1.0), 1.2);
}

vtkSmartPointer<vtkRectilinearGrid> MakeRectilinearGrid()
{
  auto grid = vtkSmartPointer<vtkRectilinearGrid>::New();
  grid->SetDimensions(nodes.data());
  vtkNew<vtkDoubleArray> coordinates[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int i = 0; i < nodes[axis]; ++i)
    {
      coordinates[axis]->InsertNextValue(GetCoordinate(axis, i));
    }
  }
  grid->SetXCoordinates(coordinates[0]);
  grid->SetYCoordinates(coordinates[1]);
  grid->SetZCoordinates(coordinates[2]);
  return grid;
}

glm::dvec3 Skew(const glm::dvec3& p)
{
  return p + glm::dvec3(0.3 * std::sin(p.y), 0.05 * p.x, 0.2 * std::cos(0.4 * p.x));
}

vtkSmartPointer<vtkStructuredGrid> MakeStructuredGrid()
{
  auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  grid->SetDimensions(nodes.data());
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int k = 0; k < nodes[2]; ++k)
  {
    for (int j = 0; j < nodes[1]; ++j)
    {
      for (int i = 0; i < nodes[0]; ++i)
      {
        const glm::dvec3 p =
          Skew({ GetCoordinate(0, i), GetCoordinate(1, j), GetCoordinate(2, k) });
        points->InsertNextPoint(&p.x);
      }
    }
  }
  grid->SetPoints(points);
  return grid;
}

// The cells of a grid as hexahedra, without some of them.
Grid MakeHexahedra(vtkDataSet* grid, const std::function<bool(int cell)>& isLeftOut)
{
  Grid hexahedra = Grid::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType id = 0; id < grid->GetNumberOfPoints(); ++id)
  {
    points->InsertNextPoint(grid->GetPoint(id));
  }
  hexahedra->SetPoints(points);
  hexahedra->GetPointData()->ShallowCopy(grid->GetPointData());
  int cell = 0;
  for (int k = 0; k + 1 < nodes[2]; ++k)
  {
    for (int j = 0; j + 1 < nodes[1]; ++j)
    {
      for (int i = 0; i + 1 < nodes[0]; ++i, ++cell)
      {
        const vtkIdType first = i + nodes[0] * (j + nodes[1] * k);
        const vtkIdType row = nodes[0];
        const vtkIdType layer = row * nodes[1];
        const vtkIdType ids[8] = { first, first + 1, first + 1 + row, first + row, first + layer,
          first + 1 + layer, first + 1 + row + layer, first + row + layer };
        if (!isLeftOut(cell))
        {
          hexahedra->InsertNextCell(VTK_HEXAHEDRON, 8, ids);
        }
      }
    }
  }
  return hexahedra;
}

vtkSmartPointer<vtkUnsignedCharArray> AddGhosts(vtkDataSetAttributes* attributes, vtkIdType count)
{
  auto ghosts = vtkSmartPointer<vtkUnsignedCharArray>::New();
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  ghosts->SetNumberOfValues(count);
  ghosts->Fill(0);
  attributes->AddArray(ghosts);
  return ghosts;
}

void TestGrid(vtkDataSet* grid)
{
  const auto volume = MakeVolume();
  SetDisplacements(grid, Bend);
  const Grid whole = MakeHexahedra(grid, [](int) { return false; });
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, MakeShells());
  blocks->SetBlock(1, grid);
  Deformed expected(volume, whole);
  Deformed found(volume, grid);
  Deformed composite(volume, blocks);
  for (const int resampler :
    { vtkDeformVolumeFilter::EXACT, vtkDeformVolumeFilter::MESH_RASTERIZATION })
  {
    for (Deformed* one : { &expected, &found, &composite })
    {
      one->Filter->SetResampler(resampler);
    }
    vtkImageData* output = expected.Update();
    EXPECT_GT(expected.Filter->GetNumberOfCoveredVoxels(), 500);
    EXPECT_TRUE(AreEqual(output, found.Update()));
    EXPECT_TRUE(AreEqual(output, composite.Update()));
  }
  for (Deformed* one : { &expected, &found })
  {
    one->Filter->SetResamplerToExact();
    one->Update();
  }
  // Changed displacements are detected, and the static mapping is kept.
  auto* vectors = grid->GetPointData()->GetVectors();
  vtkNew<vtkArrayChanges> changes;
  changes->SetArray(vectors);
  const vtkTypeInt64 builds = GetReported(found.Filter, "Static mappings made");
  vectors->SetComponent(17, 0, 0.6);
  changes->AddTuples(17, 17);
  EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
  EXPECT_EQ(GetReported(found.Filter, "Static mappings made"), builds);
  // A deformed mesh and a mesh at rest.
  vtkNew<vtkStructuredGrid> moved;
  moved->SetDimensions(nodes.data());
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType id = 0; id < grid->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 p = Bend(GetPoint(grid, id));
    points->InsertNextPoint(&p.x);
  }
  moved->SetPoints(points);
  Deformed two(volume, moved);
  two.Filter->SetRestData(vtkStructuredGrid::SafeDownCast(grid) ? grid : whole.Get());
  Deformed expectedOfTwo(volume, MakeHexahedra(moved, [](int) { return false; }));
  expectedOfTwo.Filter->SetRestData(whole);
  EXPECT_TRUE(AreEqual(expectedOfTwo.Update(), two.Update()));
  // Blanked cells, and cells of blanked points.
  const auto cellGhosts = AddGhosts(grid->GetCellData(), grid->GetNumberOfCells());
  cellGhosts->SetValue(3, vtkDataSetAttributes::HIDDENCELL);
  grid->Modified();
  Deformed expectedWithout(volume, MakeHexahedra(grid, [](int cell) { return cell == 3; }));
  EXPECT_TRUE(AreEqual(expectedWithout.Update(), found.Update()));
  EXPECT_LT(found.Filter->GetNumberOfCoveredVoxels(), expected.Filter->GetNumberOfCoveredVoxels());
  cellGhosts->SetValue(3, 0);
  cellGhosts->SetValue(10, vtkDataSetAttributes::DUPLICATECELL);
  cellGhosts->Modified();
  expectedWithout.Filter->SetDeformationData(
    MakeHexahedra(grid, [](int cell) { return cell == 10; }));
  EXPECT_TRUE(AreEqual(expectedWithout.Update(), found.Update()));
  cellGhosts->SetValue(10, 0);
  cellGhosts->Modified();
  const auto pointGhosts = AddGhosts(grid->GetPointData(), grid->GetNumberOfPoints());
  pointGhosts->SetValue(1, vtkDataSetAttributes::HIDDENPOINT);
  expectedWithout.Filter->SetDeformationData(
    MakeHexahedra(grid, [](int cell) { return cell < 2; }));
  EXPECT_TRUE(AreEqual(expectedWithout.Update(), found.Update()));
  pointGhosts->SetValue(1, 0);
  pointGhosts->Modified();
  EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
}

// Hidden points of an unstructured grid: cells that use them are left out, and their displacements
// need not be finite.
TEST(DeformMeshes, HiddenPoints)
{
  const auto volume = MakeVolume();
  const auto grid = MakeRectilinearGrid();
  SetDisplacements(grid, Bend);
  const Grid mesh = MakeHexahedra(grid, [](int) { return false; });
  Deformed found(volume, mesh);
  const auto all = vtkSmartPointer<vtkImageData>::New();
  all->DeepCopy(found.Update());
  vtkNew<vtkDoubleArray> vectors;
  vectors->DeepCopy(mesh->GetPointData()->GetVectors());
  vectors->SetComponent(0, 1, std::numeric_limits<double>::quiet_NaN());
  mesh->GetPointData()->SetVectors(vectors);
  const auto ghosts = AddGhosts(mesh->GetPointData(), mesh->GetNumberOfPoints());
  ghosts->Fill(vtkDataSetAttributes::DUPLICATEPOINT); // no reason to leave cells out
  ghosts->SetValue(0, vtkDataSetAttributes::HIDDENPOINT);
  Deformed expected(volume, MakeHexahedra(grid, [](int cell) { return cell == 0; }));
  EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
  mesh->GetPointData()->RemoveArray(ghosts->GetName());
  const auto valid = AddGhosts(mesh->GetPointData(), mesh->GetNumberOfPoints());
  valid->SetName("vtkValidPointMask");
  valid->Fill(1);
  valid->SetValue(0, 0);
  EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
  // A change of the mask is noticed.
  vectors->SetComponent(0, 1, grid->GetPointData()->GetVectors()->GetComponent(0, 1));
  vectors->Modified();
  valid->SetValue(0, 1);
  valid->Modified();
  EXPECT_TRUE(AreEqual(all, found.Update()));
}

// Two blocks of hexahedra meet at a curved face. Each has points of its own there, in another
// order. apart: the distance of the second block from the first one.
vtkSmartPointer<vtkMultiBlockDataSet> MakeMeetingBlocks(vtkUnstructuredGrid* whole, double apart)
{
  auto blocks = vtkSmartPointer<vtkMultiBlockDataSet>::New();
  const vtkIdType count = whole->GetNumberOfPoints();
  for (const bool second : { false, true })
  {
    const auto number = [&](vtkIdType id) { return second ? 7 * id % count : id; };
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(count);
    for (vtkIdType id = 0; id < count; ++id)
    {
      const glm::dvec3 point = GetPoint(whole, id) + glm::dvec3(0.0, 0.0, second ? apart : 0.0);
      points->SetPoint(number(id), &point.x);
    }
    vtkNew<vtkUnstructuredGrid> block;
    block->SetPoints(points);
    for (vtkIdType cell = 0; cell < whole->GetNumberOfCells(); ++cell)
    {
      if (second != (2 * cell >= whole->GetNumberOfCells()))
      {
        continue;
      }
      vtkNew<vtkIdList> ids;
      whole->GetCellPoints(cell, ids);
      std::transform(ids->begin(), ids->end(), ids->begin(), number);
      block->InsertNextCell(whole->GetCellType(cell), ids);
    }
    SetDisplacements(block, Shift(0.0, 0.5, 0.0));
    blocks->SetBlock(second ? 1 : 0, block);
  }
  return blocks;
}

TEST(DeformMeshes, MeetingBlocks)
{
  const auto volume = MakeVolume({ { 0, 39, 0, 39, 0, 39 } });
  const auto curved = MakeStructuredGrid();
  MovePoints(curved,
    [](const glm::dvec3& p)
    {
      const double height = 0.8 * std::sin(2.0 * p.x) * std::cos(1.5 * p.y);
      return 4.0 * (p + glm::dvec3(0.0, 0.0, height));
    });
  const Grid whole = MakeHexahedra(curved, [](int) { return false; });
  SetDisplacements(whole, Shift(0.0, 0.5, 0.0));
  Deformed expected(volume, whole);
  expected.Update();
  // Points that move can begin to coincide.
  const auto blocks = MakeMeetingBlocks(whole, 9.0);
  Deformed found(volume, blocks);
  found.Update();
  EXPECT_NE(found.Filter->GetNumberOfCoveredVoxels(), expected.Filter->GetNumberOfCoveredVoxels());
  auto* second = vtkUnstructuredGrid::SafeDownCast(blocks->GetBlock(1));
  second->GetPoints()->DeepCopy(
    vtkUnstructuredGrid::SafeDownCast(MakeMeetingBlocks(whole, 0.0)->GetBlock(1))->GetPoints());
  second->GetPoints()->Modified();
  blocks->Modified();
  found.Update();
  EXPECT_EQ(found.Filter->GetNumberOfCoveredVoxels(), expected.Filter->GetNumberOfCoveredVoxels());
  // An update that fails, and one that succeeds.
  const vtkIdType used = second->GetCell(0)->GetPointId(0);
  double point[3];
  second->GetPoint(used, point);
  second->GetPoints()->SetPoint(used, nan, 0.0, 0.0);
  second->GetPoints()->Modified();
  blocks->Modified();
  found.VerifyFailure("is not finite");
  second->GetPoints()->SetPoint(used, point);
  second->GetPoints()->Modified();
  blocks->Modified();
  vtkImageData* output = found.Update();
  // The other two ways to give the mesh at rest and deformed.
  vtkNew<vtkMultiBlockDataSet> moved;
  for (unsigned int i = 0; i < 2; ++i)
  {
    moved->SetBlock(i, MoveToDeformed(vtkUnstructuredGrid::SafeDownCast(blocks->GetBlock(i))));
  }
  Deformed two(volume, moved);
  two.Filter->SetRestData(blocks);
  EXPECT_TRUE(AreEqual(output, two.Update()));
  Deformed deformedPoints(volume, moved);
  deformedPoints.Filter->PointsAreDeformedOn();
  deformedPoints.Update();
  EXPECT_EQ(
    deformedPoints.Filter->GetNumberOfCoveredVoxels(), expected.Filter->GetNumberOfCoveredVoxels());
}

// Arrays of blocks and coordinates that are written in place, and marked as modified.
TEST(DeformMeshes, PartsWrittenInPlace)
{
  const auto volume = MakeVolume();
  const Grid mesh = MakeBentMesh(volume);
  const auto straight = MakeRectilinearGrid();
  SetDisplacements(straight, Bend);
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, mesh);
  vtkNew<vtkMultiBlockDataSet> straightBlocks;
  straightBlocks->SetBlock(1, straight);
  const struct
  {
    vtkDataObject* Shape;
    vtkDataArray* Written;
  } cases[] = { { blocks, mesh->GetPointData()->GetVectors() },
    { blocks, mesh->GetPoints()->GetData() }, { straight, straight->GetYCoordinates() },
    { straightBlocks, straight->GetZCoordinates() } };
  for (const auto& [shape, written] : cases)
  {
    Deformed tested(volume, shape);
    vtkNew<vtkDeformGeometryFilter> geometry;
    geometry->SetInputData(mesh);
    geometry->SetDeformationData(shape);
    vtkNew<vtkCarveVolume> carve;
    carve->SetInputData(volume);
    carve->SetDeformationData(shape);
    for (int update = 0; update < 2; ++update)
    {
      Deformed fresh(volume, shape);
      EXPECT_TRUE(AreEqual(tested.Update(), fresh.Update()));
      for (vtkAlgorithm* filter : std::initializer_list<vtkAlgorithm*>{ geometry, carve })
      {
        const vtkMTimeType before = filter->GetOutputDataObject(0)->GetMTime();
        filter->Update();
        EXPECT_GT(filter->GetOutputDataObject(0)->GetMTime(), before) << filter->GetClassName();
      }
      written->SetComponent(2, 0, written->GetComponent(2, 0) + 0.25);
      written->Modified();
    }
  }
  // The output extent changes in the same update.
  Deformed tested(volume, blocks);
  tested.Update();
  vtkDataArray* displacements = mesh->GetPointData()->GetVectors();
  for (const double step : { -4.0, 4.0 })
  {
    displacements->SetComponent(0, 0, displacements->GetComponent(0, 0) + step);
    displacements->Modified();
    Deformed fresh(volume, blocks);
    EXPECT_TRUE(AreEqual(tested.Expect(""), fresh.Update())) << step;
  }
}

TEST(DeformMeshes, Grids)
{
  TestGrid(MakeRectilinearGrid());
  TestGrid(MakeStructuredGrid());
  const auto volume = MakeVolume();
  vtkNew<vtkStructuredGrid> empty;
  Deformed found(volume, empty);
  found.VerifyFailure("no points");
  vtkNew<vtkStructuredGrid> flat;
  flat->SetDimensions(nodes[0], nodes[1], 1);
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(nodes[0] * nodes[1]);
  flat->SetPoints(points);
  found.Filter->SetDeformationData(flat);
  found.VerifyFailure("no tetrahedra, but 12 quad");
  // Image data in a composite dataset is not a mesh.
  vtkNew<vtkMultiBlockDataSet> blocks;
  found.Filter->SetDeformationData(blocks);
  found.VerifyFailure("holds no vtkUnstructuredGrid");
  blocks->SetBlock(0, volume);
  blocks->Modified();
  found.VerifyFailure(
    "holds no mesh, but image data: the block with flat index 1. Extract one image");
}

// Displacements that are exact in floats.
glm::dvec3 BendExactly(const glm::dvec3& p)
{
  return p + glm::round(64.0 * (Bend(p) - p)) / 64.0;
}

TEST(DeformMeshes, DeformedPoints)
{
  const auto volume = MakeVolume();
  const Grid mesh = MakeMesh(volume);
  SetDisplacements(mesh, BendExactly);
  const Grid moved = MoveToDeformed(mesh);
  Deformed expected(volume, mesh);
  Deformed found(volume, moved);
  found.Filter->PointsAreDeformedOn();
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, MakeShells());
  blocks->SetBlock(3, AddUnusedNodes(moved, glm::dvec3(nan), glm::dvec3(nan)));
  Deformed composite(volume, blocks);
  composite.Filter->PointsAreDeformedOn();
  for (const double scale : { 1.0, 2.0, 0.0 })
  {
    for (Deformed* one : { &expected, &found, &composite })
    {
      one->Filter->SetDisplacementScale(scale);
    }
    vtkImageData* output = expected.Update();
    EXPECT_GT(expected.Filter->GetNumberOfCoveredVoxels(), 500);
    EXPECT_TRUE(AreEqual(output, found.Update()));
    EXPECT_TRUE(AreEqual(output, composite.Update()));
  }
  // Another time step, with the same mesh at rest.
  for (Deformed* one : { &expected, &found })
  {
    one->Filter->SetDisplacementScale(1.0);
    one->Update();
  }
  const vtkTypeInt64 builds = GetReported(found.Filter, "Static mappings made");
  SetDisplacements(mesh, [](const glm::dvec3& p) { return 2.0 * BendExactly(p) - p; });
  const Grid next = MoveToDeformed(mesh);
  moved->GetPoints()->DeepCopy(next->GetPoints());
  moved->GetPoints()->Modified();
  moved->GetPointData()->GetVectors()->DeepCopy(next->GetPointData()->GetVectors());
  moved->GetPointData()->GetVectors()->Modified();
  EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
  EXPECT_EQ(GetReported(found.Filter, "Static mappings made"), builds);
  const auto structured = MakeStructuredGrid();
  MovePoints(structured, [](const glm::dvec3& p) { return glm::round(64.0 * p) / 64.0; });
  SetDisplacements(structured, BendExactly);
  expected.Filter->SetDeformationData(MakeHexahedra(structured, [](int) { return false; }));
  MovePoints(structured, BendExactly);
  found.Filter->SetDeformationData(structured);
  EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
  // A ball is carved out of the deformed volume.
  vtkNew<vtkSphere> ball;
  ball->SetCenter(5.0, 4.0, 6.0);
  ball->SetRadius(3.0);
  vtkIdType gone[2];
  for (const bool areDeformed : { false, true })
  {
    vtkNew<vtkCarveVolume> carve;
    carve->SetInputData(volume);
    carve->SetDeformationData(areDeformed ? next : mesh);
    carve->SetPointsAreDeformed(areDeformed);
    carve->SetImplicitFunction(ball);
    carve->Update();
    gone[areDeformed ? 1 : 0] = carve->GetNumberOfSwitchedOffTetrahedra();
  }
  EXPECT_GT(gone[0], 50);
  EXPECT_EQ(gone[0], gone[1]);
  found.Filter->SetDeformationData(moved);
  found.Filter->SetRestData(mesh);
  found.VerifyFailure("PointsAreDeformed is on, but there is a mesh at rest");
  found.Filter->SetRestData(nullptr);
  found.Update();
  const auto field = MakeImage({ { -1, 10, -1, 10, -1, 10 } });
  SetDisplacements(field, Bend);
  found.Filter->SetDeformationData(field);
  found.VerifyFailure("PointsAreDeformed is on, but the deformation is a displacement field");
  const Grid without = MakeMesh(volume);
  found.Filter->SetDeformationData(without);
  found.VerifyFailure("The deformation mesh has no active Vectors");
}

TEST(DeformMeshes, Units)
{
  const auto volume = MakeImage({ { 0, 9, 0, 8, 0, 7 } }, glm::dvec3(1.0), glm::dvec3(20, 30, -40));
  AddScalars<short>(volume, "value", [](const glm::dvec3& p) { return p.x; });
  const Grid mesh = MakeBentMesh(volume);
  MovePoints(mesh, [](const glm::dvec3& p) { return 0.001 * p; });
  const Grid more = AddUnusedNodes(mesh, glm::dvec3(25.0, 35.0, -35.0), glm::dvec3(0.0));
  const std::string boxes = "The box of the mesh is x from 0.0195 to 0.0295, y from 0.0295 to "
                            "0.0385, z from -0.0405 to -0.0325, and that of the volume x from 20 "
                            "to 29, y from 30 to 38, z from -40 to -33.";
  Deformed deformed(volume, more);
  deformed.VerifyFailure(boxes);
  deformed.Filter->SetOutsideModeToExtrapolate();
  deformed.VerifyFailure(boxes);
  deformed.Filter->SetOutsideModeToDiscard();
  deformed.Filter->SetOutputBoundsModeToVolumeBounds();
  deformed.VerifyFailure(boxes);
  deformed.Filter->SetResamplerToMeshRasterization();
  deformed.VerifyFailure(boxes);
  deformed.Filter->SetResamplerToExact();
  deformed.Filter->SetOutputBoundsModeToDeformedBounds();
  const auto field = MakeImage({ { 0, 4, 0, 4, 0, 4 } }, glm::dvec3(0.002), glm::dvec3(0.02));
  SetDisplacements(field, Shift(0.0, 0.0, 0.0));
  deformed.Filter->SetDeformationData(field);
  deformed.VerifyFailure("The box of the field is x from 0.02 to 0.028");
}

vtkSmartPointer<vtkDoubleArray> MakeConstant(const char* called, int components, vtkIdType count)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(called);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(count);
  array->Fill(1.0);
  return array;
}

// Small cells far apart are not cells that are longer than the volume.
TEST(DeformMeshes, SmallCellsFarApart)
{
  const auto volume = MakeVolume({ { 0, 9, 0, 9, 0, 9 } });
  for (const double length : { 1.8, 200.0 })
  {
    vtkNew<vtkUnstructuredGrid> mesh;
    vtkNew<vtkPoints> points;
    mesh->SetPoints(points);
    for (const double first : { 3.6, 500.0 })
    {
      for (int corner = 0; corner < 4; ++corner)
      {
        points->InsertNextPoint(first + (corner == 1 ? length : 0.0),
          first + (corner == 2 ? length : 0.0), first + (corner == 3 ? length : 0.0));
      }
      const vtkIdType last = points->GetNumberOfPoints();
      const vtkIdType nodes[4] = { last - 4, last - 3, last - 2, last - 1 };
      mesh->InsertNextCell(VTK_TETRA, 4, nodes);
    }
    SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
    Deformed deformed(volume, mesh);
    deformed.Filter->SetOutputBoundsModeToVolumeBounds();
    deformed.Filter->Update();
    EXPECT_EQ(HasPart(deformed.TakeWarning(), "more than ten times as long"), length > 100.0);
  }
}

TEST(DeformMeshes, Directions)
{
  const auto volume = MakeVolume();
  const Grid mesh = MakeBentMesh(volume);
  const vtkIdType count = volume->GetNumberOfPoints();
  vtkPointData* arrays = volume->GetPointData();
  arrays->AddArray(MakeConstant("fibre", 3, count));
  arrays->AddArray(MakeConstant("gradient", 3, count));
  arrays->AddArray(MakeConstant("diffusion", 9, count));
  Deformed deformed(volume, mesh);
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeWarning(), "");
  arrays->SetActiveVectors("fibre");
  volume->Modified();
  deformed.Filter->Update();
  const std::string first = deformed.TakeWarning();
  EXPECT_TRUE(HasPart(first, "active vectors \"fibre\""));
  EXPECT_TRUE(HasPart(first, "not rotated"));
  deformed.Filter->Modified();
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeWarning(), "");
  arrays->SetActiveNormals("gradient");
  arrays->SetActiveTensors("diffusion");
  volume->Modified();
  deformed.Filter->Update();
  const std::string second = deformed.TakeWarning();
  EXPECT_TRUE(HasPart(second, "active normals \"gradient\""));
  EXPECT_TRUE(HasPart(second, "active tensors \"diffusion\""));
  EXPECT_FALSE(HasPart(second, "fibre"));
  deformed.Filter->SetDisplacementScale(0.5);
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeWarning(), "");
}

} // namespace
