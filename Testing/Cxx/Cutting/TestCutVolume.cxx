// SPDX-License-Identifier: BSD-3-Clause
// Cuts by sheets and by a tool: misuse, numbers in volumes of different geometry, undo and redo.
#include "EditChecks.h"

#include "vtkCutVolume.h"

#include <vtkFieldData.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkPlaneSource.h>
#include <vtkPolyData.h>
#include <vtkTriangleFilter.h>

#include <limits>

using namespace filterTesting;

namespace
{

TEST(CutVolume, Misuse)
{
  Edited<vtkCutVolume> cut;
  auto volume = MakeVolume(CutBox);
  cut.Filter->SetInputData(MakeImage({ { 0, 8, 0, 8, 3, 3 } }));
  cut.Fails("two voxels");
  cut.Filter->SetInputData(volume);
  cut.Filter->SetSheetData(MakePlaneX(volume, 4.5));
  EXPECT_EQ(cut.CountOff(), 320);
  const auto before = cut.CopyMask();

  // A failure does not change the edits.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  auto bad = MakePlaneX(volume, 2.5);
  bad->GetPoints()->SetPoint(2, 1.0, nan, 0.0);
  cut.Filter->SetSheetData(bad);
  cut.Fails("Point 2 of the sheet is not finite");
  vtkNew<vtkPolyData> wrong;
  wrong->SetPoints(bad->GetPoints());
  wrong->AllocateEstimate(1, 3);
  const vtkIdType ids[3] = { 0, 1, 99 };
  wrong->InsertNextCell(VTK_TRIANGLE, 3, ids);
  cut.Filter->SetSheetData(wrong);
  cut.Fails("has point 99");
  vtkNew<vtkPolyData> lines;
  lines->SetPoints(MakePlaneX(volume, 2.5)->GetPoints());
  lines->AllocateEstimate(1, 2);
  lines->InsertNextCell(VTK_LINE, 2, ids);
  cut.Filter->SetSheetData(lines);
  cut.Fails("Set SweepVector");
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, MakePlaneX(volume, 2.5));
  cut.Filter->SetSheetData(blocks);
  cut.Fails("The data on input port 1 are a vtkMultiBlockDataSet");
  blocks->SetBlock(0, volume);
  cut.Filter->SetInputDataObject(blocks);
  cut.Fails("The data on input port 0 are a vtkMultiBlockDataSet");
  cut.Filter->SetInputData(volume);
  cut.Filter->SetSheetData(lines);
  cut.Filter->SetSweepVector(0.0, nan, 0.0);
  cut.Fails("SweepVector is not finite");
  cut.Filter->SetSweepVector(0.0, 0.0, 0.0);
  cut.Filter->SetSheetData(MakePlaneX(volume, 4.5));
  cut.Filter->AddToolPosition(0, 0, 0, 0, 9, 0);
  cut.Filter->AddToolPosition(nan, 0, 0, 0, 9, 0);
  cut.Fails("not finite");
  cut.Filter->ClearToolPositions();
  cut.Filter->SetDisplacementScale(nan);
  cut.Fails("DisplacementScale");
  cut.Filter->SetDisplacementScale(1.0);
  for (const int tuples : { 511, 513 })
  {
    auto other = MakeVolume(CutBox);
    other->GetCellData()->AddArray(MakeArray<vtkUnsignedCharArray>("ActiveTetrahedra", tuples));
    cut.Filter->SetInputData(other);
    cut.Fails("\"ActiveTetrahedra\"");
  }
  auto other = MakeVolume(CutBox);
  other->GetCellData()->AddArray(MakeArray<vtkShortArray>("ActiveTetrahedra", 512));
  cut.Filter->SetInputData(other);
  cut.Fails("Give it type unsigned char");
  cut.Filter->SetInputData(volume);
  auto mesh = MakeMesh(volume);
  cut.Filter->SetSheetData(MakePlaneX(volume, 2.5));
  cut.Filter->SetDeformationData(mesh);
  // The message must not name ports of vtkDeformVolumeFilter.
  cut.Fails(
    "The deformation mesh has no active Vectors of its points. It has no point arrays. Choose the "
    "displacements with SetInputArrayToProcess(),");
  SetDisplacements(mesh, Shift(0, 0, 0));
  mesh->Modified();
  cut.Filter->SetRestData(MakeMesh(volume, 4));
  cut.Fails("the mesh at rest has");
  cut.Filter->SetDeformationData(nullptr);
  cut.Fails("a mesh at rest on input port 3, but no deformation on input port 2");
  cut.Filter->SetRestData(nullptr);
  cut.Filter->SetSheetData(MakePlaneX(volume, 4.5));
  EXPECT_EQ(cut.CountOff(), 320);
  EXPECT_EQ(cut.CopyMask(), before);

  // Sheets that do not cut: one outside the volume, one without points, and none.
  cut.Filter->SetSheetData(MakePlaneX(volume, 44.5));
  EXPECT_EQ(cut.CountOff(), 0);
  cut.Filter->SetSheetData(vtkSmartPointer<vtkPolyData>::New());
  EXPECT_EQ(cut.CountOff(), 0);
  cut.Filter->SetSheetData(nullptr);
  EXPECT_EQ(cut.CountOff(), 0);
}

// Cuts do not depend on the origin, spacing and direction of the volume.
TEST(CutVolume, Geometry)
{
  std::vector<unsigned char> expected;
  for (int geometry = 0; geometry < 4; ++geometry)
  {
    auto volume = MakeVolume(CutBox);
    if (geometry > 0)
    {
      volume->SetOrigin(-12.3, 7.0, 1e3);
      volume->SetSpacing(0.37, geometry == 2 ? -2.0 : 2.0, 11.0);
    }
    if (geometry == 3)
    {
      SetObliqueDirection(volume);
    }
    Edited<vtkCutVolume> cut;
    cut.Filter->SetInputData(volume);
    for (const double x : { 4.0, 4.5 })
    {
      cut.Filter->SetSheetData(MakePlaneX(volume, x));
      EXPECT_EQ(cut.CountOff(), 320);
    }
    if (geometry == 0)
    {
      expected = cut.CopyMask();
    }
    EXPECT_EQ(cut.CopyMask(), expected);
    const glm::dvec3 corner(-20, 28, -30);
    cut.Filter->SetSheetData(
      MakePlane(volume, corner, glm::dvec3(50, -50, 0), glm::dvec3(0, 0, 70)));
    EXPECT_EQ(cut.CountOff(), 480);
  }
}

// Polygons, strips and swept lines cut like the triangles that they consist of.
TEST(CutVolume, Sheets)
{
  auto volume = MakeVolume(CutBox);
  Edited<vtkCutVolume> cut;
  cut.Filter->SetInputData(volume);
  vtkNew<vtkPlaneSource> plane;
  plane->SetOrigin(4.5, -2, -2);
  plane->SetPoint1(4.5, 11, -2);
  plane->SetPoint2(4.5, -2, 11);
  plane->SetResolution(3, 5);
  cut.Filter->SetSheetConnection(plane->GetOutputPort());
  EXPECT_EQ(cut.CountOff(), 320);
  vtkNew<vtkPolyData> strip;
  strip->SetPoints(MakePlaneX(volume, 4.0)->GetPoints());
  strip->AllocateEstimate(1, 4);
  const vtkIdType ids[4] = { 0, 1, 5, 2 };
  strip->InsertNextCell(VTK_TRIANGLE_STRIP, 4, ids);
  cut.Filter->SetSheetData(strip);
  EXPECT_EQ(cut.CountOff(), 320);
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(4.5, -2, -2);
  points->InsertNextPoint(4.5, 3.3, -2);
  points->InsertNextPoint(4.5, 11, -2);
  vtkNew<vtkPolyData> line;
  line->SetPoints(points);
  line->AllocateEstimate(1, 3);
  const vtkIdType order[3] = { 0, 1, 2 };
  line->InsertNextCell(VTK_POLY_LINE, 3, order);
  cut.Filter->SetSheetData(line);
  cut.Filter->SetSweepVector(0, 0, 13);
  EXPECT_EQ(cut.CountOff(), 320);
  cut.Filter->SetSweepVector(0, 0, 6);
  EXPECT_EQ(cut.CountOff(), 160);

  // Hidden and duplicate cells do not cut. Cells are numbered in the order vertices, lines,
  // polygons, strips.
  vtkNew<vtkPolyData> mixed;
  mixed->SetPoints(MakePlaneX(volume, 4.5)->GetPoints());
  mixed->AllocateEstimate(3, 4);
  mixed->InsertNextCell(VTK_TRIANGLE_STRIP, 4, ids);
  mixed->InsertNextCell(VTK_VERTEX, 1, ids);
  mixed->InsertNextCell(VTK_LINE, 2, ids);
  cut.Filter->SetSheetData(mixed);
  cut.Filter->SetSweepVector(0, 0, 54);
  for (const int kind : { vtkDataSetAttributes::DUPLICATECELL, vtkDataSetAttributes::HIDDENCELL })
  {
    const auto countOff = [&](std::initializer_list<vtkIdType> hidden)
    {
      auto ghosts = MakeArray<vtkUnsignedCharArray>(vtkDataSetAttributes::GhostArrayName(), 3);
      ghosts->Fill(0);
      for (const vtkIdType cell : hidden)
      {
        ghosts->SetValue(cell, static_cast<unsigned char>(kind));
      }
      mixed->GetCellData()->AddArray(ghosts);
      return cut.CountOff();
    };
    EXPECT_EQ(countOff({ 0, 1 }), 320);
    EXPECT_EQ(countOff({ 2 }), 160);
    EXPECT_EQ(countOff({ 1, 2 }), 0);
  }
}

TEST(CutVolume, Edits)
{
  auto volume = MakeVolume(CutBox);
  auto base = MakeArray<vtkUnsignedCharArray>("ActiveTetrahedra", 512);
  for (int i = 0; i < 512; ++i)
  {
    base->SetValue(i, static_cast<unsigned char>(i * 37 % 256));
  }
  volume->GetCellData()->AddArray(base);
  Edited<vtkCutVolume> cut;
  cut.Filter->SetInputData(volume);
  const auto start = cut.CopyMask();
  cut.Filter->Undo();
  cut.Filter->Redo();
  cut.Filter->Reset();
  EXPECT_EQ(cut.CopyMask(), start);
  for (int i = 0; i < 512; ++i)
  {
    EXPECT_EQ(int(start[static_cast<std::size_t>(i)]), i * 37 % 256);
  }

  // Tool positions are added one after another: each update cuts between the last two.
  std::vector<std::vector<unsigned char>> masks{ start };
  cut.Filter->AddToolPosition(1.5, -1, -1, 1.5, -1, 9);
  EXPECT_EQ(cut.CopyMask(), start);
  for (const double y : { 2.0, 4.0, 9.0 })
  {
    cut.Filter->AddToolPosition(1.5 + 0.1 * y, y, -1, 1.5 + 0.1 * y, y, 9);
    masks.push_back(cut.CopyMask());
    EXPECT_NE(masks.back(), masks[masks.size() - 2]);
  }
  EXPECT_EQ(cut.Filter->GetNumberOfToolPositions(), 4);
  // Giving the same list again, as user interfaces do, changes nothing.
  cut.Filter->ReplaceToolPositions();
  cut.Filter->AddToolPosition(1.5, -1, -1, 1.5, -1, 9);
  for (const double y : { 2.0, 4.0, 9.0 })
  {
    cut.Filter->AddToolPosition(1.5 + 0.1 * y, y, -1, 1.5 + 0.1 * y, y, 9);
  }
  EXPECT_EQ(cut.CopyMask(), masks.back());
  for (std::size_t i = masks.size() - 1; i > 0; --i)
  {
    cut.Filter->Undo();
    EXPECT_EQ(cut.CopyMask(), masks[i - 1]);
  }
  EXPECT_EQ(cut.Filter->GetNumberOfSwitchedOffTetrahedra(), 0);
  for (std::size_t i = 1; i < masks.size(); ++i)
  {
    cut.Filter->Redo();
    EXPECT_EQ(cut.CopyMask(), masks[i]);
  }
  // All positions in one update make the same cut.
  Edited<vtkCutVolume> once;
  once.Filter->SetInputData(volume);
  once.Filter->AddToolPosition(1.5, -1, -1, 1.5, -1, 9);
  for (const double y : { 2.0, 4.0, 9.0 })
  {
    once.Filter->AddToolPosition(1.5 + 0.1 * y, y, -1, 1.5 + 0.1 * y, y, 9);
  }
  EXPECT_EQ(once.CopyMask(), masks.back());

  // A sheet after the tool. When it moves, its cut is replaced, or with Accumulate another is
  // added.
  cut.Filter->SetSheetData(MakePlaneX(volume, 4.5));
  const auto withSheet = cut.CopyMask();
  cut.Filter->SetSheetData(MakePlaneX(volume, 6.5));
  cut.Filter->SetSheetData(MakePlaneX(volume, 4.5));
  EXPECT_EQ(cut.CopyMask(), withSheet);
  cut.Filter->AccumulateOn();
  cut.Filter->SetSheetData(MakePlaneX(volume, 6.5));
  const auto both = cut.CopyMask();
  for (std::size_t i = 0; i < both.size(); ++i)
  {
    EXPECT_EQ(both[i] & ~withSheet[i], 0);
  }
  EXPECT_NE(both, withSheet);
  cut.Filter->Undo();
  EXPECT_EQ(cut.CopyMask(), withSheet);
  cut.Filter->Undo();
  EXPECT_EQ(cut.CopyMask(), masks.back());
  cut.Filter->Reset();
  EXPECT_EQ(cut.CopyMask(), start);
  cut.Filter->Redo();
  EXPECT_EQ(cut.CopyMask(), start);

  // After ClearToolPositions() the same positions are another stroke.
  Edited<vtkCutVolume> again;
  again.Filter->SetInputData(volume);
  const auto move = [&](double y) { again.Filter->AddToolPosition(1.5, y, -1, 1.5, y, 9); };
  move(-1.0);
  move(9.0);
  const auto stroke = again.CopyMask();
  EXPECT_NE(stroke, start);
  again.Filter->Undo();
  EXPECT_EQ(again.CopyMask(), start);
  again.Filter->ClearToolPositions();
  move(-1.0);
  move(9.0);
  EXPECT_EQ(again.CopyMask(), stroke);
}

// The arrays of the output, and edits after changes of the volume.
TEST(CutVolume, Output)
{
  auto volume = MakeVolume(CutBox);
  volume->GetFieldData()->AddArray(MakeArray<vtkShortArray>("kept", 3));
  auto base = MakeArray<vtkUnsignedCharArray>("ActiveTetrahedra", 512);
  volume->GetCellData()->AddArray(base);
  Edited<vtkCutVolume> cut;
  cut.Filter->SetInputData(volume);
  cut.Filter->AddToolPosition(1.5, -1, -1, 1.5, -1, 9);
  cut.Filter->AddToolPosition(1.7, 9, -1, 1.7, 9, 9);
  cut.CopyMask();
  cut.Filter->Reset();
  cut.Filter->SetSheetData(MakePlaneX(volume, 3.5));
  cut.CopyMask();
  // Edits are kept when the mask of the volume changes.
  base->Fill(31);
  base->Modified();
  EXPECT_EQ(cut.CountOff(), 320);
  // Arrays of the volume are shared, and an update without changes does not modify the mask.
  vtkImageData* output = cut.Filter->GetOutput();
  EXPECT_EQ(output->GetPointData()->GetArray("value"), volume->GetPointData()->GetArray("value"));
  EXPECT_NE(output->GetFieldData()->GetAbstractArray("kept"), nullptr);
  vtkDataArray* array = output->GetCellData()->GetArray("ActiveTetrahedra");
  const vtkMTimeType time = array->GetMTime();
  cut.Filter->Modified();
  cut.Update();
  EXPECT_EQ(cut.Filter->GetOutput()->GetCellData()->GetArray("ActiveTetrahedra"), array);
  EXPECT_EQ(array->GetMTime(), time);
  // An array that a caller holds is not written again.
  const vtkSmartPointer<vtkDataArray> held = array;
  cut.Filter->SetSheetData(nullptr);
  EXPECT_EQ(cut.CountOff(), 0);
  EXPECT_NE(cut.Filter->GetOutput()->GetCellData()->GetArray("ActiveTetrahedra"), held);
  EXPECT_EQ(held->GetComponent(3, 0), 0.0);
  // The array of the volume is not changed.
  EXPECT_EQ(int(base->GetValue(3)), 31);
  // After a change of the geometry the tool positions cut again.
  volume->SetOrigin(1.0, 0.0, 0.0);
  EXPECT_GT(cut.CountOff(), 50);
}

} // namespace

TEST(CutVolume, Aborts)
{
  for (const bool isSmooth : { false, true })
  {
    CheckAborts<vtkCutVolume>(
      [=](vtkCutVolume* cut, vtkImageData* volume)
      {
        cut->SetSmoothCut(isSmooth);
        cut->SetSheetData(MakePlaneX(volume, 40.3));
        // The tool cuts the same edges as the sheet. With SmoothCut, tetrahedra that are cut twice
        // are switched off.
        cut->AddToolPosition(40.7, -9, -9, 40.7, -9, 99);
        cut->AddToolPosition(40.2, 99, -9, 40.2, 99, 99);
      });
  }
}
