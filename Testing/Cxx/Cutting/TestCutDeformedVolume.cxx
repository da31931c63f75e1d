// SPDX-License-Identifier: BSD-3-Clause
// Cuts in a chain of filters: one cut after another, cuts of a deformed volume, and the gap of a
// cut that a deformation opens.
#include "EditChecks.h"
#include "Extent.h"

#include "vtkCutVolume.h"

#include <vtkRTAnalyticSource.h>

using namespace filterTesting;

namespace
{

TEST(CutDeformedVolume, Chain)
{
  auto volume = MakeVolume(CutBox);
  Edited<vtkCutVolume> first;
  Edited<vtkCutVolume> second;
  first.Filter->SetInputData(volume);
  first.Filter->SetSheetData(MakePlaneX(volume, 2.5));
  second.Filter->SetInputConnection(first.Filter->GetOutputPort());
  second.Filter->SetSheetData(MakePlaneX(volume, 2.0));
  second.Update();
  EXPECT_EQ(second.Filter->GetNumberOfSwitchedOffTetrahedra(), 320);
  second.Filter->SetSheetData(
    MakePlane(volume, glm::dvec3(-5, 4.5, -5), glm::dvec3(30, 0, 0), glm::dvec3(0, 0, 30)));
  std::vector<unsigned char> mask = second.CopyMask();
  EXPECT_EQ(CountActive(mask), 5 * 512 - 320 - 320 + 40);
  first.Filter->SetSheetData(nullptr);
  mask = second.CopyMask();
  EXPECT_EQ(CountActive(mask), 5 * 512 - 320);
}

// A sheet cuts the deformed volume, and the cut stays in the tissue when the deformation changes.
TEST(CutDeformedVolume, Deformed)
{
  auto volume = MakeVolume(CutBox);
  const double origin[3] = { 5.0, -3.0, 2.0 };
  volume->SetOrigin(origin[0], origin[1], origin[2]);
  volume->SetSpacing(0.5, 2.0, 1.5);
  SetObliqueDirection(volume);
  Edited<vtkCutVolume> rest;
  rest.Filter->SetInputData(volume);
  rest.Filter->SetSheetData(MakePlaneX(volume, 3.5));
  const auto expected = rest.CopyMask();
  // The volume moves by two voxels along its own x axis.
  const glm::dvec3 move =
    GetWorld(volume, glm::dvec3(2.0, 0.0, 0.0)) - GetWorld(volume, glm::dvec3(0.0));
  auto mesh = MakeMesh(volume, 4);
  auto restMesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  restMesh->DeepCopy(mesh);
  SetDisplacements(mesh, Shift(move.x, move.y, move.z));
  auto field = MakeImage({ { 0, 1, 0, 1, 0, 1 } }, glm::dvec3(60.0), glm::dvec3(-30.0));
  SetDisplacements(field, Shift(move.x, move.y, move.z));
  auto deformedMesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  deformedMesh->DeepCopy(restMesh);
  MovePoints(deformedMesh, Shift(move.x, move.y, move.z));
  enum Deformation
  {
    ByDisplacements,
    ByDeformedMesh,
    ByField
  };
  for (const Deformation deformation : { ByDisplacements, ByDeformedMesh, ByField })
  {
    Edited<vtkCutVolume> cut;
    cut.Filter->SetInputData(volume);
    if (deformation == ByDisplacements)
    {
      cut.Filter->SetDeformationData(mesh);
    }
    else if (deformation == ByDeformedMesh)
    {
      cut.Filter->SetDeformationData(deformedMesh);
      cut.Filter->SetRestData(restMesh);
    }
    else
    {
      cut.Filter->SetDeformationData(field);
    }
    cut.Filter->SetSheetData(MakePlaneX(volume, 5.5));
    EXPECT_EQ(cut.CopyMask(), expected);
    if (deformation == ByDisplacements)
    {
      // The deformation changes: the cut stays in the tissue. A new sheet cuts the volume in its
      // new position.
      cut.Filter->SetDisplacementScale(0.0);
      EXPECT_EQ(cut.CopyMask(), expected);
      cut.Filter->SetSheetData(MakePlaneX(volume, 3.5));
      EXPECT_EQ(cut.CopyMask(), expected);
    }
  }
}

// Cuts of a part of a volume are equal to those of the whole volume: at rest, and deformed by
// runs, by links and by a field.
TEST(CutDeformedVolume, Parts)
{
  vtkNew<vtkRTAnalyticSource> source;
  source->SetWholeExtent(-12, 19, 3, 30, -5, 22);
  source->Update();
  vtkImageData* volume = source->GetOutput();
  const auto bend = [](const glm::dvec3& p)
  { return p + glm::dvec3(0.02 * p.y * p.y, 0.3 * p.z, std::sin(0.3 * p.x)); };
  auto field = MakeImage({ { -3, 5, 0, 8, -2, 6 } }, glm::dvec3(4.7));
  SetDisplacements(field, bend);
  const auto sheet =
    MakeSheet(volume, { glm::dvec3(-30, 2, 9), glm::dvec3(52, -21, 13), glm::dvec3(5, 62, -14) });
  const std::vector<Extent> parts{ { { -12, 19, 3, 30, -5, 22 } }, { { -12, 4, 3, 30, -5, 22 } },
    { { 3, 19, 7, 20, 0, 9 } }, { { -1, 2, 3, 30, -5, 3 } } };
  enum Deformation
  {
    AtRest,
    ByRuns,
    ByLinks,
    ByField
  };
  for (const Deformation deformation : { AtRest, ByRuns, ByLinks, ByField })
  {
    auto mesh = MakeMesh(volume, deformation == ByRuns ? 3 : 25, -1.3);
    SetDisplacements(mesh, bend);
    for (const int outside :
      { vtkCutVolume::DISCARD, vtkCutVolume::EXTRAPOLATE, vtkCutVolume::KEEP })
    {
      if (deformation == ByField && outside == vtkCutVolume::KEEP)
      {
        continue; // KEEP needs a mesh
      }
      // The first part is the whole volume.
      vtkSmartPointer<vtkImageData> whole;
      for (const Extent& part : parts)
      {
        vtkNew<vtkRTAnalyticSource> fresh;
        fresh->SetWholeExtent(-12, 19, 3, 30, -5, 22);
        vtkNew<vtkCutVolume> cut;
        cut->SetInputConnection(fresh->GetOutputPort());
        cut->SetSheetData(sheet);
        cut->SetOutsideMode(outside);
        cut->SetFadeDistance(4.0);
        if (deformation != AtRest)
        {
          cut->SetDeformationData(
            deformation == ByField ? static_cast<vtkDataObject*>(field.Get()) : mesh.Get());
        }
        cut->UpdateExtent(part.data());
        EXPECT_GT(cut->GetNumberOfSwitchedOffTetrahedra(), 0);
        if (!whole)
        {
          whole = cut->GetOutput();
          EXPECT_GT(cut->GetNumberOfSwitchedOffTetrahedra(), 2000);
          continue;
        }
        vtkDataArray* expected = whole->GetCellData()->GetArray("ActiveTetrahedra");
        vtkImageData* output = cut->GetOutput();
        EXPECT_EQ(GetExtent(output), part);
        vtkDataArray* found = output->GetCellData()->GetArray("ActiveTetrahedra");
        int wrong = 0;
        vtkIdType cell = 0;
        for (int z = part[4]; z < part[5]; ++z)
        {
          for (int y = part[2]; y < part[3]; ++y)
          {
            for (int x = part[0]; x < part[1]; ++x, ++cell)
            {
              int index[3] = { x, y, z };
              const double value = expected->GetComponent(whole->ComputeCellId(index), 0);
              wrong += found->GetComponent(cell, 0) != value ? 1 : 0;
            }
          }
        }
        EXPECT_EQ(wrong, 0);
      }
    }
  }
}

// The part of a rank may have no cells or no points.
TEST(CutDeformedVolume, PartsWithoutCells)
{
  for (const Extent& part : { Extent{ { 3, 3, 0, 9, 0, 9 } }, deformvolume::EmptyExtent })
  {
    vtkNew<vtkRTAnalyticSource> source;
    source->SetWholeExtent(0, 9, 0, 9, 0, 9);
    Edited<vtkCutVolume> cut;
    cut.Filter->SetInputConnection(source->GetOutputPort());
    source->UpdateInformation();
    cut.Filter->SetSheetData(MakePlaneX(MakeVolume(CutBox), 3.5));
    cut.Filter->UpdateExtent(part.data());
    EXPECT_EQ(cut.Observer->GetErrorMessage(), "");
    EXPECT_EQ(cut.ExecutiveObserver->GetErrorMessage(), "");
    EXPECT_EQ(cut.Filter->GetOutput()->GetNumberOfCells(), part[1] < 0 ? 0 : 81);
    cut.Filter->UpdateWholeExtent();
    EXPECT_EQ(cut.Filter->GetNumberOfSwitchedOffTetrahedra(), 5 * 81);
  }
}

// Two sides of a cut that move apart leave an empty gap.
TEST(CutDeformedVolume, Gap)
{
  const Extent extent{ { 0, 16, 0, 8, 0, 8 } };
  auto volume = MakeVolume(extent);
  Edited<vtkCutVolume> cut;
  cut.Filter->SetInputData(volume);
  cut.Filter->SetSheetData(MakePlaneX(volume, 7.5));
  auto field = MakeImage(extent);
  SetDisplacements(
    field, [](const glm::dvec3& p) { return p + glm::dvec3(p.x > 7.5 ? 6.0 : 0.0, 0.0, 0.0); });
  Deformed deformed;
  deformed.Filter->SetInputConnection(cut.Filter->GetOutputPort());
  deformed.Filter->SetDeformationData(field);
  vtkImageData* output = deformed.Update();
  int wrong = 0;
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 p = GetPoint(output, id);
    const bool isThere = p.x <= 7.0 || p.x >= 14.0;
    wrong += deformed.IsCovered(id) != isThere ? 1 : 0;
    if (isThere)
    {
      int index[3] = { static_cast<int>(p.x) - (p.x >= 14.0 ? 6 : 0), static_cast<int>(p.y),
        static_cast<int>(p.z) };
      const vtkIdType voxel = volume->ComputePointId(index);
      wrong += deformed.GetValues()->GetComponent(id, 0) !=
          volume->GetPointData()->GetScalars()->GetComponent(voxel, 0)
        ? 1
        : 0;
    }
  }
  EXPECT_EQ(GetExtent(output), (Extent{ { 0, 22, 0, 8, 0, 8 } }));
  EXPECT_EQ(wrong, 0);
  // Without the cut the voxels of the gap are covered.
  cut.Filter->Undo();
  deformed.Update();
  EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), output->GetNumberOfPoints());
  cut.Filter->Redo();
  deformed.Update();
  EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), output->GetNumberOfPoints() - 6 * 9 * 9);
}

} // namespace
