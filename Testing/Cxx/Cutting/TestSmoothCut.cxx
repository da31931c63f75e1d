// SPDX-License-Identifier: BSD-3-Clause
// Cuts that divide tetrahedra: misuse, gaps between two moved planes, split meshes, undo and redo,
// chains of filters, tools, deformed volumes, coarse volumes and ChainMail. Kernels.TestSmoothCuts
// tests cuts that stay closed. Kernels.TestResampling compares labels and boundary distances beside
// cuts with a reference.
#include "ChainMailTesting.h"
#include "EditChecks.h"

#include "vtkCutVolume.h"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>

#include <cmath>
#include <map>

using namespace chainMailTesting;
using namespace filterTesting;

namespace
{

const char* const CELLS = "CutTetrahedra";
const char* const POINTS = "CutDistance";
const Extent Box{ { -2, 13, 0, 10, 1, 9 } };

// The arrays of the cut in an output, or null.
vtkUnsignedCharArray* GetCells(vtkImageData* image)
{
  return vtkUnsignedCharArray::SafeDownCast(image->GetCellData()->GetArray(CELLS));
}
vtkFloatArray* GetDistances(vtkImageData* image)
{
  return vtkFloatArray::SafeDownCast(image->GetPointData()->GetArray(POINTS));
}

struct Arrays
{
  std::vector<unsigned char> Mask, Cells;
  std::vector<float> Points;

  explicit Arrays(Edited<vtkCutVolume>& cut)
    : Mask(cut.CopyMask())
  {
    if (vtkUnsignedCharArray* cells = GetCells(cut.Filter->GetOutput()))
    {
      this->Cells.assign(cells->GetPointer(0), cells->GetPointer(0) + cells->GetNumberOfTuples());
    }
    if (vtkFloatArray* points = GetDistances(cut.Filter->GetOutput()))
    {
      this->Points.assign(
        points->GetPointer(0), points->GetPointer(0) + points->GetNumberOfTuples());
    }
  }
  bool operator==(const Arrays& other) const
  {
    return this->Mask == other.Mask && this->Cells == other.Cells && this->Points == other.Points;
  }
};

void SetUpCut(Edited<vtkCutVolume>& cut, vtkImageData* volume, double planeX)
{
  cut.Filter->SetInputData(volume);
  cut.Filter->SetSheetData(MakePlaneX(volume, planeX));
  cut.Filter->SmoothCutOn();
}

// A displacement field over the voxels that moves the two sides of the plane x = planeX by low and
// high.
vtkSmartPointer<vtkImageData> MakeField(
  vtkImageData* volume, double planeX, const glm::dvec3& low, const glm::dvec3& high)
{
  auto field = vtkSmartPointer<vtkImageData>::New();
  field->CopyStructure(volume);
  SetDisplacements(
    field, [=](const glm::dvec3& point) { return point + (point.x < planeX ? low : high); });
  return field;
}

TEST(SmoothCut, Misuse)
{
  auto volume = MakeVolume(Box);
  Edited<vtkCutVolume> cut;
  EXPECT_FALSE(cut.Filter->GetSmoothCut());
  SetUpCut(cut, volume, 4.3);
  const Arrays whole(cut);
  EXPECT_EQ(whole.Cells.size(), static_cast<std::size_t>(volume->GetNumberOfCells()));
  EXPECT_EQ(whole.Points.size(), static_cast<std::size_t>(volume->GetNumberOfPoints()));
  EXPECT_EQ(CountActive(whole.Cells), 5 * 10 * 8);
  auto field = MakeField(volume, 4.3, glm::dvec3(0.0), glm::dvec3(0.0));

  vtkImageData* output = cut.Filter->GetOutput();
  for (const int wrong : { 0, 1, 2, 3 })
  {
    vtkNew<vtkImageData> bad;
    bad->ShallowCopy(volume);
    if (wrong != 0)
    {
      bad->GetPointData()->AddArray(wrong == 2 ? MakeArray<vtkShortArray>(POINTS, 7, 1).Get()
                                               : output->GetPointData()->GetArray(POINTS));
    }
    if (wrong != 1)
    {
      bad->GetCellData()->AddArray(wrong == 3
          ? MakeArray<vtkShortArray>(CELLS, bad->GetNumberOfCells(), 1).Get()
          : output->GetCellData()->GetArray(CELLS));
    }
    const std::string words = wrong < 2 ? "needs both"
      : wrong == 2                      ? "\"CutDistance\""
                                        : "\"CutTetrahedra\"";
    filterTesting::Deformed deformed(bad, field);
    deformed.VerifyFailure(words);
    Edited<vtkCutVolume> next;
    SetUpCut(next, bad, 8.1);
    next.Fails(words);
  }

  filterTesting::Deformed deformed;
  deformed.Filter->SetInputConnection(cut.Filter->GetOutputPort());
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.25, 0, 0));
  deformed.Filter->SetDeformationData(mesh);
  deformed.Filter->SetResamplerToMeshRasterization();
  deformed.VerifyFailure("smooth cuts");
  deformed.Filter->SetResamplerToAutomatic();
  deformed.Filter->SetInterpolationToCubicInterpolation();
  deformed.Update();
  EXPECT_EQ(deformed.Filter->GetResamplerInUse(), vtkDeformVolumeFilter::EXACT);
  deformed.Filter->SetInterpolationToLinearInterpolation();
  deformed.Update();
  EXPECT_EQ(deformed.Filter->GetResamplerInUse(), vtkDeformVolumeFilter::EXACT);
  deformed.Filter->SetResamplerToExact();
  deformed.Update();
  EXPECT_TRUE(
    !GetCells(deformed.Filter->GetOutput()) && !GetDistances(deformed.Filter->GetOutput()));
}

// Two triangles of opposite orientation divide as one sheet, also with triangles without area, and
// with a triangle that the sheet has twice.
TEST(SmoothCut, TrianglesWithoutArea)
{
  auto volume = MakeVolume(Box);
  const auto divide = [&](const std::vector<std::array<vtkIdType, 3>>& triangles)
  {
    vtkNew<vtkPoints> points;
    for (const glm::dvec3& index : { glm::dvec3(4.3, -5.0, -5.0), glm::dvec3(4.8, 15.0, -5.0),
           glm::dvec3(5.1, -5.0, 15.0), glm::dvec3(5.6, 15.0, 15.0), glm::dvec3(4.8, 15.0, -5.0) })
    {
      const glm::dvec3 point = GetWorld(volume, index);
      points->InsertNextPoint(&point.x);
    }
    auto sheet = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkCellArray> cells;
    for (const std::array<vtkIdType, 3>& triangle : triangles)
    {
      cells->InsertNextCell(3, triangle.data());
    }
    sheet->SetPoints(points);
    sheet->SetPolys(cells);
    Edited<vtkCutVolume> cut;
    SetUpCut(cut, volume, 0.0);
    cut.Filter->SetSheetData(sheet);
    EXPECT_EQ(cut.CountOff(), 0);
    return Arrays(cut);
  };
  const Arrays plane = divide({ { 0, 1, 2 }, { 1, 3, 2 } });
  EXPECT_GT(
    std::count_if(plane.Cells.begin(), plane.Cells.end(), [](int cell) { return cell; }), 70);
  EXPECT_TRUE(divide({ { 0, 1, 2 }, { 1, 2, 3 } }) == plane);
  EXPECT_TRUE(divide({ { 0, 1, 2 }, { 1, 2, 3 }, { 1, 2, 2 } }) == plane);
  EXPECT_TRUE(divide({ { 0, 1, 2 }, { 4, 2, 3 }, { 1, 2, 4 } }) == plane);
  EXPECT_TRUE(divide({ { 0, 1, 2 }, { 1, 3, 2 }, { 3, 2, 1 } }) == plane);
}

// The gap between the two moved planes is empty, and all other samples of the volume are covered,
// at four samples a voxel.
TEST(SmoothCut, Gap)
{
  auto volume = MakeVolume(Box);
  const double planeX = 4.3;
  Edited<vtkCutVolume> cut;
  SetUpCut(cut, volume, planeX);
  auto field = MakeField(volume, planeX, { -1.25, 0, 0.5 }, { 2.0, -0.75, 0 });
  filterTesting::Deformed open;
  open.Filter->SetInputConnection(cut.Filter->GetOutputPort());
  open.Filter->SetDeformationData(field);
  open.Filter->SetOutputSpacingModeToCustomSpacing();
  open.Filter->SetCustomSpacing(0.25, 0.25, 0.25);
  vtkImageData* output = open.Update();
  vtkIdType covered = 0;
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    const auto isIn = [&](const glm::dvec3& p)
    {
      return p.x >= Box[0] && p.x <= Box[1] && p.y >= Box[2] && p.y <= Box[3] && p.z >= Box[4] &&
        p.z <= Box[5];
    };
    // All samples are at least 1/20 from the planes, which is more than the rounding of the sheet
    // and of positions.
    const glm::dvec3 point = GetPoint(output, id);
    const glm::dvec3 low = point - glm::dvec3(-1.25, 0, 0.5);
    const glm::dvec3 high = point - glm::dvec3(2.0, -0.75, 0);
    const bool expected = (isIn(low) && low.x < planeX) || (isIn(high) && high.x > planeX);
    EXPECT_EQ(open.IsCovered(id), expected);
    covered += expected ? 1 : 0;
  }
  // Without SmoothCut a layer of cells is missing.
  cut.Filter->SmoothCutOff();
  open.Update();
  EXPECT_EQ(cut.CountOff(), 5 * 10 * 8);
  EXPECT_TRUE(!GetCells(cut.Filter->GetOutput()) && !GetDistances(cut.Filter->GetOutput()));
  EXPECT_LT(open.Filter->GetNumberOfCoveredVoxels(), 0.96 * static_cast<double>(covered));
}

// Two lattices that meet at the cut and share no nodes.
TEST(SmoothCut, SplitMesh)
{
  auto volume = MakeVolume(Box);
  const double planeX = 4.25;
  vtkNew<vtkUnstructuredGrid> mesh;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  mesh->SetPoints(points);
  for (const int side : { 0, 1 })
  {
    const auto half = MakeTetrahedra(
      { { side ? planeX : -3.0, side ? 14.0 : planeX, -1.0, 11.0, 0.0, 10.0 } }, { { 3, 3, 3 } });
    const vtkIdType first = points->GetNumberOfPoints();
    for (vtkIdType id = 0; id < half->GetNumberOfPoints(); ++id)
    {
      points->InsertNextPoint(half->GetPoint(id));
    }
    for (vtkIdType cell = 0; cell < half->GetNumberOfCells(); ++cell)
    {
      vtkNew<vtkIdList> ids;
      half->GetCellPoints(cell, ids);
      for (vtkIdType k = 0; k < 4; ++k)
      {
        ids->SetId(k, ids->GetId(k) + first);
      }
      mesh->InsertNextCell(VTK_TETRA, ids);
    }
  }
  const vtkIdType half = points->GetNumberOfPoints() / 2;
  vtkNew<vtkFloatArray> vectors;
  vectors->SetName("displacement");
  vectors->SetNumberOfComponents(3);
  for (vtkIdType id = 0; id < 2 * half; ++id)
  {
    vectors->InsertNextTuple3(id < half ? -3.0 : 3.0, 0.0, 0.0);
  }
  mesh->GetPointData()->SetVectors(vectors);
  Edited<vtkCutVolume> cut;
  SetUpCut(cut, volume, planeX);
  for (const bool open : { false, true })
  {
    filterTesting::Deformed deformed;
    deformed.Filter->SetInputConnection(cut.Filter->GetOutputPort());
    deformed.Filter->SetDeformationData(mesh);
    deformed.Filter->SetOpenSplits(open);
    vtkImageData* output = deformed.Update();
    for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
    {
      const glm::dvec3 p = GetPoint(output, id);
      const bool expected =
        (p.x >= Box[0] - 3 && p.x < planeX - 3) || (p.x > planeX + 3 && p.x <= Box[1] + 3);
      EXPECT_EQ(deformed.IsCovered(id),
        expected && p.y >= Box[2] && p.y <= Box[3] && p.z >= Box[4] && p.z <= Box[5]);
    }
  }
}

TEST(SmoothCut, Edits)
{
  auto volume = MakeVolume(Box);
  Edited<vtkCutVolume> cut;
  cut.Filter->SetInputData(volume);
  cut.Filter->SmoothCutOn();
  cut.Filter->AccumulateOn();
  std::vector<Arrays> states{ Arrays(cut) };
  EXPECT_TRUE(states.front().Cells.empty());
  for (const double planeX : { 4.3, 8.6, 8.75 })
  {
    cut.Filter->SetSheetData(MakePlaneX(volume, planeX));
    states.emplace_back(cut);
  }
  EXPECT_EQ(CountActive(states[1].Cells), 400);
  EXPECT_EQ(CountActive(states[2].Cells), 800);
  EXPECT_EQ(cut.Filter->GetNumberOfDividedTetrahedra(), 400);
  // Two sheets between the same voxels: tetrahedra that both cross are switched off.
  EXPECT_EQ(CountActive(states[3].Cells), 400);
  EXPECT_EQ(cut.CountOff(), 400);
  for (std::size_t i = states.size() - 1; i-- > 0;)
  {
    cut.Filter->Undo();
    EXPECT_EQ(Arrays(cut), states[i]);
  }
  for (std::size_t i = 1; i < states.size(); ++i)
  {
    cut.Filter->Redo();
    EXPECT_EQ(Arrays(cut), states[i]);
  }
  cut.Filter->Reset();
  EXPECT_EQ(Arrays(cut), states.front());
  EXPECT_EQ(cut.Filter->GetNumberOfDividedTetrahedra(), 0);

  // A chain of two filters gives the same result, and both cuts can be undone.
  Edited<vtkCutVolume> first;
  Edited<vtkCutVolume> second;
  SetUpCut(first, volume, 4.3);
  SetUpCut(second, volume, 8.6);
  second.Filter->SetInputConnection(first.Filter->GetOutputPort());
  EXPECT_EQ(Arrays(second), states[2]);
  EXPECT_EQ(second.Filter->GetNumberOfDividedTetrahedra(), 400); // without those of the first
  first.Filter->Undo();
  second.Filter->Undo();
  EXPECT_TRUE(Arrays(second).Cells.empty());
  first.Filter->Redo();
  EXPECT_EQ(Arrays(second).Cells, states[1].Cells);
  second.Filter->Redo();
  EXPECT_EQ(Arrays(second), states[2]);
  // A filter with SmoothCut off passes the smooth cut of the first filter on.
  second.Filter->SmoothCutOff();
  const Arrays mixed(second);
  EXPECT_EQ(mixed.Cells, states[1].Cells);
  EXPECT_EQ(second.CountOff(), 400);

  // A deformation filter follows the edits.
  filterTesting::Deformed deformed;
  deformed.Filter->SetInputConnection(first.Filter->GetOutputPort());
  deformed.Filter->SetDeformationData(MakeField(volume, 4.3, { -2, 0, 0 }, { 2, 0, 0 }));
  deformed.Update();
  const vtkIdType open = deformed.Filter->GetNumberOfCoveredVoxels();
  first.Filter->Undo();
  deformed.Update();
  EXPECT_GT(deformed.Filter->GetNumberOfCoveredVoxels(), open);
  first.Filter->Redo();
  deformed.Update();
  EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), open);
}

// A tool that moves from update to update divides the same tetrahedra as one sheet.
TEST(SmoothCut, Tool)
{
  auto volume = MakeVolume(Box);
  Edited<vtkCutVolume> sheet;
  SetUpCut(sheet, volume, 4.3);
  const Arrays expected(sheet);
  Edited<vtkCutVolume> tool;
  tool.Filter->SetInputData(volume);
  tool.Filter->SmoothCutOn();
  for (const double y : { -3.0, 1.7, 4.1, 4.2, 8.0, 13.0 })
  {
    tool.Filter->AddToolPosition(4.3, y, -5, 4.3, y, 15);
    tool.Update();
  }
  const Arrays found(tool);
  EXPECT_EQ(found.Cells, expected.Cells);
  EXPECT_EQ(found.Mask, expected.Mask);
  for (std::size_t i = 0; i < found.Points.size(); ++i)
  {
    EXPECT_LT(std::abs(std::abs(found.Points[i]) - std::abs(expected.Points[i])), 1e-5F);
  }
  // Without the last two positions the cut ends inside the volume. No tetrahedron is switched off.
  tool.Filter->Undo();
  tool.Filter->Undo();
  const Arrays half(tool);
  EXPECT_TRUE(CountActive(half.Cells) > 100 && CountActive(half.Cells) < 200);
  EXPECT_EQ(tool.CountOff(), 0);
}

// A sheet cuts the deformed volume, which is moved by 1.5 voxels.
TEST(SmoothCut, DeformedVolume)
{
  auto volume = MakeVolume(Box);
  Edited<vtkCutVolume> rest;
  SetUpCut(rest, volume, 4.25);
  const Arrays expected(rest);
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(1.5, 0, 0));
  Edited<vtkCutVolume> seen;
  SetUpCut(seen, volume, 5.75);
  seen.Filter->SetDeformationData(mesh);
  EXPECT_EQ(Arrays(seen), expected);
}

TEST(SmoothCut, ChainMailAndCoarseVolume)
{
  auto volume = MakeVolume(Box);
  Edited<vtkCutVolume> smooth;
  SetUpCut(smooth, volume, 4.3);
  Edited<vtkCutVolume> hard;
  SetUpCut(hard, volume, 4.3);
  hard.Filter->SmoothCutOff();
  smooth.Update();
  hard.Update();
  // ChainMail's links are cut by a smooth cut as by any other.
  const std::vector<Handle> handles{ { { 8, 5, 5 }, { 11, 5, 5 } } };
  Dragged bySmooth(smooth.Filter->GetOutput());
  Dragged byHard(hard.Filter->GetOutput());
  vtkNew<vtkFloatArray> expected;
  expected->DeepCopy(byHard.Drag(handles));
  EXPECT_TRUE(HaveEqualBits(bySmooth.Drag(handles), expected));
  // In coarse volumes the cells that a smooth cut crosses are switched off.
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.25, 0, 0));
  vtkIdType covered[2];
  for (const bool isSmooth : { false, true })
  {
    filterTesting::Deformed coarse((isSmooth ? smooth : hard).Filter->GetOutput(), mesh);
    coarse.Filter->SetSamplingFactor(2);
    coarse.Update();
    covered[isSmooth ? 1 : 0] = coarse.Filter->GetNumberOfCoveredVoxels();
  }
  EXPECT_EQ(covered[0], covered[1]);
}

} // namespace
