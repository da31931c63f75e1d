// SPDX-License-Identifier: BSD-3-Clause
// Cuts of the meshes of vtkMassSpringDeformation and vtkFiniteElementDeformation.
#include "ElasticTesting.h"

#include <vtkCellArray.h>
#include <vtkTetra.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

using namespace elasticTesting;

namespace
{

// A sheet across the bar, in a plane of constant x. from: its lowest z.
vtkSmartPointer<vtkPolyData> MakeSheet(double x, double from)
{
  auto sheet = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(x, -100.0, from);
  points->InsertNextPoint(x, 100.0, from);
  points->InsertNextPoint(x, 100.0, 100.0);
  points->InsertNextPoint(x, -100.0, 100.0);
  vtkNew<vtkCellArray> polygons;
  polygons->InsertNextCell({ 0, 1, 2, 3 });
  sheet->SetPoints(points);
  sheet->SetPolys(polygons);
  return sheet;
}

// A cut from the top to the middle of the bar. Handles pull its sides apart, and the volume opens.
template <typename Filter>
void CheckCut(const std::function<void(Simulated<Filter>&)>& settle)
{
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1e-3);
  Simulated<Filter> simulated(bar);
  simulated.Filter->SetLengthUnitToMillimetre();
  simulated.Filter->SetPoissonRatio(0.4);
  settle(simulated);
  EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 0);
  simulated.Filter->SetSheetData(MakeSheet(50.0, 0.0)); // does not intersect the bar
  settle(simulated);
  EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 0);
  EXPECT_EQ(simulated.Filter->GetOutput()->GetNumberOfPoints(), NodesOfBar<Filter>);
  simulated.Filter->SetSheetData(MakeSheet(5.0, 15.0));
  simulated.Filter->SetHandlesData(
    MakeHandles({ { glm::dvec3(0.0, 5.0, 30.0), glm::dvec3(-4.0, 5.0, 30.0) },
      { glm::dvec3(10.0, 5.0, 30.0), glm::dvec3(14.0, 5.0, 30.0) } }));
  simulated.Filter->SetHandleRadius(2.6);
  settle(simulated);
  EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 1);
  EXPECT_EQ(simulated.Filter->GetNumberOfSplitFaces(), 48);
  vtkUnstructuredGrid* output = simulated.Filter->GetOutput();
  // The nodes of 4 x 6 squares, each divided by a diagonal, without the five corners and the four
  // edges at the end of the cut.
  const vtkIdType appended = output->GetNumberOfPoints() - NodesOfBar<Filter>;
  EXPECT_EQ(appended, HasMidSides<Filter> ? 5 * 6 + 4 * 6 + 5 * 6 + 4 * 6 : 5 * 6);
  EXPECT_EQ(output->GetNumberOfCells(), bar->GetNumberOfCells());
  EXPECT_EQ(
    output->GetPointData()->GetArray("Fixed")->GetNumberOfTuples(), output->GetNumberOfPoints());

  vtkNew<vtkImageData> volume;
  volume->SetDimensions(41, 41, 121);
  volume->SetSpacing(0.25, 0.25, 0.25);
  volume->AllocateScalars(VTK_SHORT, 1);
  volume->GetPointData()->GetScalars()->Fill(100.0);
  vtkNew<vtkDeformVolumeFilter> deform;
  deform->SetInputData(volume);
  deform->SetDeformationConnection(simulated.Filter->GetOutputPort());
  deform->OpenSplitsOn();
  deform->Update();
  // The gap between the sides is empty. Below the cut there is no gap.
  vtkImageData* deformed = deform->GetOutput();
  const auto getValue = [&](double x, double y, double z)
  {
    double point[3] = { x, y, z };
    const vtkIdType voxel = deformed->FindPoint(point);
    return deformed->GetPointData()->GetScalars()->GetComponent(voxel, 0);
  };
  EXPECT_EQ(getValue(5.0, 5.0, 28.0), 0.0);
  EXPECT_EQ(getValue(0.0, 5.0, 28.0), 100.0);
  EXPECT_EQ(getValue(10.0, 5.0, 28.0), 100.0);
  EXPECT_EQ(getValue(5.0, 5.0, 5.0), 100.0);

  // The cut is kept when materials change. Then it is undone, and another sheet makes the same cut.
  simulated.Filter->SetYoungModulus(2e4);
  settle(simulated);
  EXPECT_EQ(simulated.Filter->GetOutput()->GetNumberOfPoints(), NodesOfBar<Filter> + appended);
  // After a reset, the body without the cut is at rest.
  simulated.Filter->Reset();
  simulated.Filter->UndoCut();
  simulated.Filter->SetHandlesData(nullptr);
  settle(simulated);
  EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 0);
  EXPECT_EQ(simulated.Filter->GetOutput()->GetNumberOfPoints(), NodesOfBar<Filter>);
  EXPECT_LT(simulated.Copy()->GetRange(-1)[1], 1e-4);
  simulated.Filter->SetSheetData(MakeSheet(5.0, 15.5));
  settle(simulated);
  EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 1);
  EXPECT_LT(simulated.Copy()->GetRange(-1)[1], 1e-4);
  simulated.Filter->ClearCuts();
  settle(simulated);
  EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 0);
}

// A piece that nothing holds after a cut falls in mass-spring dynamics. Finite elements freeze it,
// with a warning.
TEST(ElasticCuts, Pieces)
{
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1.0);
  const auto sheet = MakeHorizontalSheet(0.0151);
  Simulated<vtkMassSpringDeformation> springs(bar);
  springs.Filter->SetSheetData(sheet);
  springs.Filter->SetGravity(0.0, 0.0, 9.81);
  springs.Filter->SetDamping(0.0);
  const auto fallen = springs.At(0.1);
  const double top = fallen->GetComponent(324, 2);
  EXPECT_LT(std::abs(top - 0.5 * 9.81 * 0.01), 0.01 * top);
  Simulated<vtkFiniteElementDeformation> elements(bar);
  elements.Filter->SetSheetData(sheet);
  elements.Filter->SetGravity(0.0, 0.0, 9.81);
  elements.Filter->Update();
  EXPECT_TRUE(HasPart(elements.Observer->GetWarningMessage(),
    "1 pieces of the mesh are not held. The tetrahedron with the points "));
  elements.Observer->Clear();
  EXPECT_EQ(elements.Filter->GetNumberOfFrozenPieces(), 1);
  EXPECT_EQ(elements.Copy()->GetComponent(324, 2), 0.0F);
  EXPECT_GT(elements.Copy()->GetRange(-1)[1], 0.0);
}

// Checks that a cut does not change positions at rest of the corners of tetrahedra, and that new
// nodes have the array values of the nodes that they were split from.
void VerifyRestMesh(vtkUnstructuredGrid* cut, vtkUnstructuredGrid* whole)
{
  EXPECT_EQ(cut->GetNumberOfCells(), whole->GetNumberOfCells());
  vtkDataArray* fixed = cut->GetPointData()->GetArray("Fixed");
  vtkNew<vtkIdList> ids;
  vtkNew<vtkIdList> wholeIds;
  int different = 0;
  for (vtkIdType cell = 0; cell < whole->GetNumberOfCells(); ++cell)
  {
    cut->GetCellPoints(cell, ids);
    whole->GetCellPoints(cell, wholeIds);
    for (vtkIdType i = 0; i < 4; ++i)
    {
      different += GetPoint(cut, ids->GetId(i)) != GetPoint(whole, wholeIds->GetId(i));
      different += fixed->GetComponent(ids->GetId(i), 0) !=
        whole->GetPointData()->GetArray("Fixed")->GetComponent(wholeIds->GetId(i), 0);
    }
  }
  EXPECT_EQ(different, 0);
}

// An update that fails does not cut. The next successful update makes the cut.
template <typename Filter>
void CheckFailedCuts()
{
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1e-3);
  const auto prepare = [](Simulated<Filter>& simulated)
  {
    simulated.Filter->SetLengthUnitToMillimetre();
    simulated.Filter->SetHandleRadius(3.0);
    EXPECT_EQ(simulated.TryUpdate(), "");
  };
  const auto handles =
    MakeHandles({ { glm::dvec3(10.0, 5.0, 30.0), glm::dvec3(11.0, 5.0, 31.0) } });
  const auto sheet = MakeSheet(5.0, 15.0);
  Simulated<Filter> expected(bar);
  prepare(expected);
  expected.Filter->SetSheetData(sheet);
  expected.Filter->SetHandlesData(handles);
  EXPECT_EQ(expected.TryUpdate(), "");
  EXPECT_GT(expected.Filter->GetNumberOfSplitFaces(), 0);

  Simulated<Filter> simulated(bar);
  prepare(simulated);
  simulated.Filter->SetSheetData(sheet);
  simulated.Filter->SetHandlesData(MakeHandles({ { glm::dvec3(1e3), glm::dvec3(1e3) } }));
  EXPECT_TRUE(HasPart(simulated.TryUpdate(), "holds no node that could move"));
  EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 0);
  simulated.Filter->SetHandlesData(handles);
  EXPECT_EQ(simulated.TryUpdate(), "");
  EXPECT_EQ(simulated.Filter->GetNumberOfSplitFaces(), expected.Filter->GetNumberOfSplitFaces());
  EXPECT_EQ(simulated.Copy()->GetNumberOfTuples(), expected.Copy()->GetNumberOfTuples());
  for (vtkIdType i = 0; i < expected.Copy()->GetNumberOfValues(); ++i)
  {
    EXPECT_EQ(simulated.Copy()->GetValue(i), expected.Copy()->GetValue(i));
  }
}

// A failed update after UndoCut() and Reset(): the next successful update also does both.
TEST(ElasticCuts, FailedCutAfterOthers)
{
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1e-3);
  Simulated<vtkFiniteElementDeformation> simulated(bar);
  simulated.Filter->SetLengthUnitToMillimetre();
  simulated.Filter->SetHandleRadius(3.0);
  const auto handles =
    MakeHandles({ { glm::dvec3(10.0, 5.0, 30.0), glm::dvec3(14.0, 5.0, 31.0) } });
  simulated.Filter->SetHandlesData(handles);
  simulated.Filter->SetSheetData(MakeSheet(5.0, 15.0));
  EXPECT_EQ(simulated.TryUpdate(), "");
  EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 1);
  simulated.Filter->UndoCut();
  simulated.Filter->Reset();
  simulated.Filter->SetSheetData(MakeSheet(5.0, 20.0));
  simulated.Filter->SetHandlesData(MakeHandles({ { glm::dvec3(1e3), glm::dvec3(1e3) } }));
  EXPECT_TRUE(HasPart(simulated.TryUpdate(), "holds no node that could move"));
  EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 0);
  simulated.Filter->SetHandlesData(nullptr);
  EXPECT_EQ(simulated.TryUpdate(), "");
  EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 1);
  EXPECT_EQ(simulated.Copy()->GetRange(-1)[1], 0.0);
}

// A new sheet together with Reset(), or with an earlier time, cuts the body at rest. If that update
// fails, the body keeps its state, and the next update does both.
template <typename Filter>
void CheckCutsAtRest()
{
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1e-3);
  const auto handles = MakeHandles({ { glm::dvec3(5.0, 5.0, 30.0), glm::dvec3(13.0, 5.0, 40.0) } });
  const auto sheet = MakeSheet(5.0, 15.0);
  const auto prepare = [&](Simulated<Filter>& simulated)
  {
    simulated.Filter->SetLengthUnitToMillimetre();
    simulated.Filter->SetHandleRadius(6.0);
    simulated.Filter->SetHandlesData(handles);
    simulated.Filter->SetEndTime(9.0);
  };
  Simulated<Filter> expected(bar);
  prepare(expected);
  expected.Filter->SetSheetData(sheet);
  const auto wanted = expected.At(0.1);
  EXPECT_EQ(expected.Filter->GetNumberOfSplitFaces(), 48);
  for (const bool resets : { false, true })
  {
    SCOPED_TRACE(resets);
    Simulated<Filter> simulated(bar);
    prepare(simulated);
    const auto moved = simulated.At(0.3);
    if (resets)
    {
      simulated.Filter->Reset();
    }
    simulated.Filter->SetSheetData(sheet);
    simulated.Filter->SetHandlesData(MakeHandles({ { glm::dvec3(1e3), glm::dvec3(1e3) } }));
    simulated.Filter->UpdateTimeStep(0.1);
    EXPECT_TRUE(HasPart(simulated.Observer->GetErrorMessage(), "holds no node that could move"));
    simulated.Observer->Clear();
    EXPECT_EQ(simulated.Filter->GetTime(), resets ? 0.0 : 0.3);
    EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 0);
    simulated.Filter->SetHandlesData(handles);
    const auto found = simulated.At(0.1);
    EXPECT_EQ(simulated.Filter->GetNumberOfSplitFaces(), 48);
    ASSERT_EQ(found->GetNumberOfValues(), wanted->GetNumberOfValues());
    for (vtkIdType i = 0; i < wanted->GetNumberOfValues(); ++i)
    {
      EXPECT_EQ(found->GetValue(i), wanted->GetValue(i));
    }
  }
}

// Cuts that cross earlier cuts split nodes again. A new cut replaces an undone one.
template <typename Filter>
void CheckCutsOfCuts()
{
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1e-3);
  Simulated<Filter> simulated(bar);
  simulated.Filter->SetLengthUnitToMillimetre();
  const auto cut = [&](double x, double from, bool isTurned)
  {
    const auto sheet = MakeSheet(x, from);
    for (vtkIdType id = 0; isTurned && id < sheet->GetNumberOfPoints(); ++id)
    {
      const glm::dvec3 point = GetPoint(sheet, id);
      sheet->GetPoints()->SetPoint(id, point.y, point.x, point.z);
    }
    simulated.Filter->SetSheetData(sheet);
    EXPECT_EQ(simulated.TryUpdate(), "");
    VerifyRestMesh(simulated.Filter->GetOutput(), bar);
    return simulated.Filter->GetOutput()->GetNumberOfPoints();
  };
  const vtkIdType once = cut(5.0, 15.0, false);
  const vtkIdType twice = cut(5.0, 15.0, true);
  const vtkIdType thrice = cut(2.6, 15.0, true);
  EXPECT_TRUE(once > NodesOfBar<Filter> && twice > once && thrice > twice);
  EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 3);

  // The last cut is undone and another one is made in one update: the number of cuts is the same.
  simulated.Filter->UndoCut();
  const vtkIdType other = cut(2.6, 22.5, true);
  EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 3);
  EXPECT_TRUE(other > twice && other < thrice);
}

} // namespace

// The copies of a node share its force.
template <typename Filter>
void CheckForces()
{
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1e-3);
  AddPointVectors(
    bar, "Force", [](const glm::dvec3& p) { return glm::dvec3(0.0, 1e-6 * p.z, 0.0); });
  Simulated<Filter> simulated(bar);
  simulated.Filter->SetLengthUnitToMillimetre();
  const auto sum = [&]
  {
    EXPECT_EQ(simulated.TryUpdate(), "");
    vtkDataArray* forces = simulated.Filter->GetOutput()->GetPointData()->GetArray("Force");
    double total = 0.0;
    for (vtkIdType node = 0; node < forces->GetNumberOfTuples(); ++node)
    {
      total += forces->GetComponent(node, 1);
    }
    return total;
  };
  const double whole = sum();
  simulated.Filter->SetSheetData(MakeSheet(5.0, 15.0));
  EXPECT_NEAR(sum(), whole, 1e-12 * whole);
  simulated.Filter->SetSheetData(MakeSheet(2.6, 15.0));
  EXPECT_NEAR(sum(), whole, 1e-12 * whole);
  EXPECT_EQ(simulated.Filter->GetNumberOfCuts(), 2);
}

TEST(ElasticCuts, Forces)
{
  CheckForces<vtkMassSpringDeformation>();
  CheckForces<vtkFiniteElementDeformation>();

  // A free body has the same motion of its center of mass with and without the cut.
  const auto fly = [](bool isCut)
  {
    vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1e-3);
    bar->GetPointData()->RemoveArray("Fixed");
    AddPointVectors(bar, "Force",
      [](const glm::dvec3& p) { return glm::dvec3(0.0, p.x == 5.0 ? 1e-4 : 0.0, 0.0); });
    Simulated<vtkMassSpringDeformation> springs(bar);
    springs.Filter->SetLengthUnitToMillimetre();
    springs.Filter->SetDamping(0.0);
    springs.Filter->SetFrameTime(0.01);
    springs.Filter->SetSheetData(isCut ? MakeSheet(5.0, -1.0) : nullptr);
    EXPECT_EQ(springs.TryUpdate(), "");
    vtkUnstructuredGrid* output = springs.Filter->GetOutput();
    vtkDataArray* moved = output->GetPointData()->GetArray("Displacement");
    double sum = 0.0;
    for (vtkIdType cell = 0; cell < output->GetNumberOfCells(); ++cell)
    {
      double points[4][3];
      for (vtkIdType i = 0; i < 4; ++i)
      {
        output->GetPoint(output->GetCell(cell)->GetPointId(i), points[i]);
      }
      const double volume =
        std::abs(vtkTetra::ComputeVolume(points[0], points[1], points[2], points[3]));
      for (vtkIdType i = 0; i < 4; ++i)
      {
        sum += volume * moved->GetComponent(output->GetCell(cell)->GetPointId(i), 1);
      }
    }
    return sum;
  };
  EXPECT_NEAR(fly(true) / fly(false), 1.0, 1e-4);
}

TEST(ElasticCuts, CutsOfCuts)
{
  CheckCutsOfCuts<vtkMassSpringDeformation>();
  CheckCutsOfCuts<vtkFiniteElementDeformation>();
}

TEST(ElasticCuts, CutsAtRest)
{
  CheckCutsAtRest<vtkMassSpringDeformation>();
  CheckCutsAtRest<vtkFiniteElementDeformation>();
}

// The piece that a cut frees has its shape at rest again, as its results say.
TEST(ElasticCuts, FreePieceIsNotStrained)
{
  vtkSmartPointer<vtkUnstructuredGrid> bar = MakeBar(1e-3);
  Simulated<vtkFiniteElementDeformation> elements(bar);
  elements.Filter->SetLengthUnitToMillimetre();
  elements.Filter->SetHandleRadius(6.0);
  elements.Filter->SetHandlesData(
    MakeHandles({ { glm::dvec3(5.0, 5.0, 30.0), glm::dvec3(5.0, 12.0, 40.0) } }));
  EXPECT_EQ(elements.TryUpdate(), "");
  elements.Filter->SetHandlesData(nullptr);
  const auto sheet = MakeSheet(0.0, -100.0);
  for (vtkIdType id = 0; id < sheet->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 point = GetPoint(sheet, id);
    sheet->GetPoints()->SetPoint(id, point.z, point.y, 20.0);
  }
  elements.Filter->SetSheetData(sheet);
  elements.Filter->Update();
  EXPECT_TRUE(HasPart(elements.Observer->GetWarningMessage(), "1 pieces of the mesh are not held"));
  elements.Observer->Clear();
  EXPECT_EQ(elements.Filter->GetNumberOfFrozenPieces(), 1);
  vtkUnstructuredGrid* output = elements.Filter->GetOutput();
  const auto displacements = elements.Copy();
  glm::dvec3 low(1e9);
  glm::dvec3 high(-1e9);
  const auto look = [&](vtkIdType node)
  {
    glm::dvec3 moved(0.0);
    displacements->GetTuple(node, &moved.x);
    low = glm::min(low, moved);
    high = glm::max(high, moved);
    return GetPoint(output, node) + moved;
  };
  double most = 0.0;
  for (vtkIdType cell = 0; cell < output->GetNumberOfCells(); ++cell)
  {
    vtkNew<vtkIdList> ids;
    output->GetCellPoints(cell, ids);
    for (vtkIdType i = 1; i < 4; ++i)
    {
      const vtkIdType ends[2] = { ids->GetId(0), ids->GetId(i) };
      const double rest = glm::length(GetPoint(output, ends[1]) - GetPoint(output, ends[0]));
      most = std::max(most, std::abs(glm::length(look(ends[1]) - look(ends[0])) - rest));
    }
  }
  // The lower half has no load either.
  EXPECT_LT(most, 1e-4);
  EXPECT_GT(high.z, 1.0);
}

TEST(ElasticCuts, FailedCuts)
{
  CheckFailedCuts<vtkMassSpringDeformation>();
  CheckFailedCuts<vtkFiniteElementDeformation>();
}

TEST(ElasticCuts, Cut)
{
  CheckCut<vtkMassSpringDeformation>(
    [](Simulated<vtkMassSpringDeformation>& simulated)
    {
      simulated.Filter->SetDamping(30.0);
      simulated.Filter->SetFrameTime(0.5);
      EXPECT_EQ(simulated.TryUpdate(), "");
    });
  CheckCut<vtkFiniteElementDeformation>(
    [](Simulated<vtkFiniteElementDeformation>& simulated)
    {
      simulated.Filter->SetModeToConverged();
      EXPECT_EQ(simulated.TryUpdate(), "");
    });
}
