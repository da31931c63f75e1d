// SPDX-License-Identifier: BSD-3-Clause
// OutsideMode KEEP: tissue outside the deformation mesh is kept, and its displacement fades to zero
// within FadeDistance.
#include "ArrayMaking.h"
#include "KeepTesting.h"

#include "vtkCutVolume.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <vtkAppendFilter.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkIdList.h>
#include <vtkPlaneSource.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <limits>
#include <random>
#include <string>
#include <vector>

using namespace filterTesting;

namespace
{

// A lattice of tetrahedra that fills a box.
vtkSmartPointer<vtkUnstructuredGrid> MakeBox(
  const glm::dvec3& min, const glm::dvec3& max, const glm::ivec3& nodes = glm::ivec3(4, 3, 3))
{
  auto mesh = MakeTetrahedra(
    { { min.x, max.x, min.y, max.y, min.z, max.z } }, { { nodes.x, nodes.y, nodes.z } });
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  return mesh;
}

vtkSmartPointer<vtkUnstructuredGrid> Join(vtkUnstructuredGrid* first, vtkUnstructuredGrid* second)
{
  vtkNew<vtkAppendFilter> append;
  append->AddInputData(first);
  append->AddInputData(second);
  append->Update();
  auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  mesh->DeepCopy(append->GetOutput());
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  return mesh;
}

// A volume with a short and a float array whose values vary in all directions.
vtkSmartPointer<vtkImageData> MakeTissue(
  const Extent& extent, const glm::dvec3& spacing = glm::dvec3(1.0))
{
  auto volume = MakeImage(extent, spacing);
  AddScalars<short>(volume, "value",
    [](const glm::dvec3& p)
    { return 400.0 * std::sin(0.7 * p.x) + 300.0 * std::cos(0.9 * p.y + 0.2 * p.z); });
  AddScalars<float>(volume, "more",
    [](const glm::dvec3& p)
    { return std::sin(1.3 * p.x + p.y) * p.z + 5.0 * std::cos(p.x * p.y); });
  return volume;
}

vtkSmartPointer<vtkFloatArray> AddDistances(
  vtkImageData* volume, const char* name, const WorldFunction& function)
{
  const auto array = MakeArray<vtkFloatArray>(name, volume->GetNumberOfPoints());
  for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
  {
    array->SetValue(id, static_cast<float>(function(GetPoint(volume, id))));
  }
  volume->GetPointData()->AddArray(array);
  return array;
}

TEST(DeformKeep, Misuse)
{
  const auto volume = MakeTissue({ { 0, 20, 0, 18, 0, 16 } });
  const auto mesh = MakeBox(glm::dvec3(5.2), glm::dvec3(11.7));
  Kept subject(volume, mesh, 4.0);
  EXPECT_EQ(subject.Filter->GetOutsideMode(), 2);
  EXPECT_EQ(static_cast<int>(vtkDeformVolumeFilter::DISCARD), 0);
  EXPECT_EQ(static_cast<int>(vtkDeformVolumeFilter::EXTRAPOLATE), 1);
  subject.Filter->SetOutsideMode(7);
  EXPECT_EQ(subject.Filter->GetOutsideMode(), 2);
  subject.Filter->SetOutsideMode(-3);
  EXPECT_EQ(subject.Filter->GetOutsideMode(), 0);
  vtkNew<vtkDeformVolumeFilter> unset;
  EXPECT_EQ(unset->GetFadeDistance(), 0.0);
  subject.Filter->SetOutsideModeToKeep();
  vtkNew<vtkImageData> expected;
  expected->DeepCopy(subject.Update());

  const auto restore = [&]
  {
    subject.Filter->SetFadeDistance(4.0);
    subject.Filter->SetResamplerToAutomatic();
    subject.Filter->OpenSplitsOff();
    subject.Filter->SetDeformationData(mesh);
    EXPECT_TRUE(AreEqual(subject.Update(), expected));
  };
  for (const double distance :
    { -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity() })
  {
    subject.Filter->SetFadeDistance(distance);
    subject.VerifyFailure("fade distance is ");
    restore();
  }
  subject.Filter->SetResamplerToMeshRasterization();
  subject.VerifyFailure("the outside mode KEEP");
  restore();
  subject.Filter->OpenSplitsOn();
  subject.VerifyFailure("OpenSplits");
  restore();
  subject.Filter->SetDeformationData(MakeBox(glm::dvec3(105.2), glm::dvec3(111.7)));
  subject.VerifyFailure("no voxel");
  restore();
  // A mesh between two layers of voxels moves only what fades.
  subject.Filter->SetDeformationData(MakeBox(glm::dvec3(5.2), glm::dvec3(5.7)));
  subject.Update();
  subject.Filter->SetFadeDistance(0.0);
  subject.VerifyFailure("no voxel");
  restore();
  // FadeDistance is not checked in other modes. Without a deformation KEEP has no effect.
  subject.Filter->SetFadeDistance(-1.0);
  subject.Filter->SetOutsideModeToDiscard();
  subject.Update();
  subject.Filter->SetOutsideModeToKeep();
  subject.Filter->SetFadeDistance(2.0);
  subject.Filter->SetDeformationData(nullptr);
  EXPECT_TRUE(HaveEqualBits(
    subject.Update()->GetPointData()->GetScalars(), volume->GetPointData()->GetScalars()));
}

// A mesh without displacements does not change the volume.
TEST(DeformKeep, AtRest)
{
  const auto volume = MakeTissue({ { -3, 20, 2, 18, 0, 16 } }, glm::dvec3(0.7, 1.1, 2.0));
  SetObliqueDirection(volume);
  Deformed itself;
  itself.Filter->SetInputData(volume);
  vtkImageData* expected = itself.Update();
  double bounds[6];
  volume->GetBounds(bounds);
  const glm::dvec3 center(
    0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]), 0.5 * (bounds[4] + bounds[5]));
  const auto mesh = MakeBox(center - 3.1, center + 4.2);
  for (const double distance : { 0.0, 2.5, 1e3 })
  {
    Kept subject(volume, mesh, distance);
    EXPECT_TRUE(AreEqual(subject.Expect(""), expected));
  }
}

// A box that moves along x: rest positions in a row through the box are compared with the inverse
// of the fading displacement. There are no holes and no inverted tetrahedra, and values far from
// the box do not change.
TEST(DeformKeep, MovedBox)
{
  const glm::dvec3 spacing(0.8, 1.25, 2.0);
  const auto volume = MakeImage({ { 0, 80, 0, 40, 0, 30 } }, spacing);
  AddScalars<short>(volume, "value",
    [](const glm::dvec3& p) { return 10.0 * std::sin(1.3 * p.x + p.y) * p.z + 70.0 * p.x; });
  AddScalars<float>(volume, "x", [](const glm::dvec3& p) { return p.x; });
  const glm::dvec3 min(24.1, 16.3, 22.6);
  const glm::dvec3 max(38.9, 30.2, 39.3);
  const auto mesh = MakeBox(min, max);
  for (const double distance : { 8.0, 12.5 })
  {
    const double shift = 2.9;
    SetDisplacements(mesh, Shift(shift, 0.0, 0.0));
    Kept subject(volume, mesh, distance);
    vtkImageData* output = subject.Expect("");
    EXPECT_EQ(GetExtent(output), GetExtent(volume));
    EXPECT_EQ(subject.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
    EXPECT_EQ(subject.Filter->GetNumberOfInvertedTetrahedra(), 0);
    vtkDataArray* found = output->GetPointData()->GetArray("x");
    const auto map = [&](double x) {
      return x + Fade(std::max({ min.x - x, x - max.x, 0.0 }) / distance) * shift;
    };
    // The displacement is interpolated linearly between voxels. The error is one eighth of the
    // square of the spacing times the second derivative. Positions are rounded to 1/512 voxel.
    const double error = 0.125 * spacing.x * spacing.x * 6.0 / (distance * distance) * shift;
    for (int i = 0; i <= 80; ++i)
    {
      const double x = i * spacing.x;
      double low = x - shift - 1.0;
      double high = x + 1.0;
      for (int step = 0; step < 60; ++step)
      {
        const double middle = 0.5 * (low + high);
        (map(middle) < x ? low : high) = middle;
      }
      int voxel[3] = { i, 18, 15 };
      const double value = found->GetComponent(output->ComputePointId(voxel), 0);
      // The least slope of the map is 1 - 1.5 shift / distance.
      const double steepest = 1.0 / (1.0 - 1.5 * shift / distance);
      const double rounding = spacing.x / 256.0;
      EXPECT_NEAR(value, low, steepest * (error + rounding)) << "voxel " << i;
    }
    vtkDataArray* before = volume->GetPointData()->GetArray("value");
    vtkDataArray* after = output->GetPointData()->GetArray("value");
    vtkIdType far = 0;
    for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
    {
      const glm::dvec3 p = GetPoint(volume, id);
      const double gap = glm::length(p - glm::clamp(p, min, max));
      if (gap > distance + shift + 2.0 * spacing.z)
      {
        EXPECT_EQ(after->GetComponent(id, 0), before->GetComponent(id, 0));
        ++far;
      }
    }
    EXPECT_GT(far, 1000);
  }
}

// Stretched or folded tissue is reported by one warning for each change.
TEST(DeformKeep, Warnings)
{
  const auto volume = MakeTissue({ { 0, 47, 0, 29, 0, 25 } });
  const auto two = Join(MakeBox(glm::dvec3(8.0, 8.0, 8.0), glm::dvec3(18.4, 20.0, 17.0)),
    MakeBox(glm::dvec3(25.6, 8.0, 8.0), glm::dvec3(36.0, 20.0, 17.0)));
  const auto apart = [&](double distance)
  {
    SetDisplacements(two,
      [=](const glm::dvec3& p)
      { return p + glm::dvec3(p.x < 22.0 ? -distance : distance, 0.0, 0.0); });
  };
  Kept subject(volume, two, 12.0);
  apart(0.9);
  subject.Expect("");
  apart(3.0);
  subject.Expect("are stretched over more than 2 output voxels, where the closest point");
  // Stretched tissue has no holes.
  EXPECT_GE(subject.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
  subject.Filter->SetPadding(1);
  subject.Expect("");
  apart(3.5);
  subject.Expect("are stretched");
  subject.Filter->SetFadeDistance(2.5);
  subject.Filter->Update();
  const std::string advice = subject.TakeWarning();
  EXPECT_TRUE(HasPart(advice, "moves by up to 3.5"));
  EXPECT_EQ(advice.find("smaller"), std::string::npos) << "the fade distance is too small already";
  apart(1.6);
  subject.Expect("");
  apart(1.7);
  subject.Expect("more than two thirds of the fade distance");
  subject.Filter->SetFadeDistance(0.0);
  apart(1.9);
  subject.Expect("");
  apart(2.1);
  subject.Expect("as the fade distance is 0");
}

// Tetrahedra that are switched off, hidden, carved out or divided are not reported as stretched.
TEST(DeformKeep, WarningsWithMasks)
{
  const auto volume = MakeTissue({ { 0, 24, 0, 19, 0, 17 } });
  const auto mesh = MakeBox(glm::dvec3(5.2), glm::dvec3(12.7));
  SetDisplacements(mesh, Shift(3.0, 0.0, 0.0));
  Kept subject(volume, mesh, 0.0);
  const std::string words = "as the fade distance is 0";
  subject.Expect(words);
  subject.Expect("");
  const auto isInside = [](const glm::dvec3& p)
  { return glm::clamp(p, glm::dvec3(5.2), glm::dvec3(12.7)) == p; };
  const auto active = AddActiveTetrahedra(volume);
  for (vtkIdType cell = 0; cell < volume->GetNumberOfCells(); ++cell)
  {
    vtkNew<vtkIdList> corners;
    volume->GetCellPoints(cell, corners);
    int inside = 0;
    for (vtkIdType k = 0; k < 8; ++k)
    {
      inside += isInside(GetPoint(volume, corners->GetId(k))) ? 1 : 0;
    }
    active->SetValue(cell, inside > 0 && inside < 8 ? 0 : 31);
  }
  SetDisplacements(mesh, Shift(3.1, 0.0, 0.0));
  subject.Expect("");
  int cell[3] = { 12, 8, 8 };
  active->SetValue(volume->ComputeCellId(cell), 31);
  active->Modified();
  subject.Expect("5 tetrahedra of the volume");
  volume->GetCellData()->RemoveArray("ActiveTetrahedra");
  // The tetrahedra are carved out.
  const auto distances = AddDistances(volume, "BoundaryDistance",
    [&](const glm::dvec3& p)
    { return glm::clamp(p, glm::dvec3(7.0), glm::dvec3(11.0)) == p ? 1.0 : -1.0; });
  SetDisplacements(mesh, Shift(3.2, 0.0, 0.0));
  subject.Expect("");
  distances->Fill(1.0);
  distances->Modified();
  subject.Expect(words);
  // A smooth cut along the boundary of the mesh divides them.
  const auto crossed = MakeArray<vtkUnsignedCharArray>("CutTetrahedra", volume->GetNumberOfCells());
  crossed->Fill(31.0);
  volume->GetCellData()->AddArray(crossed);
  AddDistances(
    volume, "CutDistance", [&](const glm::dvec3& p) { return isInside(p) ? -1.0 : 1.0; });
  SetDisplacements(mesh, Shift(3.3, 0.0, 0.0));
  subject.Expect("");
  volume->GetCellData()->RemoveArray("CutTetrahedra");
  volume->GetPointData()->RemoveArray("CutDistance");
  volume->Modified();
  subject.Expect(words);
}

// Displacements and masks change, and the mesh is split. The output must be equal to that of a new
// filter.
TEST(DeformKeep, Incremental)
{
  const auto volume = MakeTissue({ { 0, 69, 0, 49, 0, 45 } }, glm::dvec3(1.0, 0.8, 1.2));
  const auto mesh =
    MakeBox(glm::dvec3(14.2, 9.1, 13.7), glm::dvec3(50.6, 30.3, 40.2), glm::ivec3(10, 8, 8));
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  const auto active = AddActiveTetrahedra(volume);
  Kept subject(volume, mesh, 9.0);
  subject.Filter->SetOutputBoundsModeToVolumeBounds();
  subject.Filter->Update();
  const vtkIdType nodes = mesh->GetNumberOfPoints();
  vtkIdType parts = 0;
  for (int step = 0; step < 7; ++step)
  {
    vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
    for (int i = 0; i < 1 + step % 3; ++i)
    {
      const auto node = static_cast<vtkIdType>(random() % static_cast<unsigned int>(nodes));
      vectors->SetTuple3(node, uniform(random), uniform(random), uniform(random));
    }
    vectors->Modified();
    if (step % 4 == 1)
    {
      const auto cell =
        static_cast<vtkIdType>(random() % static_cast<unsigned int>(volume->GetNumberOfCells()));
      active->SetValue(cell, static_cast<unsigned char>(random() % 31));
      active->Modified();
    }
    if (step == 3 || step == 5)
    {
      // Some tetrahedra get a node of their own at the position of a shared node.
      vtkPoints* points = mesh->GetPoints();
      for (vtkIdType cell = step; cell < mesh->GetNumberOfCells(); cell += 400)
      {
        vtkNew<vtkIdList> ids;
        mesh->GetCellPoints(cell, ids);
        double point[3];
        points->GetPoint(ids->GetId(1), point);
        const vtkIdType twin = points->InsertNextPoint(point);
        vectors->InsertNextTuple3(0.5, -0.5, 0.25);
        ids->SetId(1, twin);
        mesh->GetCells()->ReplaceCellAtId(cell, ids);
      }
      mesh->GetCells()->Modified();
      points->Modified();
      vectors->Modified();
      mesh->Modified();
    }
    subject.Filter->Update();
    EXPECT_EQ(subject.TakeErrors(), 0);
    parts += GetReported(subject.Filter, "Bricks resampled") <
      GetReported(subject.Filter, "Bricks of the volume");
    Kept fresh(volume, mesh, 9.0);
    fresh.Filter->SetOutputBoundsModeToVolumeBounds();
    fresh.Filter->Update();
    EXPECT_EQ(fresh.TakeErrors(), 0);
    EXPECT_TRUE(AreEqual(subject.Filter->GetOutput(), fresh.Filter->GetOutput()));
    EXPECT_EQ(subject.Filter->GetNumberOfCoveredVoxels(), fresh.Filter->GetNumberOfCoveredVoxels());
  }
  EXPECT_GT(parts, 2);
  // The static mapping is kept after splits, and built again for another FadeDistance.
  EXPECT_EQ(GetReported(subject.Filter, "Static mappings made"), 1);
  subject.Filter->SetFadeDistance(8.0);
  subject.Filter->Update();
  EXPECT_EQ(GetReported(subject.Filter, "Static mappings made"), 2);
  // More new nodes than the static mapping has reserve for.
  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  for (int i = 0; i < 3000; ++i)
  {
    mesh->GetPoints()->InsertNextPoint(0.0, 0.0, 0.0);
    vectors->InsertNextTuple3(0.0, 0.0, 0.0);
  }
  mesh->GetPoints()->Modified();
  vectors->Modified();
  mesh->Modified();
  subject.Filter->Update();
  EXPECT_EQ(subject.TakeErrors(), 0);
  Kept fresh(volume, mesh, 8.0);
  fresh.Filter->SetOutputBoundsModeToVolumeBounds();
  fresh.Filter->Update();
  EXPECT_TRUE(AreEqual(subject.Filter->GetOutput(), fresh.Filter->GetOutput()));
}

// A sheet cuts kept tissue, and a smooth cut opens there. The reference is a field with the
// displacement of each voxel.
TEST(DeformKeep, Cut)
{
  const auto volume = MakeTissue({ { 0, 39, 0, 33, 0, 29 } });
  const glm::dvec3 min(12.2, 10.1, 9.3);
  const glm::dvec3 max(24.6, 20.3, 18.9);
  const auto mesh = MakeBox(min, max);
  const glm::dvec3 shift(2.0, -1.5, 0.75);
  SetDisplacements(mesh, Shift(shift.x, shift.y, shift.z));
  const auto field = MakeImage(GetExtent(volume));
  SetDisplacements(field,
    [&](const glm::dvec3& p)
    { return p + Fade(glm::length(p - glm::clamp(p, min, max)) / 7.0) * shift; });
  vtkNew<vtkPlaneSource> sheet;
  sheet->SetOrigin(2.3, -9.0, -5.1);
  sheet->SetPoint1(32.8, 49.0, -7.2);
  sheet->SetPoint2(6.7, -4.0, 45.3);
  const auto cut = [&](vtkDataObject* deformation)
  {
    auto filter = vtkSmartPointer<vtkCutVolume>::New();
    filter->SetInputData(volume);
    filter->SetSheetConnection(sheet->GetOutputPort());
    filter->SetDeformationData(deformation);
    filter->SetOutsideModeToKeep();
    filter->SetFadeDistance(7.0);
    if (deformation == field)
    {
      filter->SetOutsideModeToExtrapolate();
    }
    filter->Update();
    return filter;
  };
  const auto byMesh = cut(mesh);
  EXPECT_TRUE(HaveEqualBits(byMesh->GetOutput()->GetCellData()->GetArray("ActiveTetrahedra"),
    cut(field)->GetOutput()->GetCellData()->GetArray("ActiveTetrahedra")));
  EXPECT_GT(byMesh->GetNumberOfSwitchedOffTetrahedra(), 3000);
  // After a node has moved, the next cut uses the new positions of kept tissue.
  double x = 2.3;
  const auto renew = [&]
  {
    x += 0.4;
    sheet->SetOrigin(x, -9.0, -5.1);
  };
  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  vectors->SetTuple3(17, 0.0, 0.5, 0.0);
  vectors->Modified();
  renew();
  byMesh->Update();
  EXPECT_TRUE(HaveEqualBits(byMesh->GetOutput()->GetCellData()->GetArray("ActiveTetrahedra"),
    cut(mesh)->GetOutput()->GetCellData()->GetArray("ActiveTetrahedra")));

  vtkNew<vtkTest::ErrorObserver> errors;
  byMesh->AddObserver(vtkCommand::ErrorEvent, errors);
  vtkNew<vtkTest::ErrorObserver> failures; // errors of the executive
  byMesh->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, failures);
  byMesh->SetFadeDistance(-2.0);
  renew();
  byMesh->Update();
  EXPECT_TRUE(HasPart(errors->GetErrorMessage(), "fade distance is -2"));
  errors->Clear();
  byMesh->SetFadeDistance(2.0);
  byMesh->SetDeformationData(nullptr);
  byMesh->SmoothCutOn();
  Kept subject(volume, mesh, 7.0);
  subject.Filter->SetInputConnection(byMesh->GetOutputPort());
  Deformed expected(volume, field);
  expected.Filter->SetInputConnection(byMesh->GetOutputPort());
  vectors->SetTuple3(17, shift.x, shift.y, shift.z);
  vectors->Modified();
  subject.Expect("");
  expected.Update();
  EXPECT_EQ(
    subject.Filter->GetNumberOfCoveredVoxels(), expected.Filter->GetNumberOfCoveredVoxels());
}

// Pieces, other outside modes in between, SamplingFactor, and a finer output.
TEST(DeformKeep, OtherSettings)
{
  const auto volume = MakeTissue({ { 0, 41, 0, 33, 0, 29 } });
  const auto mesh = MakeBox(glm::dvec3(10.2, 9.1, 8.3), glm::dvec3(27.6, 21.3, 19.9));
  SetDisplacements(mesh, Shift(2.0, -1.5, 0.75));
  Kept subject(volume, mesh, 6.0);
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(subject.Expect(""));
  Kept pieces(volume, mesh, 6.0);
  VerifyPieces(pieces, 4, whole);
  subject.Filter->SetOutsideModeToDiscard();
  const vtkIdType all = subject.Filter->GetNumberOfCoveredVoxels();
  subject.Expect("");
  EXPECT_LT(subject.Filter->GetNumberOfCoveredVoxels(), all);
  subject.Filter->SetOutsideModeToExtrapolate();
  subject.Expect("");
  subject.Filter->SetOutsideModeToKeep();
  EXPECT_TRUE(AreEqual(subject.Expect(""), whole));
  subject.Filter->ReleaseDeviceMemory();
  subject.Filter->Modified();
  EXPECT_TRUE(AreEqual(subject.Expect(""), whole));

  // Every second voxel.
  subject.Filter->SetSamplingFactor(2);
  subject.Expect("");
  EXPECT_EQ(subject.Filter->GetNumberOfCoveredVoxels(), 21 * 17 * 15);
  subject.Filter->SetSamplingFactor(1);
  EXPECT_TRUE(AreEqual(subject.Expect(""), whole));

  // A finer output.
  subject.Filter->SetOutputSpacingModeToCustomSpacing();
  subject.Filter->SetCustomSpacing(0.5, 0.5, 0.5);
  subject.Expect("");
  EXPECT_EQ(subject.Filter->GetNumberOfCoveredVoxels(), 83 * 67 * 59);
}

// A larger mesh for the other resampler, which uses the nodes of the mesh alone.
TEST(DeformKeep, ThenRasterization)
{
  const auto volume = MakeTissue({ { 0, 20, 0, 18, 0, 16 } });
  const auto small = MakeBox(glm::dvec3(5.2), glm::dvec3(11.7));
  const auto large = MakeBox(glm::dvec3(0.0), { 20.0, 18.0, 16.0 }, glm::ivec3(16));
  SetDisplacements(small, Shift(0.5, 0.0, 0.0));
  SetDisplacements(large, Shift(1.0, -0.5, 0.25));
  Kept subject(volume, small, 4.0);
  subject.Update();
  Deformed expected(volume, large);
  for (Deformed* deformed : std::initializer_list<Deformed*>{ &subject, &expected })
  {
    deformed->Filter->SetOutsideModeToDiscard();
    deformed->Filter->SetResamplerToMeshRasterization();
    deformed->Filter->SetDeformationData(large);
  }
  EXPECT_TRUE(AreEqual(subject.Update(), expected.Update()));
  // And back.
  subject.Filter->SetOutsideModeToKeep();
  subject.Filter->SetResamplerToAutomatic();
  subject.Filter->SetDeformationData(small);
  Kept kept(volume, small, 4.0);
  EXPECT_TRUE(AreEqual(subject.Update(), kept.Update()));
}

} // namespace
