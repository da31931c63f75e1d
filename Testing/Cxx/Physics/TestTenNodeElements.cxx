// SPDX-License-Identifier: BSD-3-Clause
// The ten-node tetrahedra of vtkFiniteElementDeformation: misuse, mid-side nodes that are added,
// conditions on nodes, cuts, and closed forms.
#include "ArrayMaking.h"
#include "ElasticTesting.h"
#include "TenNodeCells.h"

#include "vtkDeformGeometryFilter.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkIdTypeArray.h>
#include <vtkIntArray.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <set>

using namespace elasticTesting;

namespace
{

using Elements = Simulated<vtkFiniteElementDeformation>;

constexpr int CornersOfCube = 27; // the cube has 2 x 2 x 2 cells
constexpr int NodesOfCube = 117;  // corners and mid-side nodes
constexpr double Edge = 0.03;

// A cube of linear tetrahedra, fixed at z = 0. Lengths are in meters.
vtkSmartPointer<vtkUnstructuredGrid> MakeCube()
{
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetNumberOfNodes(3, 3, 3);
  lattice->SetBounds(0.0, Edge, 0.0, Edge, 0.0, Edge);
  lattice->Update();
  auto cube = vtkSmartPointer<vtkUnstructuredGrid>::New();
  cube->DeepCopy(lattice->GetOutput());
  FixPoints(cube, [](const glm::dvec3& p) { return p.z == 0.0; });
  return cube;
}

vtkSmartPointer<vtkUnstructuredGrid> MakeTenNodeCube(bool separated = false)
{
  vtkSmartPointer<vtkUnstructuredGrid> cube = MakeTenNodes(MakeCube(), separated);
  FixPoints(cube, [](const glm::dvec3& p) { return p.z == 0.0; });
  return cube;
}

std::vector<vtkIdType> GetIds(vtkUnstructuredGrid* mesh, vtkIdType cell)
{
  vtkNew<vtkIdList> ids;
  mesh->GetCellPoints(cell, ids);
  return { ids->begin(), ids->end() };
}

// Changes the points of cells.
void ReplaceCells(
  vtkUnstructuredGrid* mesh, const std::function<void(vtkIdType, std::vector<vtkIdType>&)>& change)
{
  vtkNew<vtkUnstructuredGrid> changed;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    std::vector<vtkIdType> ids = GetIds(mesh, cell);
    change(cell, ids);
    changed->InsertNextCell(
      mesh->GetCellType(cell), static_cast<vtkIdType>(ids.size()), ids.data());
  }
  mesh->SetCells(changed->GetCellTypesArray(), changed->GetCells());
}

// The number of cells that use a point.
int CountUsers(vtkUnstructuredGrid* mesh, vtkIdType point)
{
  int users = 0;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    const std::vector<vtkIdType> ids = GetIds(mesh, cell);
    users += std::count(ids.begin(), ids.end(), point) > 0 ? 1 : 0;
  }
  return users;
}

std::string TryMesh(vtkUnstructuredGrid* mesh)
{
  Elements elements(mesh);
  return elements.TryUpdate();
}

TEST(TenNodeElements, MisplacedNodes)
{
  EXPECT_EQ(TryMesh(MakeTenNodeCube()), "");
  // A mid-side node near the end of its edge.
  auto cube = MakeTenNodeCube();
  const std::vector<vtkIdType> first = GetIds(cube, 0);
  const glm::dvec3 moved =
    GetPoint(cube, first[0]) + 0.2 * (GetPoint(cube, first[1]) - GetPoint(cube, first[0]));
  cube->GetPoints()->SetPoint(first[4], &moved.x);
  EXPECT_TRUE(HasPart(TryMesh(cube),
    std::to_string(CountUsers(cube, first[4])) +
      " of 40 tetrahedra of the mesh at rest overlap themselves"));
  // A node that is not exactly in the middle is valid.
  const glm::dvec3 curved = 0.45 * GetPoint(cube, first[0]) + 0.55 * GetPoint(cube, first[1]);
  cube->GetPoints()->SetPoint(first[4], &curved.x);
  EXPECT_EQ(TryMesh(cube), "");

  // Another order of the nodes, with cells that share nodes and cells that do not.
  const auto swapTwo = [](vtkIdType, std::vector<vtkIdType>& ids) { std::swap(ids[4], ids[9]); };
  for (const bool separated : { false, true })
  {
    cube = MakeTenNodeCube(separated);
    ReplaceCells(cube, swapTwo);
    EXPECT_TRUE(HasPart(TryMesh(cube), separated ? "40 of 40 tetrahedra" : "of another edge"));
  }
}

TEST(TenNodeElements, WrongCells)
{
  auto cube = MakeTenNodeCube();
  const auto changeFirst = [&](std::size_t i, vtkIdType id) {
    return [=](vtkIdType cell, std::vector<vtkIdType>& ids) { ids[i] = cell == 0 ? id : ids[i]; };
  };
  // Two cells have different mid-side nodes on a common edge.
  const std::vector<vtkIdType> ids = GetIds(cube, 0);
  std::size_t shared = 4;
  while (CountUsers(cube, ids[shared]) == 1)
  {
    ++shared;
  }
  const glm::dvec3 middle = GetPoint(cube, ids[shared]);
  const vtkIdType second = cube->GetPoints()->InsertNextPoint(&middle.x);
  cube->GetPointData()->GetArray("Fixed")->InsertNextTuple1(0.0);
  ReplaceCells(cube, changeFirst(shared, second));
  EXPECT_TRUE(
    HasPart(TryMesh(cube), "The mesh at rest has 1 edge with more than one mid-side node"));
  // A mid-side node that is a corner of the mesh.
  cube = MakeTenNodeCube();
  ReplaceCells(cube, changeFirst(4, GetIds(cube, 0)[2]));
  EXPECT_TRUE(
    HasPart(TryMesh(cube), "1 nodes of the mesh at rest on input port 0 are in the middle"));
  // A cell with nine points, and a cell with the id of a point that does not exist.
  cube = MakeTenNodeCube();
  ReplaceCells(
    cube, [](vtkIdType cell, std::vector<vtkIdType>& ids) { ids.resize(cell == 3 ? 9 : 10); });
  EXPECT_TRUE(HasPart(TryMesh(cube), "Cell 3 of the mesh at rest on input port 0 has 9 points"));
  cube = MakeTenNodeCube();
  ReplaceCells(cube, changeFirst(7, cube->GetNumberOfPoints()));
  const std::string size = std::to_string(cube->GetNumberOfPoints());
  EXPECT_TRUE(HasPart(
    TryMesh(cube), "refers to point " + size + ", but the mesh has only " + size + " points"));
  // Springs need four-node tetrahedra.
  Simulated<vtkMassSpringDeformation> springs(MakeTenNodeCube());
  EXPECT_TRUE(HasPart(springs.TryUpdate(), "40 cells of the type "));
}

TEST(TenNodeElements, WrongConditions)
{
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const bool isTenNode : { false, true })
  {
    const auto make = [&] { return isTenNode ? MakeTenNodeCube() : MakeCube(); };
    // Nodes that are both fixed and sliding. Mid-side nodes that the filter adds are not counted.
    auto cube = make();
    AddPointVectors(cube, "SlidingNormal", [](const glm::dvec3&) { return glm::dvec3(0, 0, 2); });
    EXPECT_TRUE(HasPart(TryMesh(cube),
      (isTenNode ? "25" : "9") + std::string(" nodes have contradictory conditions")));
    cube = make();
    AddPointVectors(cube, "SecondSlidingNormal", [](const glm::dvec3&) { return glm::dvec3(1.0); });
    EXPECT_TRUE(HasPart(TryMesh(cube), "but none named \"SlidingNormal\""));
    for (const char* name : { "SlidingNormal", "SecondSlidingNormal", "PrescribedDisplacement" })
    {
      cube = make();
      AddPointVectors(cube, name, [](const glm::dvec3&) { return glm::dvec3(0.0); })
        ->SetComponent(8, 1, nan);
      EXPECT_TRUE(HasPart(TryMesh(cube), std::string(name) + " 8 of the mesh at rest"));
      cube = make();
      AddPointVectors(cube, name, [](const glm::dvec3&) { return glm::dvec3(0.0); })
        ->SetNumberOfTuples(5);
      EXPECT_TRUE(HasPart(TryMesh(cube), std::string("\"") + name + "\""));
    }
    cube = make();
    cube->GetPointData()->RemoveArray("Fixed");
    AddPointVectors(
      cube, "PrescribedDisplacement", [](const glm::dvec3&) { return glm::dvec3(1e-3); });
    EXPECT_TRUE(HasPart(TryMesh(cube), "but none named \"Fixed\""));
  }
}

// Points, cells and arrays of the output.
TEST(TenNodeElements, Output)
{
  auto cube = MakeCube();
  const vtkIdType triangle[3] = { 0, 1, 3 };
  cube->InsertNextCell(VTK_TRIANGLE, 3, triangle);
  cube->GetPoints()->InsertNextPoint(1.0, 1.0, 1.0); // no cell uses this point
  cube->GetPointData()->GetArray("Fixed")->InsertNextTuple1(1.0);
  // No face has forces at all three corners.
  const auto getForce = [](const glm::dvec3& p) { return p.x == p.y ? 1e-3 : 0.0; };
  AddPointVectors(
    cube, "Force", [&](const glm::dvec3& p) { return glm::dvec3(getForce(p), 0.0, 0.0); });
  vtkNew<vtkDoubleArray> heights;
  heights->SetName("Height");
  vtkNew<vtkIntArray> numbers;
  numbers->SetName("Number");
  vtkNew<vtkStringArray> names;
  names->SetName("Name");
  vtkNew<vtkIdTypeArray> ids;
  ids->SetName("Id");
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  const vtkIdType before = cube->GetNumberOfPoints();
  for (vtkIdType i = 0; i < before; ++i)
  {
    const double z = GetPoint(cube, i).z;
    heights->InsertNextValue(z);
    numbers->InsertNextValue(static_cast<int>(i));
    names->InsertNextValue("node");
    ids->InsertNextValue(i);
    ghosts->InsertNextValue(z < 0.01 ? vtkDataSetAttributes::DUPLICATEPOINT : 0);
  }
  for (vtkAbstractArray* array :
    std::initializer_list<vtkAbstractArray*>{ heights, numbers, names, ghosts })
  {
    cube->GetPointData()->AddArray(array);
  }
  cube->GetPointData()->SetGlobalIds(ids);
  const auto ofCells = MakeArray<vtkDoubleArray>("OfCells", cube->GetNumberOfCells());
  cube->GetCellData()->AddArray(ofCells);

  Elements elements(cube);
  elements.Filter->ElementResultsOn();
  EXPECT_EQ(elements.TryUpdate(), "");
  vtkUnstructuredGrid* output = elements.Filter->GetOutput();
  EXPECT_EQ(output->GetNumberOfPoints(), vtkIdType{ NodesOfCube + 1 });
  EXPECT_EQ(output->GetNumberOfCells(), cube->GetNumberOfCells());
  EXPECT_EQ(output->GetCellType(40), static_cast<int>(VTK_TRIANGLE));
  EXPECT_EQ(output->GetCellData()->GetArray("OfCells"), ofCells);
  EXPECT_EQ(output->GetCellData()->GetArray("Stress")->GetNumberOfTuples(), 41);
  EXPECT_FALSE(output->GetPointData()->GetArray("Id"));
  const auto get = [&](const char* name, vtkIdType node, int component = 0)
  { return output->GetPointData()->GetArray(name)->GetComponent(node, component); };
  int wrong = 0;
  for (vtkIdType i = 0; i < before; ++i)
  {
    wrong += GetPoint(output, i) != GetPoint(cube, i) || get("Number", i) != double(i) ||
      get("Force", i) != getForce(GetPoint(cube, i));
  }
  EXPECT_EQ(wrong, 0);
  int edges = 0;
  for (vtkIdType cell = 0; cell < 40; ++cell)
  {
    EXPECT_EQ(output->GetCellType(cell), static_cast<int>(VTK_QUADRATIC_TETRA));
    const std::vector<vtkIdType> nodes = GetIds(output, cell);
    const std::vector<vtkIdType> corners = GetIds(cube, cell);
    EXPECT_TRUE(std::equal(corners.begin(), corners.end(), nodes.begin()));
    constexpr int ends[6][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 }, { 0, 3 }, { 1, 3 }, { 2, 3 } };
    for (std::size_t edge = 0; edge < 6; ++edge)
    {
      const vtkIdType node = nodes[4 + edge];
      const vtkIdType a = corners[static_cast<std::size_t>(ends[edge][0])];
      const vtkIdType b = corners[static_cast<std::size_t>(ends[edge][1])];
      const glm::dvec3 middle = 0.5 * (GetPoint(cube, a) + GetPoint(cube, b));
      EXPECT_TRUE(node >= before && GetPoint(output, node) == middle);
      EXPECT_EQ(get("Height", node), middle.z);
      EXPECT_LE(std::abs(get("Number", node) - 0.5 * double(a + b)), 0.5);
      EXPECT_EQ(get("Fixed", node), middle.z == 0.0 ? 1.0 : 0.0);
      EXPECT_EQ(get("Force", node), 0.0);
      EXPECT_EQ(get(vtkDataSetAttributes::GhostArrayName(), node), middle.z == 0.0 ? 1.0 : 0.0);
      ++edges;
    }
  }
  EXPECT_EQ(edges, 240);
  auto* made = vtkArrayDownCast<vtkStringArray>(output->GetPointData()->GetAbstractArray("Name"));
  EXPECT_TRUE(made && made->GetValue(NodesOfCube) == "node");
  EXPECT_EQ(get("Displacement", before - 1), 0.0); // the point that no cell uses

  // Points and cells of the output are the same objects as long as the mesh does not change.
  vtkPoints* points = output->GetPoints();
  vtkCellArray* cells = output->GetCells();
  elements.Filter->SetGravity(0.0, 0.0, 1.0);
  EXPECT_EQ(elements.TryUpdate(), "");
  vtkDataArray* madeHeights = output->GetPointData()->GetArray("Height");
  EXPECT_TRUE(output->GetPoints() == points && output->GetCells() == cells);
  elements.Filter->SetGravity(0.0, 0.0, 2.0);
  EXPECT_EQ(elements.TryUpdate(), "");
  EXPECT_EQ(output->GetPointData()->GetArray("Height"), madeHeights);
  cube->GetPointData()->GetArray("Force")->SetComponent(0, 0, 2e-3);
  cube->GetPointData()->GetArray("Force")->Modified();
  EXPECT_EQ(elements.TryUpdate(), "");
  EXPECT_TRUE(output->GetPoints() == points && output->GetCells() == cells);
  EXPECT_EQ(get("Force", 0), 2e-3);
  EXPECT_EQ(get("Force", NodesOfCube), 0.0);
  // The program may have called Modified() of the mesh only.
  vtkDoubleArray::SafeDownCast(cube->GetPointData()->GetArray("Force"))->SetValue(0, 3e-3);
  heights->SetValue(3, 7.0);
  cube->Modified();
  EXPECT_EQ(elements.TryUpdate(), "");
  EXPECT_EQ(get("Force", 0), 3e-3);
  EXPECT_EQ(get("Height", 3), 7.0);

  // The output is a valid mesh of ten-node tetrahedra, whose points and cells are passed.
  vtkNew<vtkUnstructuredGrid> again;
  again->DeepCopy(output);
  again->GetPointData()->RemoveArray("Displacement");
  Elements second(again);
  second.Filter->SetGravity(0.0, 0.0, 2.0);
  EXPECT_EQ(second.TryUpdate(), "");
  EXPECT_EQ(second.Filter->GetOutput()->GetPoints(), again->GetPoints());
  EXPECT_EQ(second.Filter->GetOutput()->GetCells(), again->GetCells());
}

// Linear and ten-node cells in one mesh: common edges have the mid-side node of the ten-node cell.
TEST(TenNodeElements, MixedCells)
{
  auto cube = MakeTenNodeCube();
  ReplaceCells(cube, [](vtkIdType, std::vector<vtkIdType>&) {});
  vtkNew<vtkUnstructuredGrid> mixed;
  mixed->SetPoints(cube->GetPoints());
  for (vtkIdType cell = 0; cell < cube->GetNumberOfCells(); ++cell)
  {
    const std::vector<vtkIdType> ids = GetIds(cube, cell);
    const bool isLinear = cell % 2 == 1;
    mixed->InsertNextCell(
      isLinear ? VTK_TETRA : VTK_QUADRATIC_TETRA, isLinear ? 4 : 10, ids.data());
  }
  FixPoints(mixed, [](const glm::dvec3& p) { return p.z == 0.0; });
  Elements elements(mixed);
  elements.Filter->SetGravity(0.0, 0.0, 2.0);
  EXPECT_EQ(elements.TryUpdate(), "");
  vtkUnstructuredGrid* output = elements.Filter->GetOutput();
  std::set<std::vector<double>> positions;
  std::set<vtkIdType> used;
  for (vtkIdType cell = 0; cell < output->GetNumberOfCells(); ++cell)
  {
    EXPECT_EQ(output->GetCellType(cell), static_cast<int>(VTK_QUADRATIC_TETRA));
    for (const vtkIdType id : GetIds(output, cell))
    {
      const glm::dvec3 position = GetPoint(output, id);
      positions.insert({ position.x, position.y, position.z });
      used.insert(id);
    }
  }
  EXPECT_EQ(positions.size(), std::size_t{ NodesOfCube });
  EXPECT_EQ(used.size(), std::size_t{ NodesOfCube });
}

// Displacements by position at rest.
using Found = std::map<std::array<double, 3>, glm::dvec3>;
Found FindDisplacements(Elements& elements)
{
  Found found;
  vtkUnstructuredGrid* output = elements.Filter->GetOutput();
  vtkDataArray* vectors = output->GetPointData()->GetVectors();
  for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
  {
    const glm::dvec3 position = GetPoint(output, i);
    glm::dvec3 vector;
    vectors->GetTuple(i, &vector.x);
    found[{ { position.x, position.y, position.z } }] = vector;
  }
  return found;
}

bool IsOnBoundary(const glm::dvec3& position)
{
  bool isOn = false;
  for (int axis = 0; axis < 3; ++axis)
  {
    isOn |= position[axis] == 0.0 || position[axis] == Edge;
  }
  return isOn;
}

double GetWorst(Elements& elements, const std::function<glm::dvec3(const glm::dvec3&)>& expected)
{
  double worst = 0.0;
  for (const auto& [position, displacement] : FindDisplacements(elements))
  {
    worst = std::max(worst,
      glm::distance(displacement, expected(glm::dvec3(position[0], position[1], position[2]))));
  }
  return worst;
}

// If an affine map displaces the nodes of the boundary, inner nodes are displaced by the same map.
// Then another map is prescribed, without a new start.
TEST(TenNodeElements, Prescribed)
{
  const glm::dmat3 first(0.1, 0.02, -0.03, 0.05, -0.08, 0.01, -0.02, 0.04, 0.06);
  const glm::dmat3 second(-0.05, 0.03, 0.0, 0.0, 0.04, 0.02, 0.06, -0.03, 0.02);
  for (const bool isTenNode : { false, true })
  {
    auto cube = isTenNode ? MakeTenNodeCube() : MakeCube();
    FixPoints(cube, IsOnBoundary);
    const auto prescribe = [&](const glm::dmat3& map)
    {
      AddPointVectors(cube, "PrescribedDisplacement",
        [&](const glm::dvec3& p) { return IsOnBoundary(p) ? 1e3 * (map * p) : glm::dvec3(7.0); });
    };
    prescribe(first);
    // The mesh is in millimeters.
    vtkNew<vtkUnstructuredGrid> scaled;
    scaled->DeepCopy(cube);
    MovePoints(scaled, [](const glm::dvec3& p) { return 1e3 * p; });
    Elements elements(scaled);
    elements.Filter->SetLengthUnitToMillimetre();
    EXPECT_EQ(elements.TryUpdate(), "");
    const double worst = GetWorst(elements, [&](const glm::dvec3& p) { return first * p; });
    std::cout << "affine map: largest error " << worst << " of 30 mm\n";
    // Forces are in equilibrium to 1e-6 of the largest force, and displacements are up to 6 mm.
    EXPECT_LT(worst, 1e-5);
    prescribe(second);
    scaled->GetPointData()->AddArray(cube->GetPointData()->GetArray("PrescribedDisplacement"));
    elements.Filter->Modified();
    elements.Filter->Update();
    EXPECT_EQ(elements.Observer->GetWarningMessage(), "");
    EXPECT_LT(GetWorst(elements, [&](const glm::dvec3& p) { return second * p; }), 1e-5);
    scaled->GetPointData()->RemoveArray("PrescribedDisplacement");
    EXPECT_EQ(elements.TryUpdate(), "");
    EXPECT_LT(GetWorst(elements, [](const glm::dvec3&) { return glm::dvec3(0.0); }), 1e-5);
  }
}

// Mid-side nodes that the filter adds have the sliding normal of the ends of their edges, also if
// normals are integers.
TEST(TenNodeElements, IntegerNormals)
{
  auto cube = MakeCube();
  FixPoints(cube, [](const glm::dvec3& p) { return p.z == Edge; });
  vtkNew<vtkIntArray> normals;
  normals->SetName("SlidingNormal");
  normals->SetNumberOfComponents(3);
  for (vtkIdType i = 0; i < cube->GetNumberOfPoints(); ++i)
  {
    const int isBottom = GetPoint(cube, i).z == 0.0 ? 1 : 0;
    const double normal[3] = { 0.0, 2.0 * isBottom, -1.0 * isBottom };
    normals->InsertNextTuple(normal);
  }
  cube->GetPointData()->AddArray(normals);
  Elements elements(cube);
  EXPECT_EQ(elements.TryUpdate(), "");
  vtkUnstructuredGrid* output = elements.Filter->GetOutput();
  vtkDataArray* made = output->GetPointData()->GetArray("SlidingNormal");
  int sliding = 0;
  for (vtkIdType i = CornersOfCube; i < output->GetNumberOfPoints(); ++i)
  {
    glm::dvec3 normal;
    made->GetTuple(i, &normal.x);
    sliding += normal == glm::dvec3(0.0, 2.0, -1.0);
    EXPECT_TRUE(normal == glm::dvec3(0.0) || normal == glm::dvec3(0.0, 2.0, -1.0));
  }
  EXPECT_EQ(sliding, 6); // of the edges along x; other edges are not in the sliding plane
}

// Nodes with two normals slide along a line, also a mid-side node that the filter adds.
TEST(TenNodeElements, SecondNormals)
{
  auto cube = MakeCube();
  FixPoints(cube, [](const glm::dvec3& p) { return p.z == Edge; });
  const auto slides = [](const glm::dvec3& p) { return p.x == 0.0 && p.y == 0.0 && p.z < Edge; };
  AddPointVectors(
    cube, "SlidingNormal", [&](const glm::dvec3& p) { return glm::dvec3(slides(p), 0.0, 0.0); });
  AddPointVectors(cube, "SecondSlidingNormal",
    [&](const glm::dvec3& p) { return glm::dvec3(0.0, slides(p), 0.0); });
  Elements elements(cube);
  elements.Filter->SetGravity(1.0, 1.0, 1.0);
  EXPECT_EQ(elements.TryUpdate(), "");
  const Found found = FindDisplacements(elements);
  for (const double z : { 0.0, 0.25 * Edge, 0.5 * Edge })
  {
    const glm::dvec3 displacement = found.at({ { 0.0, 0.0, z } });
    EXPECT_TRUE(std::abs(displacement.x) < 1e-9 && std::abs(displacement.y) < 1e-9);
    EXPECT_GT(std::abs(displacement.z), 1e-6);
  }
}

// vtkDeformVolumeFilter and vtkDeformGeometryFilter downstream of the simulation: the static
// mapping is built once, and geometry follows corners and mid-side nodes.
TEST(TenNodeElements, FiltersBehind)
{
  Elements elements(MakeCube());
  vtkSmartPointer<vtkImageData> volume = MakeImage({ { 0, 30, 0, 30, 0, 30 } }, glm::dvec3(1e-3));
  AddScalars<short>(volume, "value", [](const glm::dvec3& p) { return 1e5 * p.x; });
  vtkNew<vtkDeformVolumeFilter> deform;
  deform->SetInputData(volume);
  deform->SetDeformationConnection(elements.Filter->GetOutputPort());
  for (int step = 1; step <= 3; ++step)
  {
    elements.Filter->SetGravity(0.0, -1.0 * step, 0.0);
    deform->Update();
    EXPECT_EQ(GetReported(deform, "Static mappings made"), 1);
  }
  EXPECT_EQ(elements.Filter->GetOutput()->GetNumberOfPoints(), vtkIdType{ NodesOfCube });
  vtkNew<vtkPolyData> nodes;
  nodes->SetPoints(elements.Filter->GetOutput()->GetPoints());
  vtkNew<vtkDeformGeometryFilter> geometry;
  geometry->SetInputData(nodes);
  geometry->SetDeformationConnection(elements.Filter->GetOutputPort());
  geometry->Update();
  vtkDataArray* vectors = elements.Filter->GetOutput()->GetPointData()->GetVectors();
  double worst = 0.0;
  double largest = 0.0;
  for (vtkIdType i = 0; i < nodes->GetNumberOfPoints(); ++i)
  {
    glm::dvec3 vector;
    vectors->GetTuple(i, &vector.x);
    const glm::dvec3 moved = GetPoint(geometry->GetOutput(), i) - GetPoint(nodes, i);
    worst = std::max(worst, glm::distance(moved, vector));
    largest = std::max(largest, glm::length(vector));
  }
  std::cout << "geometry follows nodes within " << worst << " of " << largest << " m\n";
  EXPECT_TRUE(largest > 5e-4 && worst < 1e-9); // displacements are floats
}

// A uniform traction on irregular tetrahedra that slide in three planes: each corner has a third of
// the force on its faces. The stress is uniaxial, and the reactions balance the loads.
TEST(TenNodeElements, Traction)
{
  constexpr double traction = 500.0; // in Pa, 5 % of the Young modulus
  constexpr double tolerance = 1e-5; // residual forces are at most 1e-6 of the largest force
  for (const double unit : { 1e-3, 1.0 })
  {
    auto cube = MakeCube();
    std::map<vtkIdType, double> forces;
    for (vtkIdType i = 0; i < cube->GetNumberOfPoints(); ++i)
    {
      glm::dvec3 p = GetPoint(cube, i);
      const glm::dvec3 moved = p + 0.1 * Edge * glm::sin(1e3 * glm::dvec3(p.y, p.z, p.x) + 1.0);
      const glm::dvec3 inside = glm::step(1e-6, p) * glm::step(p, glm::dvec3(Edge - 1e-6));
      p = (p + inside * (moved - p)) / unit;
      cube->GetPoints()->SetPoint(i, &p.x);
    }
    const double edge = Edge / unit;
    for (vtkIdType cell = 0; cell < cube->GetNumberOfCells(); ++cell)
    {
      std::vector<vtkIdType> top = GetIds(cube, cell);
      top.erase(std::remove_if(top.begin(), top.end(),
                  [&](vtkIdType i) { return GetPoint(cube, i).z < 0.99 * edge; }),
        top.end());
      if (top.size() == 3)
      {
        const glm::dvec3 origin = GetPoint(cube, top[0]);
        const double area = 0.5 * unit * unit *
          glm::length(glm::cross(GetPoint(cube, top[1]) - origin, GetPoint(cube, top[2]) - origin));
        for (const vtkIdType corner : top)
        {
          forces[corner] += traction * area / 3.0;
        }
      }
    }
    const auto getNormal = [](const glm::dvec3& p, int number)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        if (p[axis] == 0.0 && number-- == 0)
        {
          return glm::dvec3(axis == 0, axis == 1, axis == 2);
        }
      }
      return glm::dvec3(0.0);
    };
    const auto isOrigin = [](const glm::dvec3& p) { return p == glm::dvec3(0.0); };
    FixPoints(cube, isOrigin);
    for (const int number : { 0, 1 })
    {
      AddPointVectors(cube, number == 0 ? "SlidingNormal" : "SecondSlidingNormal",
        [&](const glm::dvec3& p) { return isOrigin(p) ? p : getNormal(p, number); });
    }
    vtkDoubleArray* array =
      AddPointVectors(cube, "Force", [](const glm::dvec3&) { return glm::dvec3(0.0); });
    for (const auto& [node, force] : forces)
    {
      array->SetComponent(node, 2, force);
    }
    Elements elements(cube);
    elements.Filter->SetLengthUnit(
      unit == 1.0 ? vtkElasticDeformation::METRE : vtkElasticDeformation::MILLIMETRE);
    elements.Filter->ElementResultsOn();
    EXPECT_EQ(elements.TryUpdate(), "");
    vtkUnstructuredGrid* output = elements.Filter->GetOutput();
    const auto sumReactions = [&]
    {
      glm::dvec3 sum(0.0);
      for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
      {
        glm::dvec3 reaction;
        output->GetPointData()->GetArray("ReactionForce")->GetTuple(i, &reaction.x);
        sum += reaction;
        const glm::dvec3 p = GetPoint(output, i);
        EXPECT_TRUE(glm::any(glm::equal(p, glm::dvec3(0.0))) || reaction == glm::dvec3(0.0));
      }
      return sum;
    };
    const glm::dvec3 load(0.0, 0.0, traction * Edge * Edge);
    EXPECT_LE(glm::distance(sumReactions(), -load), tolerance * load.z);
    const double stretch = 1.0 + elements.Copy()->GetComponent(forces.begin()->first, 2) / edge;
    EXPECT_GT(stretch, 1.04);
    for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
    {
      EXPECT_NEAR(elements.Copy()->GetComponent(i, 2), (stretch - 1.0) * GetPoint(output, i).z,
        tolerance * edge);
    }
    vtkCellData* cells = output->GetCellData();
    for (vtkIdType cell = 0; cell < output->GetNumberOfCells(); ++cell)
    {
      // The traction acts on the area at rest.
      const double determinant =
        cells->GetArray("DeformationGradientDeterminant")->GetComponent(cell, 0);
      EXPECT_NEAR(cells->GetArray("Stress")->GetComponent(cell, 2),
        traction * stretch / determinant, 10.0 * tolerance * traction);
    }
    // With gravity, and without the part of the body that a cut frees.
    const glm::dvec3 gravity(3.0, -2.0, 5.0);
    const glm::dvec3 weight = 1000.0 * Edge * Edge * Edge * gravity;
    elements.Filter->SetGravity(gravity.x, gravity.y, gravity.z);
    EXPECT_EQ(elements.TryUpdate(), "");
    EXPECT_LE(glm::distance(sumReactions(), -load - weight), tolerance * load.z);
    if (unit == 1.0)
    {
      elements.Filter->SetSheetData(MakeHorizontalSheet(0.5 * Edge + 1e-5));
      EXPECT_EQ(elements.TryUpdate(), "");
      EXPECT_EQ(elements.Filter->GetNumberOfFrozenPieces(), 1);
      const glm::dvec3 sum = sumReactions();
      const double share = glm::length(sum) / glm::length(weight);
      EXPECT_LT(share, 0.8);
      EXPECT_LE(glm::distance(sum, -share * weight), tolerance * load.z);
    }
  }
}

// A cut through the whole bar: the two sides share no nodes, and new nodes have the array values of
// the nodes that they were split from. After an undo the bar is the same as before, to the last
// bit.
TEST(TenNodeElements, Cut)
{
  for (const bool isTenNode : { false, true })
  {
    vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1.0);
    bar = isTenNode ? MakeTenNodes(bar) : bar;
    FixPoints(bar, [](const glm::dvec3& p) { return p.z == 0.0 || p.z == 0.03; });
    AddPointVectors(bar, "PrescribedDisplacement",
      [](const glm::dvec3& p) { return glm::dvec3(0.0, 0.0, p.z == 0.03 ? 1e-3 : 0.0); });
    AddPointVectors(bar, "SlidingNormal",
      [](const glm::dvec3& p)
      { return glm::dvec3(p.x == 0.0 && p.z > 0.0 && p.z < 0.03, 0.0, 0.0); });
    AddPointVectors(
      bar, "Force", [](const glm::dvec3& p) { return glm::dvec3(0.0, 1e-4 * p.x, 0.0); });
    Elements elements(bar);
    EXPECT_EQ(elements.TryUpdate(), "");
    vtkNew<vtkUnstructuredGrid> whole;
    whole->DeepCopy(elements.Filter->GetOutput());
    EXPECT_TRUE(elements.Filter->GetIsConverged());
    elements.Filter->SetSheetData(MakeHorizontalSheet(0.0151));
    EXPECT_EQ(elements.TryUpdate(), "");
    EXPECT_EQ(elements.Filter->GetNumberOfFrozenPieces(), 0);
    vtkUnstructuredGrid* cut = elements.Filter->GetOutput();
    // The cut splits 25 corners, and the mid-side nodes of 40 edges and 16 diagonals.
    EXPECT_EQ(cut->GetNumberOfPoints(), whole->GetNumberOfPoints() + 25 + 40 + 16);
    std::set<vtkIdType> sides[2];
    int different = 0;
    for (vtkIdType cell = 0; cell < cut->GetNumberOfCells(); ++cell)
    {
      const std::vector<vtkIdType> ids = GetIds(cut, cell);
      const std::vector<vtkIdType> before = GetIds(whole, cell);
      double height = 0.0;
      for (std::size_t i = 0; i < ids.size(); ++i)
      {
        height += GetPoint(cut, ids[i]).z / 10.0;
        different += GetPoint(cut, ids[i]) != GetPoint(whole, before[i]);
        for (const char* name : { "Fixed", "SlidingNormal", "PrescribedDisplacement" })
        {
          vtkDataArray* array = cut->GetPointData()->GetArray(name);
          for (int k = 0; k < array->GetNumberOfComponents(); ++k)
          {
            different += array->GetComponent(ids[i], k) !=
              whole->GetPointData()->GetArray(name)->GetComponent(before[i], k);
          }
        }
      }
      sides[height > 0.015 ? 1 : 0].insert(ids.begin(), ids.end());
    }
    EXPECT_EQ(different, 0);
    const auto sumForces = [](vtkUnstructuredGrid* grid)
    {
      vtkDataArray* forces = grid->GetPointData()->GetArray("Force");
      double sum = 0.0;
      for (vtkIdType node = 0; node < forces->GetNumberOfTuples(); ++node)
      {
        sum += forces->GetComponent(node, 1);
      }
      return sum;
    };
    EXPECT_NEAR(sumForces(cut), sumForces(whole), 1e-12 * sumForces(whole));
    std::vector<vtkIdType> common;
    std::set_intersection(sides[0].begin(), sides[0].end(), sides[1].begin(), sides[1].end(),
      std::back_inserter(common));
    EXPECT_EQ(common.size(), 0U);
    // The upper half is translated, and slightly bent by the weak forces.
    double least = 1.0;
    for (const vtkIdType node : sides[1])
    {
      least = std::min(least, cut->GetPointData()->GetVectors()->GetComponent(node, 2));
    }
    std::cout << "the upper half moves up by " << least << " m\n";
    EXPECT_GT(least, 0.9e-3);

    elements.Filter->UndoCut();
    EXPECT_EQ(elements.TryUpdate(), "");
    vtkUnstructuredGrid* joined = elements.Filter->GetOutput();
    EXPECT_EQ(joined->GetNumberOfPoints(), whole->GetNumberOfPoints());
    different = 0;
    for (vtkIdType cell = 0; cell < joined->GetNumberOfCells(); ++cell)
    {
      different += GetIds(joined, cell) != GetIds(whole, cell);
    }
    for (vtkIdType i = 0; i < joined->GetNumberOfPoints(); ++i)
    {
      different += GetPoint(joined, i) != GetPoint(whole, i);
      for (int k = 0; k < 3; ++k)
      {
        different += joined->GetPointData()->GetVectors()->GetComponent(i, k) !=
          whole->GetPointData()->GetVectors()->GetComponent(i, k);
      }
    }
    EXPECT_EQ(different, 0);
  }
}

} // namespace
