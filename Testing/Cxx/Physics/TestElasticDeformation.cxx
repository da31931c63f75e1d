// SPDX-License-Identifier: BSD-3-Clause
// vtkMassSpringDeformation and vtkFiniteElementDeformation in a pipeline: misuse, closed forms in
// both length units, times, simulations that continue, and the deformed volume.
#include "ArrayMaking.h"
#include "ElasticTesting.h"

#include <vtkCellArray.h>
#include <vtkInformation.h>
#include <vtkIntArray.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <type_traits>

using namespace elasticTesting;
using namespace chainMailTesting;
using namespace filterTesting;

namespace
{

bool AreEqual(vtkFloatArray* a, vtkFloatArray* b)
{
  return a->GetNumberOfValues() == b->GetNumberOfValues() &&
    std::equal(a->GetPointer(0), a->GetPointer(a->GetNumberOfValues()), b->GetPointer(0));
}

template <typename Filter>
class ElasticModels : public testing::Test
{
};
using Models = testing::Types<vtkMassSpringDeformation, vtkFiniteElementDeformation>;
TYPED_TEST_SUITE(ElasticModels, Models);

TYPED_TEST(ElasticModels, Misuse)
{
  using Filter = TypeParam;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1.0);
  Simulated<Filter> simulated(bar);
  EXPECT_EQ(simulated.TryUpdate(), "");
  const auto tryMesh = [&](const auto& change)
  {
    vtkSmartPointer<vtkUnstructuredGrid> mesh = MakeBar(1.0);
    change(mesh.Get());
    simulated.Filter->SetInputData(mesh);
    const std::string errors = simulated.TryUpdate();
    simulated.Filter->SetInputData(bar);
    return errors;
  };
  EXPECT_TRUE(
    HasPart(tryMesh([](vtkUnstructuredGrid* mesh) { mesh->Initialize(); }), "no tetrahedra"));
  EXPECT_TRUE(
    HasPart(tryMesh([&](vtkUnstructuredGrid* mesh) { mesh->GetPoints()->SetPoint(7, nan, 0, 0); }),
      "Point 7"));
  EXPECT_TRUE(HasPart(tryMesh(
                        [](vtkUnstructuredGrid* mesh)
                        {
                          const vtkIdType points[8] = { 0, 1, 6, 5, 25, 26, 31, 30 };
                          mesh->InsertNextCell(VTK_HEXAHEDRON, 8, points);
                        }),
    "hexahedron"));
  EXPECT_TRUE(HasPart(tryMesh(
                        [](vtkUnstructuredGrid* mesh)
                        {
                          const vtkIdType points[4] = { 0, 1, 25, 5 };
                          mesh->InsertNextCell(VTK_TETRA, 4, points);
                        }),
    "inside out"));
  EXPECT_TRUE(HasPart(tryMesh(
                        [](vtkUnstructuredGrid* mesh)
                        {
                          const vtkIdType points[4] = { 0, 1, 5, 6 };
                          mesh->InsertNextCell(VTK_TETRA, 4, points);
                        }),
    "flat"));
  const auto repeatCell = [](vtkUnstructuredGrid* mesh)
  {
    vtkNew<vtkIdList> points;
    mesh->GetCellPoints(17, points);
    const vtkIdType corners[4] = { points->GetId(1), points->GetId(2), points->GetId(0),
      points->GetId(3) };
    mesh->InsertNextCell(VTK_TETRA, 4, corners);
  };
  EXPECT_TRUE(HasPart(tryMesh(repeatCell),
    "1 of 961 tetrahedra of the mesh at rest have the same corners as another one"));
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, bar);
  simulated.Filter->SetInputDataObject(blocks);
  EXPECT_TRUE(HasPart(simulated.TryUpdate(),
    "The data on input port 0 are a vtkMultiBlockDataSet, but the filter needs a single dataset."));
  simulated.Filter->SetInputData(bar);
  EXPECT_TRUE(HasPart(tryMesh([](vtkUnstructuredGrid* mesh)
                        { mesh->GetPointData()->GetArray("Fixed")->SetNumberOfTuples(3); }),
    "\"Fixed\""));
  EXPECT_TRUE(HasPart(tryMesh(
                        [&](vtkUnstructuredGrid* mesh)
                        {
                          const auto values =
                            MakeArray<vtkDoubleArray>("Fixed", mesh->GetNumberOfPoints());
                          values->Fill(0.0);
                          values->SetValue(8, nan);
                          mesh->GetPointData()->AddArray(values);
                        }),
    "the first one being number 8"));
  for (const char* name : { "YoungModulus", "PoissonRatio", "Density" })
  {
    const auto add = [&](vtkUnstructuredGrid* mesh, double value, int components)
    {
      const auto array = MakeArray<vtkDoubleArray>(name, mesh->GetNumberOfCells(), components);
      array->Fill(value);
      mesh->GetCellData()->AddArray(array);
    };
    EXPECT_TRUE(HasPart(tryMesh([&](vtkUnstructuredGrid* mesh) { add(mesh, 1.0, 2); }), name));
    EXPECT_TRUE(HasPart(tryMesh([&](vtkUnstructuredGrid* mesh) { add(mesh, -1.0, 1); }),
      "tetrahedron with the points 0, "));
    EXPECT_TRUE(HasPart(tryMesh([&](vtkUnstructuredGrid* mesh) { add(mesh, nan, 1); }),
      "tetrahedron with the points 0, "));
  }
  simulated.Filter->SetYoungModulus(0.0);
  EXPECT_TRUE(HasPart(simulated.TryUpdate(), "Young modulus"));
  simulated.Filter->SetYoungModulus(1e4);
  simulated.Filter->SetPoissonRatio(0.495);
  EXPECT_TRUE(HasPart(simulated.TryUpdate(), "Poisson ratio"));
  simulated.Filter->SetPoissonRatio(0.3);
  simulated.Filter->SetDensity(0.0);
  EXPECT_TRUE(HasPart(simulated.TryUpdate(), "density"));
  simulated.Filter->SetDensity(1000.0);
  simulated.Filter->SetGravity(0.0, nan, 0.0);
  EXPECT_TRUE(HasPart(simulated.TryUpdate(), "gravity"));
  simulated.Filter->SetGravity(0.0, 0.0, 0.0);

  vtkSmartPointer<vtkPolyData> handles =
    MakeHandles({ { glm::dvec3(0.005, 0.005, 0.03), glm::dvec3(0.005, 0.005, 0.031) } });
  blocks->SetBlock(0, handles);
  simulated.Filter->SetHandlesData(blocks);
  EXPECT_TRUE(HasPart(simulated.TryUpdate(), "input port 1 are a vtkMultiBlockDataSet"));
  simulated.Filter->SetHandlesData(handles);
  EXPECT_EQ(simulated.TryUpdate(), "");
  EXPECT_EQ(simulated.Filter->GetNumberOfHeldNodes(), 1);
  handles->GetPointData()->RemoveArray("RestPosition");
  EXPECT_TRUE(HasPart(simulated.TryUpdate(), "no point array \"RestPosition\""));
  simulated.Filter->SetHandlesData(MakeHandles(
    { { glm::dvec3(0.0, 0.0, 0.03), glm::dvec3(0.0) }, { glm::dvec3(0.0), glm::dvec3(0.001) } }));
  EXPECT_TRUE(HasPart(simulated.TryUpdate(),
    "Handle 1 with the rest position (0, 0, 0) holds no node that could move"));
  simulated.Filter->SetHandleRadius(0.001);
  simulated.Filter->SetHandlesData(MakeHandles({ { glm::dvec3(0.5), glm::dvec3(1.0) } }));
  EXPECT_TRUE(HasPart(simulated.TryUpdate(),
    "Handle 0 with the rest position (0.5, 0.5, 0.5) holds no node that could move"));
  simulated.Filter->SetHandlesData(
    MakeHandles({ { glm::dvec3(0.01, 0.01, 0.03), glm::dvec3(nan) } }));
  EXPECT_TRUE(HasPart(simulated.TryUpdate(), "Point 0 of the handles"));
  simulated.Filter->SetHandlesData(nullptr);
  EXPECT_EQ(simulated.TryUpdate(), "");
}

// A hidden polyhedron is ignored, and passed with its faces.
TEST(ElasticDeformation, HiddenPolyhedron)
{
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1.0);
  vtkNew<vtkIdList> corners;
  bar->GetCellPoints(0, corners);
  vtkNew<vtkIdList> faces;
  faces->InsertNextId(4);
  for (vtkIdType left = 0; left < 4; ++left)
  {
    faces->InsertNextId(3);
    for (vtkIdType i = 1; i < 4; ++i)
    {
      faces->InsertNextId(corners->GetId((left + i) % 4));
    }
  }
  const vtkIdType cell = bar->InsertNextCell(VTK_POLYHEDRON, faces);
  const auto ghosts = MakeArray<vtkUnsignedCharArray>(
    vtkDataSetAttributes::GhostArrayName(), bar->GetNumberOfCells());
  ghosts->Fill(0.0);
  ghosts->SetValue(cell, vtkDataSetAttributes::HIDDENCELL);
  bar->GetCellData()->AddArray(ghosts);
  Simulated<vtkFiniteElementDeformation> elements(bar);
  EXPECT_EQ(elements.TryUpdate(), "");
  vtkUnstructuredGrid* output = elements.Filter->GetOutput();
  ASSERT_EQ(output->GetCellType(cell), VTK_POLYHEDRON);
  EXPECT_EQ(output->GetCell(cell)->GetNumberOfFaces(), 4);
}

TEST(ElasticDeformation, ErrorsOfSubclasses)
{
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1.0);
  Simulated<vtkMassSpringDeformation> springs(bar);
  EXPECT_EQ(springs.Filter->GetStableTimeStep(), 0.0);
  EXPECT_EQ(springs.TryUpdate(), "");
  const double stable = springs.Filter->GetStableTimeStep();
  EXPECT_TRUE(stable > 1e-5 && stable < 1e-2);
  springs.Filter->SetTimeStep(1.05 * stable);
  EXPECT_TRUE(HasPart(springs.TryUpdate(), "longer than the stable one"));
  springs.Filter->SetTimeStep(0.9 * stable);
  EXPECT_EQ(springs.TryUpdate(), "");
  EXPECT_LE(springs.Filter->GetTimeStepInUse(), 0.9 * stable);
  // A handle that moves very far in one frame.
  springs.Filter->SetHandlesData(
    MakeHandles({ { glm::dvec3(0.0, 0.0, 0.03), glm::dvec3(1e30, 0.0, 0.0) } }));
  EXPECT_TRUE(HasPart(springs.TryUpdate(), "diverged"));
  // A handle in other units.
  springs.Filter->SetHandlesData(
    MakeHandles({ { glm::dvec3(0.0, 0.0, 30.0), glm::dvec3(0.0, 0.0, 31.0) } }));
  EXPECT_TRUE(HasPart(springs.TryUpdate(),
    "Handle 0 with the rest position (0, 0, 30) is farther from the body than the body is long"));
  springs.Filter->SetHandleRadius(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(HasPart(springs.TryUpdate(), "HandleRadius is not a number"));
  springs.Filter->SetHandleRadius(0.0);
  springs.Filter->SetHandlesData(nullptr);
  EXPECT_EQ(springs.TryUpdate(), "");
  EXPECT_EQ(springs.Copy()->GetRange(-1)[1], 0.0);

  // Conditions that only finite elements support. Nodes without tetrahedra are not counted.
  bar->GetPoints()->InsertNextPoint(0.0, 0.0, 1.0);
  bar->GetPointData()->GetArray("Fixed")->InsertNextTuple1(1.0);
  const auto pushTop = [](const glm::dvec3& p) { return glm::dvec3(0.0, 0.0, p.z > 0.01); };
  AddPointVectors(bar, "PrescribedDisplacement", pushTop);
  EXPECT_EQ(springs.TryUpdate(), "");
  AddPointVectors(bar, "PrescribedDisplacement",
    [](const glm::dvec3& p) { return glm::dvec3(0.0, 0.0, p.x == 0.0 && p.z == 0.0); });
  EXPECT_TRUE(
    HasPart(springs.TryUpdate(), "5 nodes of the mesh at rest on input port 0 are fixed and have"));
  bar->GetPointData()->RemoveArray("PrescribedDisplacement");
  bar->GetPointData()->GetArray("Fixed")->SetTuple1(325, 0.0);
  AddPointVectors(bar, "SlidingNormal", [](const glm::dvec3& p) { return glm::dvec3(p.z > 0.03); });
  EXPECT_EQ(springs.TryUpdate(), "");
  AddPointVectors(
    bar, "SlidingNormal", [](const glm::dvec3& p) { return glm::dvec3(p.z == 0.03, 0.0, 0.0); });
  EXPECT_TRUE(
    HasPart(springs.TryUpdate(), "25 nodes of the mesh at rest on input port 0 have a sliding"));
  bar->GetPointData()->RemoveArray("SlidingNormal");
  EXPECT_EQ(springs.TryUpdate(), "");

  Simulated<vtkFiniteElementDeformation> elements(bar);
  bar->GetPointData()->RemoveArray("Fixed");
  EXPECT_TRUE(HasPart(elements.TryUpdate(), "nothing holds the body"));
}

// Updates the filter, checks that it reports no error, and returns its warning.
template <typename Filter>
std::string UpdateAndWarn(Simulated<Filter>& simulated)
{
  simulated.Filter->Modified();
  simulated.Filter->Update();
  EXPECT_FALSE(simulated.Observer->GetError());
  const std::string warning = simulated.Observer->GetWarningMessage();
  simulated.Observer->Clear();
  return warning;
}

// Warnings about a probably wrong length unit, and about inverted tetrahedra.
TYPED_TEST(ElasticModels, Warnings)
{
  using Filter = TypeParam;
  constexpr double push = HasMidSides<Filter> ? 0.02 : 0.008;
  // A body of 30 m, and one of 30 micrometers.
  for (const double unit : { 1e-3, 1e3 })
  {
    Simulated<Filter> simulated(MakeBar(unit));
    EXPECT_TRUE(HasPart(UpdateAndWarn(simulated), "unit of length"));
    EXPECT_FALSE(HasPart(UpdateAndWarn(simulated), "unit of length"));
  }
  vtkNew<Filter> fresh;
  EXPECT_EQ(fresh->GetLengthUnit(), static_cast<int>(Filter::MILLIMETRE));

  // The point that is closest to the handle belongs to no tetrahedron and is ignored. The handle
  // pushes a node through its neighbors.
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1.0);
  const glm::dvec3 top(0.005, 0.005, 0.03);
  glm::dvec3 point = top;
  const vtkIdType node = bar->FindPoint(&point.x);
  bar->GetPoints()->InsertNextPoint(top.x, top.y, top.z + 1e-4);
  bar->GetPointData()->GetArray("Fixed")->InsertNextTuple1(0.0);
  Simulated<Filter> simulated(bar);
  simulated.Filter->SetHandlesData(
    MakeHandles({ { top + glm::dvec3(0.0, 0.0, 1e-4), top - glm::dvec3(0.0, 0.0, push) } }));
  const std::string warning = UpdateAndWarn(simulated);
  EXPECT_TRUE(HasPart(warning, "inside out"));
  EXPECT_GT(simulated.Filter->GetNumberOfInvertedTetrahedra(), 0);
  EXPECT_TRUE(HasPart(simulated.Filter->GetSummary(), "inside out"));
  EXPECT_LT(std::abs(simulated.Copy()->GetComponent(node, 2) + push + 1e-4), 1e-6);
  EXPECT_EQ(simulated.Copy()->GetComponent(bar->GetNumberOfPoints() - 1, 2), 0.0);
}

TEST(ElasticDeformation, WarningsOfSubclasses)
{
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1.0);
  Simulated<vtkMassSpringDeformation> springs(bar);
  springs.Filter->SetPoissonRatio(0.2);
  EXPECT_TRUE(HasPart(UpdateAndWarn(springs), "Poisson ratio of the body is less than 0.25"));
  springs.Filter->SetPoissonRatio(0.25);
  EXPECT_EQ(UpdateAndWarn(springs), std::string());
  // A handle that jumps far inverts tetrahedra for some frames, but not in the end.
  springs.Filter->SetHandleRadius(0.003);
  springs.Filter->SetHandlesData(
    MakeHandles({ { glm::dvec3(0.005, 0.005, 0.03), glm::dvec3(0.02, 0.005, 0.03) } }));
  springs.Filter->SetEndTime(2.0);
  for (const double time : { springs.Filter->GetFrameTime(), 2.0 })
  {
    springs.Filter->Reset();
    springs.Filter->UpdateTimeStep(time);
    EXPECT_EQ(springs.Filter->GetNumberOfInvertedTetrahedra() > 0, time < 2.0);
    EXPECT_EQ(springs.Observer->GetWarning(), time < 2.0);
    springs.Observer->Clear();
  }

  // By default one execution ends in equilibrium.
  Simulated<vtkFiniteElementDeformation> elements(bar);
  elements.Filter->SetGravity(0.0, -60.0, 0.0);
  EXPECT_EQ(elements.TryUpdate(), "");
  EXPECT_TRUE(elements.Filter->GetIsConverged());
  EXPECT_LE(elements.Filter->GetRelativeResidual(), 1e-6);
  Simulated<vtkFiniteElementDeformation> live(bar);
  live.Filter->SetModeToInteractive();
  live.Filter->SetGravity(0.0, -60.0, 0.0);
  EXPECT_TRUE(HasPart(UpdateAndWarn(live), "not in equilibrium after 2 steps"));
  live.Filter->Reset();
  EXPECT_FALSE(HasPart(UpdateAndWarn(live), "not in equilibrium"));
}

// After loads that are far too large, a body with another material starts at rest, and a new sheet
// cuts the body at rest.
TEST(ElasticDeformation, CorrectionsAfterGivingUp)
{
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetNumberOfNodes(2, 2, 11);
  lattice->SetBounds(0.0, 0.01, 0.0, 0.01, 0.0, 0.1);
  lattice->Update();
  vtkUnstructuredGrid* rod = lattice->GetOutput();
  FixPoints(rod, [](const glm::dvec3& p) { return p.z == 0.0; });
  const auto solve =
    [](Simulated<vtkFiniteElementDeformation>& elements, double youngModulus, double gravity)
  {
    elements.Filter->SetYoungModulus(youngModulus);
    elements.Filter->SetPoissonRatio(0.49);
    elements.Filter->SetGravity(gravity, 0.0, 0.0);
    elements.Filter->Update();
    elements.Observer->Clear();
  };
  const auto sheet = MakeHorizontalSheet(0.051);
  Simulated<vtkFiniteElementDeformation> expected(rod);
  solve(expected, 1e4, 9.81);
  const auto wanted = expected.Copy();
  for (const bool isCut : { false, true })
  {
    SCOPED_TRACE(isCut);
    Simulated<vtkFiniteElementDeformation> elements(rod);
    solve(elements, isCut ? 1e4 : 1.0, isCut ? 9810.0 : 9.81);
    EXPECT_FALSE(elements.Filter->GetIsConverged());
    EXPECT_GT(elements.Filter->GetNumberOfInvertedTetrahedra(), 0);
    elements.Filter->SetSheetData(isCut ? sheet.Get() : nullptr);
    solve(elements, 1e4, 9.81);
    EXPECT_TRUE(elements.Filter->GetIsConverged());
    EXPECT_EQ(elements.Filter->GetNumberOfInvertedTetrahedra(), 0);
    if (isCut)
    {
      EXPECT_EQ(elements.Filter->GetNumberOfSplitFaces(), 2);
      elements.Filter->UndoCut();
      solve(elements, 1e4, 9.81);
    }
    const auto found = elements.Copy();
    ASSERT_EQ(found->GetNumberOfValues(), wanted->GetNumberOfValues());
    for (vtkIdType i = 0; i < wanted->GetNumberOfValues(); ++i)
    {
      EXPECT_EQ(found->GetValue(i), wanted->GetValue(i));
    }
  }
}

// The elongation of a bar that hangs by its own weight is rho g L^2 / (2 E).
template <typename Filter, typename Settle>
void CheckHangingBar(const Settle& settle)
{
  for (const bool isMillimetre : { false, true })
  {
    const double unit = isMillimetre ? 1e-3 : 1.0;
    Simulated<Filter> simulated(MakeBar(unit));
    simulated.Filter->SetLengthUnit(isMillimetre ? Filter::MILLIMETRE : Filter::METRE);
    simulated.Filter->SetGravity(0.0, 0.0, 2.0);
    simulated.Filter->ElementResultsOn();
    settle(simulated);
    const double expected = 1000.0 * 2.0 * 0.03 * 0.03 / (2.0 * 1e4) / unit;
    constexpr double cube = 0.0025 * 0.0025 * 0.0025;
    const auto moved = simulated.Copy();
    const double found = moved->GetComponent(12 * 25 + 12, 2);
    // The elongation is smaller, since the fixed end cannot become narrower.
    EXPECT_TRUE(found > 0.94 * expected && found < expected);
    vtkCellData* cells = simulated.Filter->GetOutput()->GetCellData();
    // The mean stress in the cells at the fixed end is the weight divided by the area.
    double stress = 0.0;
    constexpr int lowest = 4 * 4 * 5;
    for (vtkIdType cell = 0; cell < lowest; ++cell)
    {
      const double volume = cell % 5 == 4 ? 1.0 / 3.0 : 1.0 / 6.0;
      stress += volume * cells->GetArray("Stress")->GetComponent(cell, 2) / 16.0;
      EXPECT_GT(cells->GetArray("DeformationGradientDeterminant")->GetComponent(cell, 0), 0.99);
    }
    const double weight = 1000.0 * 2.0 * (0.03 - 0.5 * 0.0025);
    EXPECT_LT(std::abs(stress - weight), 0.05 * weight);
    // The strain energy of all tetrahedra is half of the work of the weight.
    double energy = 0.0;
    double work = 0.0;
    for (vtkIdType cell = 0; cell < simulated.Filter->GetOutput()->GetNumberOfCells(); ++cell)
    {
      const double volume = cube * (cell % 5 == 4 ? 1.0 / 3.0 : 1.0 / 6.0);
      energy += volume * cells->GetArray("StrainEnergyDensity")->GetComponent(cell, 0);
      vtkNew<vtkIdList> nodes;
      simulated.Filter->GetOutput()->GetCellPoints(cell, nodes);
      for (vtkIdType i = 0; i < nodes->GetNumberOfIds(); ++i)
      {
        // The part of the weight of a tetrahedron that acts on this node.
        const double part = !HasMidSides<Filter> ? 0.25 : i < 4 ? -0.05 : 0.2;
        work += part * volume * 1000.0 * 2.0 * unit * moved->GetComponent(nodes->GetId(i), 2);
      }
    }
    std::cout << "energy divided by half of the work: " << energy / (0.5 * work) << "\n";
    EXPECT_LT(std::abs(energy - 0.5 * work), 0.01 * energy);
  }
}

TEST(ElasticDeformation, Times)
{
  Simulated<vtkMassSpringDeformation> simulated(MakeBar(1.0));
  simulated.Filter->SetGravity(3.0, 0.0, 0.0);
  // VTK would ignore the next time.
  simulated.At(0.0);
  EXPECT_TRUE(HasPart(simulated.Observer->GetWarningMessage(), "EndTime"));
  simulated.Observer->Clear();
  simulated.Filter->SetEndTime(1.0);
  simulated.Filter->UpdateInformation();
  const double* range =
    simulated.Filter->GetOutputInformation(0)->Get(vtkStreamingDemandDrivenPipeline::TIME_RANGE());
  EXPECT_TRUE(range && range[0] == 0.0 && range[1] == 1.0);
  const auto start = simulated.At(0.0);
  EXPECT_EQ(start->GetRange(-1)[1], 0.0);
  const auto half = simulated.At(0.05);
  EXPECT_EQ(simulated.Filter->GetTime(), 0.05);
  EXPECT_EQ(
    simulated.Filter->GetOutput()->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()), 0.05);
  const auto whole = simulated.At(0.1);
  EXPECT_FALSE(AreEqual(half, whole));
  // Earlier times, and the same times again, give the same results to the last bit.
  EXPECT_TRUE(AreEqual(simulated.At(0.05), half));
  EXPECT_TRUE(AreEqual(simulated.At(0.1), whole));
  EXPECT_EQ(simulated.At(0.0)->GetRange(-1)[1], 0.0);
  // An update over several frames gives the same result as several updates.
  EXPECT_TRUE(AreEqual(simulated.At(0.1), whole));
  simulated.Filter->Reset();
  EXPECT_EQ(simulated.Filter->GetTime(), 0.0);
  EXPECT_TRUE(AreEqual(simulated.At(0.05), half));

  // Without a requested time an update advances by one frame.
  Simulated<vtkMassSpringDeformation> free(MakeBar(1.0));
  free.Filter->SetGravity(3.0, 0.0, 0.0);
  free.Filter->SetFrameTime(0.05);
  EXPECT_EQ(free.TryUpdate(), "");
  EXPECT_EQ(free.Filter->GetTime(), 0.05);
  free.Filter->Update();
  free.Filter->UpdatePiece(1, 2, 0);
  free.Filter->UpdatePiece(0, 2, 0);
  EXPECT_EQ(free.Filter->GetTime(), 0.05); // nothing has changed
  EXPECT_EQ(free.TryUpdate(), "");
  EXPECT_EQ(free.Filter->GetTime(), 0.1);
}

// A simulation continues with other materials, and starts again with another mesh.
TYPED_TEST(ElasticModels, ContinuedSimulation)
{
  using Filter = TypeParam;
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1.0);
  Simulated<Filter> simulated(bar);
  simulated.Filter->SetGravity(0.0, 0.0, 2.0);
  EXPECT_EQ(simulated.TryUpdate(), "");
  vtkDataArray* array = simulated.Filter->GetOutput()->GetPointData()->GetVectors();
  EXPECT_EQ(std::string(array->GetName()), std::string("Displacement"));
  // Points and arrays are shared if no points are appended.
  EXPECT_TRUE(
    HasMidSides<Filter> || simulated.Filter->GetOutput()->GetPoints() == bar->GetPoints());
  EXPECT_TRUE(HasMidSides<Filter> ||
    simulated.Filter->GetOutput()->GetPointData()->GetArray("Fixed") ==
      bar->GetPointData()->GetArray("Fixed"));
  const double before = simulated.Copy()->GetRange(-1)[1];
  EXPECT_GT(before, 0.0);
  simulated.Filter->SetGravity(0.0, 0.0, 0.0);
  simulated.Filter->SetYoungModulus(2e4);
  EXPECT_EQ(simulated.TryUpdate(), "");
  EXPECT_EQ(simulated.Filter->GetOutput()->GetPointData()->GetVectors(), array);
  // An equal mesh does not start the simulation again.
  vtkNew<vtkUnstructuredGrid> equal;
  equal->DeepCopy(bar);
  simulated.Filter->SetInputData(equal);
  EXPECT_EQ(simulated.TryUpdate(), "");
  vtkSmartPointer<vtkUnstructuredGrid> other = MakeBar(0.5);
  simulated.Filter->SetInputData(other);
  EXPECT_TRUE(HasPart(UpdateAndWarn(simulated), "starts again from rest"));
  EXPECT_EQ(simulated.Copy()->GetRange(-1)[1], 0.0);
  // Cells that are written in place are another mesh, too.
  EXPECT_EQ(simulated.TryUpdate(), "");
  vtkNew<vtkIdList> nodes;
  other->GetCellPoints(0, nodes);
  const vtkIdType copy = other->GetPoints()->InsertNextPoint(other->GetPoint(nodes->GetId(0)));
  for (int i = 0; i < other->GetPointData()->GetNumberOfArrays(); ++i)
  {
    other->GetPointData()->GetArray(i)->InsertNextTuple(
      nodes->GetId(0), other->GetPointData()->GetArray(i));
  }
  other->GetCells()->GetConnectivityArray()->SetComponent(0, 0, static_cast<double>(copy));
  other->GetCells()->GetConnectivityArray()->Modified();
  other->Modified();
  simulated.Filter->Update();
  EXPECT_TRUE(
    HasPart(std::string(simulated.Observer->GetWarningMessage()), "starts again from rest"));
  simulated.Observer->Clear();
  EXPECT_EQ(simulated.Filter->GetOutput()->GetNumberOfPoints(),
    simulated.Filter->GetOutput()->GetPointData()->GetVectors()->GetNumberOfTuples());
  simulated.Filter->SetInputData(bar);
  simulated.Filter->Update();
  simulated.Observer->Clear();
  EXPECT_TRUE(
    HasPart(simulated.Filter->GetSummary(), "Nodes: " + std::to_string(NodesOfBar<Filter>) + "\n"));
}

// A point that no cell uses changes nothing, however far away it is.
TYPED_TEST(ElasticModels, UnusedPoint)
{
  using Filter = TypeParam;
  std::vector<glm::dvec3> ends;
  for (const bool isAdded : { false, true })
  {
    vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1.0);
    const vtkIdType last = bar->GetNumberOfPoints() - 1;
    if (isAdded)
    {
      bar->GetPoints()->InsertNextPoint(1e9, 0.0, 0.0);
      bar->GetPointData()->GetArray("Fixed")->InsertNextTuple1(0.0);
    }
    Simulated<Filter> simulated(bar);
    simulated.Filter->SetGravity(0.0, 0.0, 2.0);
    EXPECT_EQ(simulated.TryUpdate(), "");
    glm::dvec3 end;
    simulated.Copy()->GetTuple(last, &end.x);
    ends.push_back(end);
  }
  EXPECT_GT(glm::length(ends[0]), 0.0);
  EXPECT_LT(glm::distance(ends[0], ends[1]), 1e-6 * glm::length(ends[0]));
}

// Nodes that are fixed for a while are at rest when they are freed.
TEST(ElasticDeformation, FreedNodes)
{
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1.0);
  vtkDataArray* fixed = bar->GetPointData()->GetArray("Fixed");
  fixed->Fill(0.0);
  Simulated<vtkMassSpringDeformation> falling(bar);
  const auto advance = [&](double gravity)
  {
    falling.Filter->SetGravity(0.0, 0.0, gravity);
    EXPECT_EQ(falling.TryUpdate(), "");
    return falling.Copy()->GetComponent(0, 2);
  };
  const double fallen = advance(9.81);
  EXPECT_GT(fallen, 0.0);
  fixed->Fill(1.0);
  fixed->SetComponent(bar->GetNumberOfPoints() - 1, 0, 0.0); // one node has to be free
  fixed->Modified();
  EXPECT_EQ(advance(0.0), fallen);
  fixed->Fill(0.0);
  fixed->Modified();
  EXPECT_NEAR(
    advance(0.0), fallen, 0.1 * fallen); // with its old velocity it would be 3 times as far
  // SetArray() replaces the values without changing the modification time.
  const double last = falling.Copy()->GetComponent(0, 2);
  std::vector<unsigned char> all(static_cast<std::size_t>(bar->GetNumberOfPoints()), 1);
  all.back() = 0;
  vtkUnsignedCharArray::SafeDownCast(fixed)->SetArray(all.data(), bar->GetNumberOfPoints(), 1);
  EXPECT_EQ(advance(9.81), last);
}

// An abort of the update after a change of the material.
TYPED_TEST(ElasticModels, Aborted)
{
  using Filter = TypeParam;
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1.0);
  Simulated<Filter> simulated(bar);
  Simulated<Filter> wanted(bar);
  for (Simulated<Filter>* one : { &simulated, &wanted })
  {
    one->Filter->SetGravity(0.0, 0.0, 2.0);
    EXPECT_EQ(one->TryUpdate(), "");
    one->Filter->SetYoungModulus(2e4);
  }
  simulated.Filter->Modified();
  simulated.Abort();
  simulated.Filter->Update();
  EXPECT_EQ(simulated.Observer->GetErrorMessage(), "");
  EXPECT_EQ(simulated.Observer->GetWarningMessage(), "");
  EXPECT_EQ(wanted.TryUpdate(), "");
  EXPECT_TRUE(AreEqual(simulated.Copy(), wanted.Copy()));
}

TEST(ElasticDeformation, MisuseOfPresets)
{
  vtkNew<vtkFiniteElementDeformation> fresh;
  EXPECT_EQ(fresh->GetMaterialPreset(), static_cast<int>(vtkElasticDeformation::CUSTOM));
  fresh->SetMaterialPreset(-1);
  EXPECT_EQ(fresh->GetMaterialPreset(), static_cast<int>(vtkElasticDeformation::CUSTOM));
  fresh->SetMaterialPreset(8);
  EXPECT_EQ(fresh->GetMaterialPreset(), static_cast<int>(vtkElasticDeformation::BONE));
  for (const int preset : { -1, 0, 8, std::numeric_limits<int>::max() })
  {
    double values[3] = { 1.0, 2.0, 3.0 };
    EXPECT_FALSE(vtkElasticDeformation::GetMaterialPresetValues(preset, values));
    EXPECT_TRUE(values[0] == 1.0 && values[1] == 2.0 && values[2] == 3.0);
    EXPECT_FALSE(vtkElasticDeformation::GetMaterialPresetSource(preset));
    EXPECT_EQ(vtkElasticDeformation::GetMaterialPresetName(preset) != nullptr, preset == 0);
  }
  EXPECT_EQ(vtkElasticDeformation::GetMaterialPresetName(vtkElasticDeformation::LIVER),
    std::string("Liver"));

  // Values that a preset replaces are not checked, and are used again with CUSTOM.
  Simulated<vtkFiniteElementDeformation> simulated(MakeBar(1.0));
  simulated.Filter->SetDensity(-1.0);
  EXPECT_TRUE(HasPart(simulated.TryUpdate(), "density"));
  simulated.Filter->SetMaterialPresetToLiver();
  EXPECT_EQ(simulated.TryUpdate(), "");
  EXPECT_EQ(simulated.Filter->GetDensity(), -1.0);
  simulated.Filter->SetMaterialPresetToCustom();
  EXPECT_TRUE(HasPart(simulated.TryUpdate(), "density"));
}

// A preset gives the same result as its three values, to the last bit. Cell arrays have priority
// over presets.
TYPED_TEST(ElasticModels, MaterialPresets)
{
  using Filter = TypeParam;
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1.0);
  const auto simulate = [&](const auto& change)
  {
    Simulated<Filter> simulated(bar);
    simulated.Filter->SetGravity(1.0, 0.0, 2.0);
    simulated.Filter->SetFrameTime(1e-3);
    simulated.Filter->SetEndTime(1.0);
    change(simulated.Filter.Get());
    simulated.Filter->UpdateTimeStep(2e-3);
    EXPECT_FALSE(simulated.Observer->GetError());
    EXPECT_FALSE(simulated.Observer->GetWarning());
    return simulated.Copy();
  };
  const auto byNumbers = [&](double youngModulus, double poissonRatio, double density)
  {
    return simulate(
      [&](Filter* filter)
      {
        filter->SetYoungModulus(youngModulus);
        filter->SetPoissonRatio(poissonRatio);
        filter->SetDensity(density);
      });
  };
  const auto plain = simulate([](Filter*) {});
  for (int preset = Filter::BRAIN; preset <= Filter::BONE; ++preset)
  {
    double values[3];
    EXPECT_TRUE(Filter::GetMaterialPresetValues(preset, values));
    const auto moved = simulate([&](Filter* filter) { filter->SetMaterialPreset(preset); });
    EXPECT_GT(moved->GetRange(-1)[1], 0.0);
    EXPECT_FALSE(AreEqual(moved, plain));
    EXPECT_TRUE(AreEqual(moved, byNumbers(values[0], values[1], values[2])));
  }
  EXPECT_TRUE(AreEqual(simulate([](Filter* filter) { filter->SetMaterialPresetToLiver(); }),
    byNumbers(5500.0, 0.49, 1060.0)));

  const auto stiffness = MakeArray<vtkDoubleArray>("YoungModulus", bar->GetNumberOfCells());
  stiffness->Fill(3e4);
  bar->GetCellData()->AddArray(stiffness);
  const auto moved = simulate([](Filter* filter) { filter->SetMaterialPresetToLiver(); });
  bar->GetCellData()->RemoveArray("YoungModulus");
  EXPECT_TRUE(AreEqual(moved, byNumbers(3e4, 0.49, 1060.0)));
}

// For small deformations both models give similar displacements, which deform a volume.
TEST(ElasticDeformation, DeformedVolume)
{
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1e-3);
  Simulated<vtkFiniteElementDeformation> elements(bar);
  Simulated<vtkMassSpringDeformation> springs(bar);
  const vtkSmartPointer<vtkPolyData> handles =
    MakeHandles({ { glm::dvec3(5.0, 5.0, 30.0), glm::dvec3(5.5, 5.0, 32.0) } });
  const auto prepare = [&](vtkElasticDeformation* filter)
  {
    filter->SetLengthUnitToMillimetre();
    filter->SetPoissonRatio(0.4);
    filter->SetHandlesData(handles);
    filter->SetHandleRadius(6.0);
  };
  prepare(elements.Filter);
  prepare(springs.Filter);
  elements.Filter->SetModeToConverged();
  springs.Filter->SetDamping(30.0);
  EXPECT_EQ(elements.TryUpdate(), "");
  EXPECT_TRUE(elements.Filter->GetIsConverged());
  const auto settled = springs.At(2.0);
  const auto equilibrium = elements.Copy();
  double largest = 0.0;
  for (vtkIdType i = 0; i < settled->GetNumberOfValues(); ++i)
  {
    largest = std::max(
      largest, std::abs(static_cast<double>(settled->GetValue(i) - equilibrium->GetValue(i))));
  }
  std::cout << "springs and elements differ by " << largest << " mm at most\n";
  EXPECT_LT(largest, 0.15);

  vtkNew<vtkImageData> volume;
  volume->SetDimensions(11, 11, 31);
  volume->AllocateScalars(VTK_SHORT, 1);
  volume->GetPointData()->GetScalars()->Fill(100.0);
  vtkNew<vtkDeformVolumeFilter> deform;
  deform->SetInputData(volume);
  deform->SetDeformationConnection(elements.Filter->GetOutputPort());
  deform->Update();
  EXPECT_EQ(deform->GetOutput()->GetDimensions()[2], 33);
}

// Handles hold the nodes within HandleRadius, in length units of the mesh. A node in the range of
// two handles is held by the first one.
TYPED_TEST(ElasticModels, HeldNodes)
{
  using Filter = TypeParam;
  const auto bar = MakeBar(0.001); // 10 x 10 x 30 mm in cells of 2.5 mm
  Simulated<Filter> simulated(bar);
  simulated.Filter->SetLengthUnitToMillimetre();
  simulated.Filter->SetHandleRadius(3.0);
  const std::vector<Handle> handles = { { { 5.0, 5.0, 30.0 }, { 5.5, 5.0, 30.0 } },
    { { 5.0, 5.0, 25.0 }, { 5.0, 5.5, 25.0 } } };
  simulated.Filter->SetHandlesData(MakeHandles(handles));
  EXPECT_EQ(simulated.TryUpdate(), "");
  const auto moved = simulated.Copy();
  int held[2] = { 0, 0 };
  for (vtkIdType i = 0; i < bar->GetNumberOfPoints(); ++i)
  {
    const glm::dvec3 point = GetPoint(bar, i);
    double tuple[3];
    moved->GetTuple(i, tuple);
    const glm::dvec3 displacement(tuple[0], tuple[1], tuple[2]);
    bool isHeld = false;
    for (int k = 0; k < 2 && !isHeld; ++k)
    {
      isHeld = glm::distance(point, handles[k].Rest) <= 3.0;
      held[k] += isHeld;
      EXPECT_TRUE(!isHeld || glm::distance(displacement, handles[k].Now - handles[k].Rest) < 1e-6);
    }
    EXPECT_TRUE(isHeld || glm::distance(displacement, glm::dvec3(0.5, 0.0, 0.0)) > 1e-6);
  }
  EXPECT_EQ(held[0], 6);
  EXPECT_EQ(held[1], 6); // seven nodes are in its range, but the first handle holds one of them
}

// After an error, no results of the update before are left.
TYPED_TEST(ElasticModels, ResultsAfterError)
{
  Simulated<TypeParam> simulated(MakeBar(0.001));
  simulated.Filter->SetLengthUnitToMillimetre();
  simulated.Filter->SetHandleRadius(3.0);
  simulated.Filter->SetHandlesData(MakeHandles({ { { 5.0, 5.0, 30.0 }, { 5.5, 5.0, 30.0 } } }));
  EXPECT_EQ(simulated.TryUpdate(), "");
  const auto countSteps = [&]
  {
    if constexpr (std::is_same_v<TypeParam, vtkMassSpringDeformation>)
    {
      return simulated.Filter->GetNumberOfSteps();
    }
    else
    {
      return simulated.Filter->GetNumberOfNewtonSteps();
    }
  };
  EXPECT_GT(simulated.Filter->GetNumberOfHeldNodes(), 0);
  EXPECT_GT(countSteps(), 0);
  EXPECT_NE(simulated.Filter->GetSummary(), "");
  simulated.Filter->SetPoissonRatio(0.6);
  EXPECT_NE(simulated.TryUpdate(), "");
  EXPECT_EQ(simulated.Filter->GetNumberOfHeldNodes(), 0);
  EXPECT_EQ(countSteps(), 0);
  EXPECT_EQ(simulated.Filter->GetSummary(), "");
  simulated.Filter->SetPoissonRatio(0.3);
  EXPECT_EQ(simulated.TryUpdate(), "");
  EXPECT_NE(simulated.Filter->GetSummary(), "");
}

// Hidden and duplicate cells, and cells with a hidden point, are not part of the body.
TYPED_TEST(ElasticModels, HiddenCells)
{
  using Filter = TypeParam;
  const auto bar = MakeBar(0.001);
  const auto simulate = [](vtkUnstructuredGrid* mesh)
  {
    Simulated<Filter> simulated(mesh);
    simulated.Filter->SetLengthUnitToMillimetre();
    simulated.Filter->SetGravity(0.0, 0.0, 9.81);
    EXPECT_EQ(simulated.TryUpdate(), std::string());
    const auto moved = simulated.Copy();
    const float* values = moved->GetPointer(0);
    return std::vector<float>(values, values + moved->GetNumberOfValues());
  };
  const vtkIdType corner = bar->GetNumberOfPoints() - 1;
  vtkNew<vtkUnstructuredGrid> cut;
  cut->SetPoints(bar->GetPoints());
  cut->GetPointData()->ShallowCopy(bar->GetPointData());
  vtkNew<vtkUnsignedCharArray> hidden;
  hidden->SetName(vtkDataSetAttributes::GhostArrayName());
  for (vtkIdType cell = 0; cell < bar->GetNumberOfCells(); ++cell)
  {
    vtkNew<vtkIdList> ids;
    bar->GetCellPoints(cell, ids);
    const bool isOfCorner = ids->IsId(corner) >= 0;
    hidden->InsertNextValue(isOfCorner ? vtkDataSetAttributes::HIDDENCELL : 0);
    if (!isOfCorner)
    {
      cut->InsertNextCell(VTK_TETRA, ids);
    }
  }
  EXPECT_LT(cut->GetNumberOfCells(), bar->GetNumberOfCells());
  const auto expected = simulate(cut);
  EXPECT_GT(*std::max_element(expected.begin(), expected.end()), 0.0F);
  vtkNew<vtkUnstructuredGrid> masked;
  masked->ShallowCopy(bar);
  masked->GetCellData()->AddArray(hidden);
  EXPECT_EQ(simulate(masked), expected);
  masked->ShallowCopy(bar);
  const auto valid = MakeArray<vtkUnsignedCharArray>("vtkValidPointMask", bar->GetNumberOfPoints());
  valid->Fill(1);
  valid->SetValue(corner, 0);
  masked->GetPointData()->AddArray(valid);
  EXPECT_EQ(simulate(masked), expected);
}

} // namespace

// The array "HeldNode" of the handles names nodes.
TEST(ElasticDeformation, HandlesOfNodes)
{
  const auto bar = MakeBar(0.001);
  Simulated<vtkFiniteElementDeformation> simulated(bar);
  simulated.Filter->SetLengthUnitToMillimetre();
  simulated.Filter->SetHandleRadius(3.0);
  const vtkIdType corner = bar->GetNumberOfPoints() - 1;
  const auto handles = MakeHandles({ { { 5.0, 5.0, 30.0 }, { 5.5, 5.0, 30.0 } } });
  vtkNew<vtkIntArray> nodes;
  nodes->SetName("HeldNode");
  nodes->InsertNextValue(static_cast<int>(corner));
  handles->GetPointData()->AddArray(nodes);
  simulated.Filter->SetHandlesData(handles);
  EXPECT_EQ(simulated.TryUpdate(), "");
  EXPECT_EQ(simulated.Filter->GetNumberOfHeldNodes(), 1);
  double moved[3];
  simulated.Copy()->GetTuple(corner, moved);
  EXPECT_NEAR(moved[0], 0.5, 1e-6);
  for (const int wrong : { 0, 1000000 }) // a fixed node, and no node
  {
    nodes->SetValue(0, wrong);
    EXPECT_TRUE(HasPart(simulated.TryUpdate(), "names node " + std::to_string(wrong)));
  }
  nodes->SetValue(0, -1);
  EXPECT_EQ(simulated.TryUpdate(), "");
  EXPECT_GT(simulated.Filter->GetNumberOfHeldNodes(), 1);
}

// A handle with no node within its radius holds the nodes of the tetrahedron that contains it:
// four, and six in the middle of edges. Outside of the mesh that is an error.
TEST(ElasticDeformation, HandlesBetweenNodes)
{
  Simulated<vtkFiniteElementDeformation> simulated(MakeBar(0.001));
  simulated.Filter->SetLengthUnitToMillimetre();
  simulated.Filter->SetHandleRadius(0.1);
  simulated.Filter->SetHandlesData(MakeHandles({ { { 4.1, 4.3, 21.0 }, { 4.6, 4.3, 21.0 } } }));
  EXPECT_EQ(simulated.TryUpdate(), "");
  EXPECT_EQ(simulated.Filter->GetNumberOfHeldNodes(), 10);
  simulated.Filter->SetHandlesData(MakeHandles({ { { 4.1, 4.3, 31.0 }, { 4.6, 4.3, 31.0 } } }));
  EXPECT_TRUE(HasPart(simulated.TryUpdate(), "no tetrahedron contains this position"));
}

// Nodes at the distance of the radius are held on all sides of a handle, in spite of rounding.
TEST(ElasticDeformation, HandleRadiusOfNodes)
{
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetNumberOfNodes(5, 5, 13);
  lattice->SetBounds(0.0, 9.6, 0.0, 9.6, 0.0, 28.8);
  lattice->Update();
  vtkUnstructuredGrid* bar = lattice->GetOutput();
  FixPoints(bar, [](const glm::dvec3& p) { return p.z == 0.0; });
  Simulated<vtkFiniteElementDeformation> simulated(bar);
  simulated.Filter->SetLengthUnitToMillimetre();
  simulated.Filter->SetHandleRadius(2.4);
  simulated.Filter->SetHandlesData(MakeHandles({ { { 4.8, 4.8, 14.4 }, { 4.8, 4.8, 15.0 } } }));
  EXPECT_EQ(simulated.TryUpdate(), "");
  // The nodes are 1.2 mm apart on each axis. The centers of cells have none.
  EXPECT_EQ(simulated.Filter->GetNumberOfHeldNodes(), 1 + 6 + 12 + 6);
}

TEST(ElasticDeformation, HangingBar)
{
  CheckHangingBar<vtkMassSpringDeformation>(
    [](Simulated<vtkMassSpringDeformation>& simulated)
    {
      simulated.Filter->SetDamping(30.0);
      simulated.Filter->SetPoissonRatio(0.4);
      simulated.At(2.0);
    });
  CheckHangingBar<vtkFiniteElementDeformation>(
    [](Simulated<vtkFiniteElementDeformation>& simulated)
    {
      simulated.Filter->SetModeToConverged();
      simulated.Filter->Update();
    });
}
