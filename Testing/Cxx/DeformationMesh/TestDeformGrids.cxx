// SPDX-License-Identifier: BSD-3-Clause
// One mesh in different grids: grids that share arrays, equal copies, a deformed mesh and one at
// rest. Edits of a grid in place must be detected. All results are compared bit by bit with those
// of a new filter.
#include "ArrayMaking.h"
#include "FilterTesting.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkIdList.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkObjectFactory.h>
#include <vtkTrivialProducer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGridAlgorithm.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

using namespace filterTesting;

namespace
{

using Grid = vtkSmartPointer<vtkUnstructuredGrid>;

// A source whose output is always the same object, as in simulations. It shares the arrays of a
// mesh.
class Passer : public vtkUnstructuredGridAlgorithm
{
public:
  static Passer* New();
  vtkTypeMacro(Passer, vtkUnstructuredGridAlgorithm);
  Grid Mesh;

protected:
  Passer() { this->SetNumberOfInputPorts(0); }
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override
  {
    vtkUnstructuredGrid::GetData(output)->ShallowCopy(this->Mesh);
    return 1;
  }
};
vtkStandardNewMacro(Passer);

Grid ShareArrays(vtkUnstructuredGrid* mesh)
{
  auto grid = Grid::New();
  grid->ShallowCopy(mesh);
  return grid;
}

Grid Copy(vtkUnstructuredGrid* mesh)
{
  auto grid = Grid::New();
  grid->DeepCopy(mesh);
  return grid;
}

class Meshes
{
public:
  Meshes()
    : Volume(MakeVolume({ { 0, 30, 0, 25, 2, 27 } }))
    , Mesh(MakeMesh(Volume, 6))
    , Tested(Volume, Mesh)
  {
    this->Move();
    this->Expect("first", 1);
  }

  void Move()
  {
    const double phase = 0.3 * ++this->Step;
    SetDisplacements(this->Mesh,
      [=](const glm::dvec3& p)
      { return p + glm::dvec3(1.5 * std::sin(0.2 * p.y + phase), 0.3, std::cos(0.3 * p.x)); });
  }

  void Give(const Grid& grid)
  {
    this->Mesh = grid;
    this->Tested.Filter->SetDeformationData(grid);
  }

  // Updates the filter. The output must be equal to that of a new filter, and the filter must have
  // built this number of static mappings: none if the tetrahedra at rest have not changed.
  void Expect(const char* what, int builds)
  {
    SCOPED_TRACE(what);
    Deformed fresh(this->Volume, this->Mesh);
    fresh.Filter->SetRestData(this->Rest);
    EXPECT_TRUE(AreEqual(this->Tested.Update(), fresh.Update()));
    const vtkIdType built = GetReported(this->Tested.Filter, "Static mappings made");
    EXPECT_EQ(built - this->Builds, builds);
    this->Builds = built;
  }

  vtkSmartPointer<vtkImageData> Volume;
  Grid Mesh;
  Grid Rest;
  Deformed Tested;

private:
  int Step = 0;
  vtkIdType Builds = 0;
};

// Exchanges the first two points of a cell.
void Exchange(vtkUnstructuredGrid* grid, vtkIdType cell)
{
  vtkNew<vtkIdList> points;
  grid->GetCells()->GetCellAtId(cell, points);
  std::swap(*points->GetPointer(0), *points->GetPointer(1));
  grid->GetCells()->ReplaceCellAtId(cell, points);
}

// Replaces the first node of a cell by a new node at the same position.
void SplitNode(vtkUnstructuredGrid* grid, vtkIdType cell)
{
  vtkNew<vtkIdList> nodes;
  grid->GetCells()->GetCellAtId(cell, nodes);
  const glm::dvec3 point = GetPoint(grid, nodes->GetId(0));
  nodes->SetId(0, grid->GetPoints()->InsertNextPoint(&point.x));
  grid->GetCells()->ReplaceCellAtId(cell, nodes);
  grid->GetPoints()->Modified();
  grid->Modified();
}

TEST(DeformGrids, OtherGrids)
{
  Meshes meshes;
  meshes.Give(ShareArrays(meshes.Mesh));
  meshes.Expect("shared arrays", 0);
  meshes.Give(ShareArrays(meshes.Mesh));
  meshes.Move();
  meshes.Expect("shared arrays and new displacements", 0);
  meshes.Give(Copy(meshes.Mesh));
  meshes.Move();
  meshes.Expect("a copy", 0);
  Grid changed = Copy(meshes.Mesh);
  Exchange(changed, changed->GetNumberOfCells() - 1);
  meshes.Give(changed);
  meshes.Expect("a copy with another cell", 1);
  changed = Copy(meshes.Mesh);
  changed->GetPoints()->SetPoint(
    7, changed->GetPoint(7)[0], changed->GetPoint(7)[1] + 0.01, changed->GetPoint(7)[2]);
  meshes.Give(changed);
  meshes.Expect("a copy with another point", 1);
  changed = Copy(meshes.Mesh);
  vtkNew<vtkCellArray> cells;
  cells->ConvertTo32BitStorage();
  cells->AllocateExact(changed->GetNumberOfCells(), 4 * changed->GetNumberOfCells());
  vtkNew<vtkIdList> points;
  for (vtkIdType cell = 0; cell < changed->GetNumberOfCells(); ++cell)
  {
    changed->GetCells()->GetCellAtId(cell, points);
    cells->InsertNextCell(points);
  }
  changed->SetCells(VTK_TETRA, cells);
  meshes.Give(changed);
  meshes.Expect("a copy with ids of 32 bits", 0);
  Grid smaller = ShareArrays(meshes.Mesh);
  vtkNew<vtkCellArray> fewer;
  for (vtkIdType cell = 0; cell + 1 < smaller->GetNumberOfCells(); ++cell)
  {
    changed->GetCells()->GetCellAtId(cell, points);
    fewer->InsertNextCell(points);
  }
  smaller->SetCells(VTK_TETRA, fewer);
  meshes.Give(smaller);
  meshes.Expect("one cell less, which leaves a hole", 1);
}

TEST(DeformGrids, EditsInPlace)
{
  Meshes meshes;
  meshes.Mesh->Modified();
  meshes.Expect("a grid that is marked as modified", 0);
  Exchange(meshes.Mesh, 11);
  meshes.Mesh->Modified();
  meshes.Expect("a cell replaced, and only the grid modified", 1);
  SplitNode(meshes.Mesh, 9);
  meshes.Move();
  meshes.Expect("a node that is split", 0);
  meshes.Mesh->GetPoints()->GetData()->SetComponent(3, 1, -0.75);
  meshes.Mesh->Modified();
  meshes.Expect("a point set, and only the grid modified", 1);
  const vtkIdType corners[4] = { 0, 7, 50, 100 };
  meshes.Mesh->InsertNextCell(VTK_TETRA, 4, corners);
  meshes.Mesh->Modified();
  meshes.Expect("one cell more", 1);
  const auto ghosts = MakeArray<vtkUnsignedCharArray>(
    vtkDataSetAttributes::GhostArrayName(), meshes.Mesh->GetNumberOfCells());
  ghosts->SetValue(4, vtkDataSetAttributes::HIDDENCELL);
  meshes.Mesh->GetCellData()->AddArray(ghosts);
  meshes.Expect("a hidden cell, which leaves a hole", 1);
  meshes.Give(ShareArrays(meshes.Mesh));
  meshes.Expect("shared arrays with a hidden cell", 0);
  meshes.Give(Copy(meshes.Mesh));
  meshes.Mesh->GetCellData()->RemoveArray(vtkDataSetAttributes::GhostArrayName());
  meshes.Expect("a copy without the hidden cell", 1);
}

TEST(DeformGrids, Pipeline)
{
  Meshes meshes;
  vtkNew<Passer> passer;
  passer->Mesh = meshes.Mesh;
  meshes.Tested.Filter->SetDeformationConnection(passer->GetOutputPort());
  meshes.Expect("a source instead of a grid", 0);
  for (int step = 0; step < 3; ++step)
  {
    meshes.Move();
    passer->Modified();
    meshes.Expect("new displacements of the source", 0);
  }
  Exchange(meshes.Mesh, 5);
  meshes.Mesh->GetCells()->Modified();
  passer->Modified();
  meshes.Expect("a cell replaced", 1);
  meshes.Mesh->GetPoints()->SetPoint(3, -0.75, 1.0, 2.0);
  meshes.Mesh->GetPoints()->Modified();
  passer->Modified();
  meshes.Expect("a point set", 1);
  passer->Mesh = meshes.Mesh = Copy(meshes.Mesh);
  passer->Modified();
  meshes.Expect("a copy", 0);
}

// Sets the degrees of a Lagrange hexahedron over a volume, and the positions of its nodes.
void PlaceNodes(vtkUnstructuredGrid* grid, vtkImageData* volume, const std::array<int, 3>& degrees)
{
  vtkDataArray* array = grid->GetCellData()->GetHigherOrderDegrees();
  array->SetTuple3(0, degrees[0], degrees[1], degrees[2]);
  array->Modified();
  std::array<double, 6> bounds;
  volume->GetBounds(bounds.data());
  const double* coordinates = grid->GetCell(0)->GetParametricCoords();
  for (vtkIdType node = 0; node < grid->GetNumberOfPoints(); ++node)
  {
    std::array<double, 3> point;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double share = coordinates[3 * node + axis];
      point[axis] =
        bounds[2 * axis] - 1.0 + share * (bounds[2 * axis + 1] - bounds[2 * axis] + 2.0);
    }
    grid->GetPoints()->SetPoint(node, point.data());
  }
  grid->GetPoints()->Modified();
}

// A cell with other degrees, which has the same number of nodes.
TEST(DeformGrids, Degrees)
{
  Meshes meshes;
  const auto grid = Grid::New();
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(24);
  grid->SetPoints(points);
  std::array<vtkIdType, 24> ids;
  std::iota(ids.begin(), ids.end(), 0);
  grid->InsertNextCell(VTK_LAGRANGE_HEXAHEDRON, 24, ids.data());
  vtkNew<vtkFloatArray> degrees;
  degrees->SetNumberOfComponents(3);
  degrees->SetNumberOfTuples(1);
  grid->GetCellData()->SetHigherOrderDegrees(degrees);
  PlaceNodes(grid, meshes.Volume, { { 2, 1, 3 } });
  vtkNew<Passer> passer;
  passer->Mesh = meshes.Mesh = grid;
  meshes.Tested.Filter->SetDeformationConnection(passer->GetOutputPort());
  meshes.Move();
  meshes.Expect("a Lagrange cell", 1);
  PlaceNodes(grid, meshes.Volume, { { 1, 2, 3 } });
  meshes.Move();
  passer->Modified();
  meshes.Expect("other degrees", 1);
}

// A cell is left out if one of the two meshes hides it, in whatever order this changes.
TEST(DeformGrids, HiddenInOneMesh)
{
  Meshes meshes;
  const auto hide = [](const Grid& mesh, vtkIdType cell)
  {
    const auto ghosts = MakeArray<vtkUnsignedCharArray>(
      vtkDataSetAttributes::GhostArrayName(), mesh->GetNumberOfCells());
    if (cell >= 0)
    {
      ghosts->SetValue(cell, vtkDataSetAttributes::HIDDENCELL);
    }
    mesh->GetCellData()->AddArray(ghosts);
    mesh->Modified();
  };
  meshes.Rest = meshes.Mesh;
  const Grid shape = Copy(meshes.Rest);
  meshes.Give(shape);
  meshes.Tested.Filter->SetRestData(meshes.Rest);
  const vtkIdType all = meshes.Volume->GetNumberOfPoints();
  const auto expect = [&](const char* what, int builds, bool isHidden)
  {
    meshes.Expect(what, builds);
    EXPECT_EQ(meshes.Tested.Filter->GetNumberOfCoveredVoxels() < all, isHidden) << what;
  };
  expect("nothing hidden", 0, false);
  hide(shape, 301);
  expect("hidden in the deformed mesh", 1, true);
  hide(meshes.Rest, 301);
  expect("hidden in both", 0, true);
  hide(shape, -1);
  expect("hidden at rest", 0, true);
  hide(meshes.Rest, -1);
  expect("nothing hidden again", 1, false);
  hide(shape, 302);
  expect("another cell hidden", 1, true);
  const Grid same = ShareArrays(meshes.Rest);
  meshes.Give(same);
  expect("one mesh twice", 1, false);
}

TEST(DeformGrids, TwoMeshes)
{
  Meshes meshes;
  meshes.Rest = meshes.Mesh;
  const Grid shape = Copy(meshes.Rest);
  meshes.Give(shape);
  meshes.Tested.Filter->SetRestData(meshes.Rest);
  meshes.Expect("two meshes", 0);
  for (int step = 0; step < 3; ++step)
  {
    shape->GetPoints()->GetData()->SetComponent(20 + step, step, 0.7 * step);
    shape->GetPoints()->Modified();
    shape->Modified();
    meshes.Expect("a point of the deformed mesh moved", 0);
  }
  meshes.Rest = Copy(meshes.Rest);
  meshes.Tested.Filter->SetRestData(meshes.Rest);
  meshes.Expect("a copy of the mesh at rest", 0);
  SplitNode(meshes.Rest, 8);
  SplitNode(shape, 8);
  meshes.Expect("a node that is split in both", 0);
  meshes.Rest->GetPoints()->GetData()->SetComponent(9, 0, -0.25);
  meshes.Rest->GetPoints()->Modified();
  meshes.Expect("another point at rest", 1);
  Exchange(shape, 3);
  shape->Modified();
  meshes.Tested.Filter->Update();
  EXPECT_EQ(meshes.Tested.TakeErrors(), 1);
  Exchange(shape, 3);
  shape->Modified();
  meshes.Expect("the cell restored", 0);
  Exchange(meshes.Rest, 5);
  meshes.Rest->Modified();
  meshes.Tested.Filter->Update();
  EXPECT_EQ(meshes.Tested.TakeErrors(), 1);
  Exchange(shape, 5);
  shape->Modified();
  meshes.Expect("the same cell replaced in both meshes", 1);
  shape->GetPoints()->GetData()->SetComponent(30, 2, std::nan(""));
  shape->Modified();
  meshes.Tested.VerifyFailure("Point 30");
  shape->GetPoints()->GetData()->SetComponent(30, 2, 5.0);
  shape->Modified();
  meshes.Expect("the point restored", 0);
  // Displacements that were computed from two meshes must not be used instead of those of the
  // array.
  meshes.Rest = nullptr;
  meshes.Give(Copy(shape));
  meshes.Tested.Filter->SetRestData(nullptr);
  meshes.Move();
  meshes.Expect("displacements again", 1);
}

// The deformed mesh is one grid, and the mesh at rest has two blocks.
TEST(DeformGrids, OtherParts)
{
  const auto volume = MakeVolume({ { 0, 30, 0, 25, 2, 27 } });
  vtkNew<vtkMultiBlockDataSet> parts;
  const auto whole = Grid::New();
  vtkNew<vtkPoints> points;
  whole->SetPoints(points);
  for (const int part : { 0, 1 })
  {
    const auto half = MakeImage(part == 0 ? std::array<int, 6>{ { 0, 30, 0, 25, 2, 14 } }
                                          : std::array<int, 6>{ { 0, 30, 0, 25, 16, 27 } });
    const Grid mesh = MakeMesh(half, part == 0 ? 9 : 11);
    parts->SetBlock(static_cast<unsigned int>(part), mesh);
    const vtkIdType first = points->GetNumberOfPoints();
    for (vtkIdType node = 0; node < mesh->GetNumberOfPoints(); ++node)
    {
      points->InsertNextPoint(mesh->GetPoint(node));
    }
    vtkNew<vtkIdList> ids;
    for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
    {
      mesh->GetCellPoints(cell, ids);
      for (vtkIdType& id : *ids)
      {
        id += first;
      }
      whole->InsertNextCell(VTK_TETRA, ids);
    }
  }
  const Grid shape = Copy(whole);
  for (vtkIdType node = 0; node < shape->GetNumberOfPoints(); ++node)
  {
    const glm::dvec3 p = GetPoint(whole, node);
    shape->GetPoints()->SetPoint(
      node, p.x + std::sin(0.2 * p.y), p.y + 0.03 * p.x, p.z + std::cos(0.3 * p.x));
  }
  Deformed inParts(volume, shape);
  inParts.Filter->SetRestData(parts);
  Deformed inOne(volume, shape);
  inOne.Filter->SetRestData(whole);
  EXPECT_TRUE(AreEqual(inParts.Update(), inOne.Update()));
}

// Floats are read by different code: they give the same displacements as equal doubles, and an
// error in one of them is reported at any position.
TEST(DeformGrids, Floats)
{
  for (const bool isOblique : { false, true })
  {
    const auto volume = MakeVolume({ { 0, 30, 0, 25, 2, 27 } });
    volume->SetSpacing(0.8, 1.1, 1.3);
    if (isOblique)
    {
      SetObliqueDirection(volume);
    }
    const Grid mesh = MakeMesh(volume, 11, 3.0);
    SetDisplacements(mesh,
      [](const glm::dvec3& p)
      { return p + glm::dvec3(std::sin(0.2 * p.y), 0.03 * p.x, std::cos(0.3 * p.x)); });
    auto* const floats = vtkFloatArray::SafeDownCast(mesh->GetPointData()->GetVectors());
    vtkNew<vtkDoubleArray> doubles;
    const Grid other = ShareArrays(mesh);
    Deformed first(volume, mesh);
    Deformed second(volume, other);
    for (const double scale : { 1.0, 0.7, -0.3, 0.0 })
    {
      floats->SetComponent(77, 1, 0.5 + scale);
      floats->Modified();
      doubles->DeepCopy(floats);
      other->GetPointData()->SetVectors(doubles);
      first.Filter->SetDisplacementScale(scale);
      second.Filter->SetDisplacementScale(scale);
      EXPECT_TRUE(AreEqual(first.Update(), second.Update()));
    }
    first.Filter->SetDisplacementScale(1.0);
    const float infinity = std::numeric_limits<float>::infinity();
    const vtkIdType last = mesh->GetNumberOfPoints() - 1;
    for (const vtkIdType node : { vtkIdType{ 0 }, vtkIdType{ 513 }, vtkIdType{ 1023 }, last })
    {
      for (const float wrong : { std::nanf(""), infinity, -infinity, 1e6F })
      {
        for (int axis = 0; axis < 3; ++axis)
        {
          const double right = floats->GetComponent(node, axis);
          floats->SetComponent(node, axis, wrong);
          floats->Modified();
          first.Filter->Update();
          EXPECT_EQ(first.TakeErrors(), 1);
          const std::string expected = std::isfinite(wrong)
            ? "more than 16,383 output voxels"
            : "Displacement " + std::to_string(node) + " of";
          EXPECT_TRUE(HasPart(first.LastError, expected));
          floats->SetComponent(node, axis, right);
          floats->Modified();
        }
      }
    }
    second.Filter->SetDisplacementScale(1.0);
    EXPECT_TRUE(AreEqual(first.Update(), second.Update()));
  }
}

} // namespace
