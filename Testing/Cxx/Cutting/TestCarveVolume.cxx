// SPDX-License-Identifier: BSD-3-Clause
// Carving by functions, surfaces, labels and a tool: misuse, numbers, undo and redo, and the
// deformed volume.
#include "EditChecks.h"

#include "vtkCarveVolume.h"
#include "vtkCutVolume.h"

#include <vtkBox.h>
#include <vtkCubeSource.h>
#include <vtkImplicitBoolean.h>
#include <vtkLineSource.h>
#include <vtkPlane.h>
#include <vtkSphere.h>
#include <vtkSphereSource.h>
#include <vtkStringArray.h>
#include <vtkTransform.h>

#include <limits>

using namespace filterTesting;

namespace
{

const double Nan = std::numeric_limits<double>::quiet_NaN();

// The volume of the tetrahedra that are switched off, in voxels.
double GetVolume(const std::vector<unsigned char>& mask)
{
  double volume = 0.0;
  for (const unsigned char byte : mask)
  {
    for (int t = 0; t < 5; ++t)
    {
      volume += (byte >> t & 1) != 0 ? 0.0 : t < 4 ? 1.0 / 6 : 1.0 / 3;
    }
  }
  return volume;
}

TEST(CarveVolume, Misuse)
{
  Edited<vtkCarveVolume> carve;
  auto volume = MakeVolume(CarvedBox);
  volume->GetPointData()->AddArray(
    MakeArray<vtkShortArray>("pairs", volume->GetNumberOfPoints(), 2));
  volume->GetPointData()->AddArray(MakeArray<vtkShortArray>("short", 5));
  vtkNew<vtkStringArray> words;
  words->SetName("words");
  words->SetNumberOfValues(volume->GetNumberOfPoints());
  volume->GetPointData()->AddArray(words);
  carve.Filter->SetInputData(volume);
  EXPECT_EQ(carve.CountOff(), 0); // nothing to carve with
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(5, 5, 5);
  sphere->SetRadius(3);
  carve.Filter->SetImplicitFunction(sphere);
  const auto before = carve.CopyMask();
  EXPECT_LT(CountActive(before), 5 * volume->GetNumberOfCells());

  vtkNew<vtkSphereSource> open;
  open->SetEndTheta(200);
  carve.Filter->SetSurfaceConnection(open->GetOutputPort());
  carve.Fails("is open");
  vtkNew<vtkSphereSource> closed;
  closed->Update();
  vtkNew<vtkPolyData> bad;
  bad->DeepCopy(closed->GetOutput());
  bad->GetPoints()->SetPoint(7, Nan, 0, 0);
  carve.Filter->SetSurfaceData(bad);
  carve.Fails("not finite");
  carve.Filter->SetSurfaceData(nullptr);
  carve.Filter->SetLabelArrayName("nothing");
  carve.Fails("has no point array \"nothing\"");
  for (const char* name : { "pairs", "short", "words" })
  {
    carve.Filter->SetLabelArrayName(name);
    carve.Fails("Give it a numeric type, 1 component and");
  }
  carve.Filter->SetLabelArrayName("");
  for (const double radius : { 0.0, -1.0, Nan })
  {
    carve.Filter->SetToolRadius(radius);
    carve.Fails("ToolRadius");
  }
  carve.Filter->SetToolRadius(1.0);
  carve.Filter->AddToolPosition(0, Nan, 0);
  carve.Fails("not finite");
  carve.Filter->ClearToolPositions();
  auto wrong = MakeVolume(CarvedBox);
  wrong->GetCellData()->AddArray(MakeArray<vtkUnsignedCharArray>("ActiveTetrahedra", 7));
  carve.Filter->SetInputData(wrong);
  carve.Fails("\"ActiveTetrahedra\"");
  carve.Filter->SetInputData(volume);
  EXPECT_EQ(carve.CopyMask(), before);
  vtkNew<vtkLineSource> line;
  carve.Filter->SetSurfaceConnection(line->GetOutputPort());
  carve.Fails("has lines and no triangles. Connect a closed surface of triangles.");
  carve.Filter->SetSurfaceConnection(nullptr);
  EXPECT_EQ(carve.CopyMask(), before);

  // A label that does not occur is reported once, as a warning.
  carve.Filter->SetLabelArrayName("value");
  carve.Filter->SetLabel(-12345);
  carve.Filter->Update();
  EXPECT_TRUE(HasPart(carve.Observer->GetWarningMessage(), "No voxel has the label"));
  carve.Observer->Clear();
  carve.Filter->Modified();
  EXPECT_EQ(carve.CopyMask(), before);
}

// Implicit functions of VTK, with and without known bounds, in volumes of different geometry.
TEST(CarveVolume, Functions)
{
  std::vector<unsigned char> unturned;
  for (int geometry = 0; geometry < 3; ++geometry)
  {
    auto volume = MakeVolume({ { 0, 48, 1, 49, -1, 47 } });
    double voxel = 1.0;
    if (geometry > 0)
    {
      volume->SetOrigin(3.0, -90.0, 12.0);
      volume->SetSpacing(0.5, 0.5, 0.25);
      voxel = 0.0625;
    }
    if (geometry == 2)
    {
      SetObliqueDirection(volume);
    }
    double middle[3];
    volume->GetCenter(middle);
    Edited<vtkCarveVolume> carve;
    carve.Filter->SetInputData(volume);
    vtkNew<vtkSphere> sphere;
    sphere->SetCenter(middle);
    const double radius = geometry == 0 ? 20.0 : 5.0;
    sphere->SetRadius(radius);
    carve.Filter->SetImplicitFunction(sphere);
    const auto carved = carve.CopyMask();
    const double expected = 4.0 / 3.0 * 3.14159265358979 * radius * radius * radius / voxel;
    // The bound that Documents/cutting.md states for spheres of a radius of 20 voxels.
    EXPECT_TRUE(geometry > 0 || std::abs(GetVolume(carved) - expected) < 0.0006 * expected);
    EXPECT_LT(std::abs(GetVolume(carved) - expected), 0.01 * expected);
    if (geometry == 1)
    {
      unturned = carved;
    }
    else if (geometry == 2)
    {
      // The direction changes only tetrahedra whose centroids are on the sphere.
      int different = 0;
      for (std::size_t cell = 0; cell < carved.size(); ++cell)
      {
        different += carved[cell] != unturned[cell] ? 1 : 0;
      }
      EXPECT_LT(different, 50);
    }
    // The same sphere as a function without known bounds. Such functions are evaluated in one
    // thread.
    vtkNew<vtkImplicitBoolean> wrapped;
    wrapped->AddFunction(sphere);
    carve.Filter->SetImplicitFunction(wrapped);
    EXPECT_EQ(carve.CopyMask(), carved);
    carve.Filter->SetImplicitFunction(nullptr);
    EXPECT_EQ(carve.CountOff(), 0);
    // A tool at one position.
    carve.Filter->SetToolRadius(radius);
    carve.Filter->AddToolPosition(middle[0], middle[1], middle[2]);
    EXPECT_EQ(carve.CopyMask(), carved);
    carve.Filter->Undo();
    carve.Filter->SetImplicitFunction(sphere);
    double last = GetVolume(carved);
    carve.Filter->SetRuleToMinimal();
    EXPECT_LT(GetVolume(carve.CopyMask()), last);
    carve.Filter->SetRuleToConservative();
    EXPECT_GT(GetVolume(carve.CopyMask()), last);
    // A change of the function causes an update.
    carve.Filter->SetRuleToCentroid();
    sphere->SetRadius(0.5 * radius);
    last = GetVolume(carve.CopyMask());
    EXPECT_LT(std::abs(last - expected / 8), 0.03 * expected / 8);
  }
  // A box of whole cells, and a plane.
  auto volume = MakeVolume(CarvedBox);
  Edited<vtkCarveVolume> carve;
  carve.Filter->SetInputData(volume);
  vtkNew<vtkBox> box;
  box->SetBounds(0, 4, 2, 5, 3, 10);
  carve.Filter->SetImplicitFunction(box);
  EXPECT_EQ(carve.CountOff(), 5 * 4 * 3 * 7);
  vtkNew<vtkTransform> shift;
  shift->Translate(-1, 0, 0);
  box->SetTransform(shift);
  const auto moved = carve.CopyMask();
  EXPECT_EQ(5 * volume->GetNumberOfCells() - CountActive(moved), 5 * 4 * 3 * 7);
  EXPECT_EQ(int(moved[static_cast<std::size_t>((2 * 13 + 2) * 16 + 6)]), 0); // x from 4 to 5
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(6, 0, 0);
  plane->SetNormal(1, 0, 0);
  carve.Filter->SetImplicitFunction(plane);
  EXPECT_EQ(carve.CountOff(), 5 * 8 * 13 * 14);
}

TEST(CarveVolume, Surfaces)
{
  auto volume = MakeVolume(CarvedBox);
  Edited<vtkCarveVolume> carve;
  carve.Filter->SetInputData(volume);
  // A cube whose faces contain voxels, and whose polygons share no points.
  vtkNew<vtkCubeSource> cube;
  cube->SetBounds(0, 4, 2, 5, 3, 10);
  carve.Filter->SetSurfaceConnection(cube->GetOutputPort());
  EXPECT_EQ(carve.CountOff(), 5 * 4 * 3 * 7);
  const auto carved = carve.CopyMask();
  cube->SetBounds(4, 9, 2, 5, 3, 10);
  EXPECT_EQ(carve.CountOff(), 5 * 5 * 3 * 7);
  carve.Filter->AccumulateOn();
  cube->SetBounds(0, 4, 2, 5, 3, 10);
  EXPECT_EQ(carve.CountOff(), 5 * 9 * 3 * 7);
  carve.Filter->Undo();
  carve.Filter->Undo();
  EXPECT_EQ(carve.CountOff(), 0);
  carve.Filter->Redo();
  carve.Filter->Redo();
  EXPECT_EQ(carve.CountOff(), 5 * 9 * 3 * 7);
  carve.Filter->Reset();
  EXPECT_EQ(carve.CountOff(), 0);
  vtkNew<vtkSphereSource> sphere;
  sphere->SetCenter(6.1, 6.3, 7.9);
  sphere->SetRadius(5);
  sphere->SetThetaResolution(80);
  sphere->SetPhiResolution(80);
  carve.Filter->SetSurfaceConnection(sphere->GetOutputPort());
  const double expected = 4.0 / 3.0 * 3.14159265358979 * 125;
  EXPECT_LT(std::abs(GetVolume(carve.CopyMask()) - expected), 0.02 * expected);
}

TEST(CarveVolume, Labels)
{
  auto volume = MakeVolume(CarvedBox);
  auto labels = AddLabels(volume);
  Edited<vtkCarveVolume> carve;
  carve.Filter->SetInputData(volume);
  carve.Filter->SetLabelArrayName("label");
  carve.Filter->SetLabel(7);
  carve.Filter->SetRuleToMinimal();
  EXPECT_EQ(carve.CountOff(), 5 * 8 * 13 * 14);
  carve.Filter->SetRuleToConservative();
  EXPECT_EQ(carve.CountOff(), 5 * 9 * 13 * 14);
  // In each cell of the layer between the labels, two corner tetrahedra have three vertices with
  // the label 7.
  carve.Filter->SetRuleToCentroid();
  EXPECT_EQ(carve.CountOff(), 5 * 8 * 13 * 14 + 2 * 13 * 14);
  labels->Fill(3);
  labels->SetValue(0, 7);
  labels->Modified();
  EXPECT_EQ(carve.CountOff(), 0);
  // SetArray() replaces the values without changing the modification time.
  std::vector<short> sevens(static_cast<std::size_t>(labels->GetNumberOfTuples()), 7);
  labels->SetArray(sevens.data(), labels->GetNumberOfTuples(), 1);
  carve.Filter->Modified();
  EXPECT_EQ(carve.CountOff(), 5 * volume->GetNumberOfCells());
}

// A tool that carves in several updates or in one, and a tool in a deformed volume.
TEST(CarveVolume, Tool)
{
  auto volume = MakeVolume(CarvedBox);
  Edited<vtkCarveVolume> steps;
  Edited<vtkCarveVolume> once;
  const double path[4][3] = { { 1, 2, 3 }, { 4, 5, 6 }, { 9, 5, 6 }, { 9, 5, 12 } };
  std::vector<std::vector<unsigned char>> masks;
  for (Edited<vtkCarveVolume>* carve : { &steps, &once })
  {
    carve->Filter->SetInputData(volume);
    carve->Filter->SetToolRadius(1.7);
    for (const double* position : path)
    {
      carve->Filter->AddToolPosition(position[0], position[1], position[2]);
      if (carve == &steps)
      {
        masks.push_back(carve->CopyMask());
      }
    }
  }
  EXPECT_EQ(once.CopyMask(), masks.back());
  once.Filter->Undo();
  EXPECT_EQ(once.CountOff(), 0);
  for (int i = 3; i > 0; --i)
  {
    steps.Filter->Undo();
    EXPECT_EQ(steps.CopyMask(), masks[static_cast<std::size_t>(i - 1)]);
  }
  // A stroke that begins like the last one, with a larger tool.
  Edited<vtkCarveVolume> widened;
  widened.Filter->SetInputData(volume);
  for (const double radius : { 1.7, 3.4 })
  {
    Edited<vtkCarveVolume> wanted;
    wanted.Filter->SetInputData(volume);
    for (Edited<vtkCarveVolume>* carve : { &widened, &wanted })
    {
      carve->Filter->ClearToolPositions();
      carve->Filter->SetToolRadius(radius);
      carve->Filter->AddToolPosition(4, 5, 6);
    }
    EXPECT_EQ(widened.CopyMask(), wanted.CopyMask());
  }
  // The deformation moves the volume by whole voxels, and the tool by as much.
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(2, -1, 3));
  Edited<vtkCarveVolume> deformed;
  deformed.Filter->SetInputData(volume);
  deformed.Filter->SetDeformationData(mesh);
  deformed.Filter->SetToolRadius(1.7);
  deformed.Filter->AddToolPosition(3, 1, 6);
  EXPECT_EQ(deformed.CopyMask(), masks.front());

  // The carved tetrahedra are a hole in the deformed volume.
  Deformed filter;
  filter.Filter->SetInputConnection(deformed.Filter->GetOutputPort());
  filter.Filter->SetDeformationData(mesh);
  filter.Update();
  const vtkIdType holed = filter.Filter->GetNumberOfCoveredVoxels();
  deformed.Filter->BlankCellsOn(); // does not change the deformed volume
  filter.Update();
  EXPECT_EQ(filter.Filter->GetNumberOfCoveredVoxels(), holed);
  deformed.Filter->Reset();
  filter.Update();
  EXPECT_LT(holed, filter.Filter->GetNumberOfCoveredVoxels());
  EXPECT_EQ(filter.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
}

// BlankCells hides cells that are cut or carved, in addition to hidden cells of the volume. The
// ghost array of the volume is not changed.
TEST(CarveVolume, BlankCells)
{
  auto volume = MakeVolume(CarvedBox);
  auto ghosts = MakeArray<vtkUnsignedCharArray>("vtkGhostType", volume->GetNumberOfCells());
  ghosts->FillValue(0);
  ghosts->SetValue(3, vtkDataSetAttributes::DUPLICATECELL);
  ghosts->SetValue(5, vtkDataSetAttributes::HIDDENCELL);
  volume->GetCellData()->AddArray(ghosts);
  Edited<vtkCutVolume> cut;
  cut.Filter->SetInputData(volume);
  cut.Filter->SetSheetData(MakePlaneX(volume, 4.5));
  cut.Filter->SmoothCutOn();
  Edited<vtkCarveVolume> carve;
  carve.Filter->SetInputConnection(cut.Filter->GetOutputPort());
  carve.Filter->AddToolPosition(9, 7, 8);
  carve.Filter->SetToolRadius(3.0);
  const auto bytes = [&carve](const char* name)
  {
    return vtkUnsignedCharArray::SafeDownCast(
      carve.Filter->GetOutput()->GetCellData()->GetArray(name));
  };
  carve.Update();
  EXPECT_EQ(bytes("vtkGhostType"), ghosts);
  carve.Filter->BlankCellsOn();
  carve.Update();
  const auto *active = bytes("ActiveTetrahedra"), *divided = bytes("CutTetrahedra");
  const auto* hidden = bytes("vtkGhostType");
  EXPECT_TRUE(active && divided && hidden && hidden != ghosts);
  vtkIdType counts[2] = { 0, 0 };
  for (vtkIdType i = 0; i < volume->GetNumberOfCells(); ++i)
  {
    const bool isCut = (divided->GetValue(i) & 31) != 0;
    const bool isCarved = (active->GetValue(i) & 31) != 31;
    counts[0] += isCut ? 1 : 0;
    counts[1] += isCarved ? 1 : 0;
    const int expected = (i == 3 ? vtkDataSetAttributes::DUPLICATECELL : 0) |
      (i == 5                 ? 32
          : isCut || isCarved ? 32 + 128
                              : 0);
    EXPECT_EQ(static_cast<int>(hidden->GetValue(i)), expected);
  }
  EXPECT_EQ(counts[0], 13 * 14); // one layer
  EXPECT_GT(counts[1], 100);
  EXPECT_EQ(static_cast<int>(ghosts->GetValue(5)), 32);

  // Without edits only the cells that the volume hides are hidden.
  carve.Filter->ClearToolPositions();
  carve.Filter->Reset();
  cut.Filter->Reset();
  carve.Update();
  for (vtkIdType i = 0; i < volume->GetNumberOfCells(); ++i)
  {
    EXPECT_EQ(bytes("vtkGhostType")->GetValue(i), ghosts->GetValue(i));
  }
}

// With BlankCells, too, only a part of the output is resampled after a small edit.
TEST(CarveVolume, BlankedUpdates)
{
  auto volume = MakeVolume({ { 0, 60, 0, 60, 0, 40 } });
  for (const bool isBlank : { false, true })
  {
    Edited<vtkCarveVolume> carve;
    carve.Filter->SetInputData(volume);
    carve.Filter->SetBlankCells(isBlank);
    carve.Filter->SetToolRadius(2.0);
    carve.Filter->AddToolPosition(9, 9, 9);
    Deformed filter;
    filter.Filter->SetInputConnection(carve.Filter->GetOutputPort());
    filter.Update();
    carve.Filter->AddToolPosition(10, 9, 9);
    filter.Update();
    const int* changed = filter.Filter->GetChangedExtent();
    EXPECT_TRUE(changed[0] <= 10 && changed[1] >= 10);
    EXPECT_LT(changed[1], 40);
  }
}

} // namespace

TEST(CarveVolume, Aborts)
{
  for (const bool isSmooth : { false, true })
  {
    CheckAborts<vtkCarveVolume>(
      [=](vtkCarveVolume* carve, vtkImageData*)
      {
        carve->SetSmoothBoundary(isSmooth);
        carve->SetToolRadius(9.0);
        carve->AddToolPosition(40, 50, 30);
      });
  }
}
