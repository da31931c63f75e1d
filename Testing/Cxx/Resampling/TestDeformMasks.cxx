// SPDX-License-Identifier: BSD-3-Clause
// Parts of the volume that are not deformed: inactive tetrahedra, hidden cells, ghost points and
// blanked points.
#include "FilterTesting.h"

#include "vtkDeformGeometryFilter.h"

#include <vtkArrayChanges.h>
#include <vtkCellData.h>
#include <vtkCharArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkIntArray.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkRectilinearGrid.h>
#include <vtkUniformGrid.h>
#include <vtkUnsignedCharArray.h>

#include <glm/common.hpp>

using namespace filterTesting;

namespace
{

const Extent Box{ { -1, 8, 0, 8, 3, 10 } };

vtkSmartPointer<vtkUnsignedCharArray> MakeBytes(const char* name, vtkIdType size, int value)
{
  auto bytes = vtkSmartPointer<vtkUnsignedCharArray>::New();
  bytes->SetName(name);
  bytes->SetNumberOfTuples(size);
  bytes->Fill(value);
  return bytes;
}

vtkSmartPointer<vtkUnstructuredGrid> MakeStillMesh(vtkImageData* volume)
{
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  return mesh;
}

vtkIdType CountCovered(Deformed& deformed)
{
  deformed.Update();
  vtkIdType count = 0;
  for (vtkIdType id = 0; id < deformed.Filter->GetOutput()->GetNumberOfPoints(); ++id)
  {
    count += deformed.IsCovered(id) ? 1 : 0;
  }
  EXPECT_EQ(count, deformed.Filter->GetNumberOfCoveredVoxels());
  return count;
}

// The output is four times as fine, so that the tetrahedra of a cell can be distinguished.
TEST(DeformMasks, ActiveTetrahedra)
{
  auto volume = MakeVolume(Box);
  auto active = MakeBytes("ActiveTetrahedra", volume->GetNumberOfCells(), 31);
  volume->GetCellData()->AddArray(active);
  auto mesh = MakeStillMesh(volume);
  Deformed deformed(volume, mesh);
  deformed.Filter->SetOutputSpacingModeToCustomSpacing();
  deformed.Filter->SetCustomSpacing(0.25, 0.25, 0.25);
  const vtkIdType all = CountCovered(deformed);
  EXPECT_EQ(all, 37 * 33 * 29);
  EXPECT_EQ(deformed.TakeWarning(), "");

  // Other bits than the lowest five are ignored.
  active->Fill(255);
  active->Modified();
  EXPECT_EQ(CountCovered(deformed), all);

  // SetArray() replaces the values without changing the modification time, with and without a log.
  std::vector<unsigned char> inactive(static_cast<std::size_t>(volume->GetNumberOfCells()), 0);
  std::vector<unsigned char> allActive(inactive.size(), 31);
  active->SetArray(inactive.data(), volume->GetNumberOfCells(), 1);
  deformed.Filter->Modified();
  EXPECT_EQ(CountCovered(deformed), 0);
  vtkNew<vtkArrayChanges> changes;
  changes->SetArray(active);
  active->SetArray(allActive.data(), volume->GetNumberOfCells(), 1);
  deformed.Filter->Modified();
  EXPECT_EQ(CountCovered(deformed), all);
  changes->SetArray(nullptr);

  // Samples inside one cell of even parity, at (2, 4, 6), for each mask of its tetrahedra. Its
  // corner tetrahedra 0 to 3 are at the corners (0,0,1), (1,1,1), (1,0,0), (0,1,0).
  const int cellIndex[3] = { 2, 4, 6 };
  const vtkIdType cell =
    ((cellIndex[2] - Box[4]) * 8 + cellIndex[1] - Box[2]) * 9 + cellIndex[0] - Box[0];
  const glm::dvec3 corners[4] = { glm::dvec3(0, 0, 1), glm::dvec3(1, 1, 1), glm::dvec3(1, 0, 0),
    glm::dvec3(0, 1, 0) };
  for (int mask = 0; mask < 32; ++mask)
  {
    active->Fill(31);
    active->SetValue(cell, static_cast<unsigned char>(mask));
    active->Modified();
    vtkImageData* output = deformed.Update();
    int wrong = 0;
    for (int k = 1; k < 4; ++k)
    {
      for (int j = 1; j < 4; ++j)
      {
        for (int i = 1; i < 4; ++i)
        {
          // A corner tetrahedron contains the points whose distance from its corner, as a sum over
          // the axes, is at most 1. Points at a distance of at least 1 from all four corners are in
          // the central tetrahedron.
          const glm::dvec3 p = glm::dvec3(i, j, k) / 4.0;
          bool expected = false;
          bool central = true;
          for (int t = 0; t < 4; ++t)
          {
            const glm::dvec3 d = glm::abs(p - corners[t]);
            const double distance = d.x + d.y + d.z;
            expected |= (mask >> t & 1) != 0 && distance <= 1.0;
            central &= distance >= 1.0;
          }
          expected |= (mask >> 4 & 1) != 0 && central;
          int index[3] = { 4 * cellIndex[0] + i, 4 * cellIndex[1] + j, 4 * cellIndex[2] + k };
          wrong += deformed.IsCovered(output->ComputePointId(index)) != expected ? 1 : 0;
        }
      }
    }
    EXPECT_EQ(wrong, 0);
  }
  active->Fill(0);
  active->Modified();
  EXPECT_EQ(CountCovered(deformed), 0);
  volume->GetCellData()->RemoveArray("ActiveTetrahedra");
  EXPECT_EQ(CountCovered(deformed), all);

  // An array of bytes that is not a vtkUnsignedCharArray: VTK makes such arrays since version 9.6.
  const auto plain = vtkSmartPointer<vtkAOSDataArrayTemplate<unsigned char>>::New();
  plain->SetName("ActiveTetrahedra");
  plain->SetNumberOfTuples(volume->GetNumberOfCells());
  plain->FillValue(0);
  volume->GetCellData()->AddArray(plain);
  EXPECT_EQ(CountCovered(deformed), 0);
}

TEST(DeformMasks, HiddenCells)
{
  auto volume = MakeVolume(Box);
  auto mesh = MakeStillMesh(volume);
  Deformed deformed(volume, mesh);
  deformed.Filter->SetOutputSpacingModeToCustomSpacing();
  deformed.Filter->SetCustomSpacing(0.5, 0.5, 0.5);
  const vtkIdType all = CountCovered(deformed);
  auto ghosts = MakeBytes(vtkDataSetAttributes::GhostArrayName(), volume->GetNumberOfCells(), 0);
  ghosts->SetValue((3 * 8 + 4) * 9 + 5, vtkDataSetAttributes::HIDDENCELL);
  volume->GetCellData()->AddArray(ghosts);
  // Only the sample in the middle of the cell is not covered: others belong to neighboring cells,
  // too.
  EXPECT_EQ(CountCovered(deformed), all - 1);
}

TEST(DeformMasks, HiddenAndDuplicatePoints)
{
  for (const unsigned char kind :
    { vtkDataSetAttributes::HIDDENPOINT, vtkDataSetAttributes::DUPLICATEPOINT })
  {
    auto volume = MakeVolume(Box);
    auto mesh = MakeStillMesh(volume);
    Deformed deformed(volume, mesh);
    const vtkIdType all = CountCovered(deformed);
    auto ghosts = MakeBytes(vtkDataSetAttributes::GhostArrayName(), volume->GetNumberOfPoints(), 0);
    int inside[3] = { 3, 4, 7 };
    int corner[3] = { -1, 0, 3 };
    ghosts->SetValue(volume->ComputePointId(inside), kind);
    ghosts->SetValue(volume->ComputePointId(corner), kind);
    volume->GetPointData()->AddArray(ghosts);
    EXPECT_EQ(CountCovered(deformed), all - 2);
    vtkImageData* output = deformed.Filter->GetOutput();
    EXPECT_FALSE(deformed.IsCovered(output->ComputePointId(inside)));
    EXPECT_EQ(deformed.GetValues()->GetComponent(output->ComputePointId(inside), 0), 0.0);
    // The output does not get the ghost array of the volume.
    EXPECT_FALSE(output->GetPointData()->GetArray(vtkDataSetAttributes::GhostArrayName()));
    ghosts->Fill(0);
    ghosts->Modified();
    EXPECT_EQ(CountCovered(deformed), all);
  }
}

TEST(DeformMasks, BlankingByUniformGrid)
{
  vtkNew<vtkUniformGrid> volume;
  volume->DeepCopy(MakeVolume(Box));
  auto mesh = MakeStillMesh(volume);
  Deformed deformed(volume, mesh);
  const vtkIdType all = CountCovered(deformed);
  int inside[3] = { 3, 4, 7 };
  volume->BlankPoint(volume->ComputePointId(inside));
  volume->Modified();
  EXPECT_EQ(CountCovered(deformed), all - 1);
  EXPECT_FALSE(deformed.IsCovered(volume->ComputePointId(inside)));
}

template <typename Array>
vtkSmartPointer<Array> MakeValidMask(vtkIdType size)
{
  auto mask = vtkSmartPointer<Array>::New();
  mask->SetName("vtkValidPointMask");
  mask->SetNumberOfValues(size);
  mask->Fill(1);
  return mask;
}

// Points whose vtkValidPointMask is 0 are hidden, with and without other hidden points.
template <typename Array>
void CheckValidPoints()
{
  const auto volume = MakeVolume(Box);
  const auto mesh = MakeStillMesh(volume);
  const auto valid = MakeValidMask<Array>(volume->GetNumberOfPoints());
  volume->GetPointData()->AddArray(valid);
  Deformed deformed(volume, mesh);
  const vtkIdType all = CountCovered(deformed);
  EXPECT_EQ(all, volume->GetNumberOfPoints());
  int inside[3] = { 3, 4, 7 };
  int other[3] = { 5, 2, 5 };
  valid->SetValue(volume->ComputePointId(inside), 0);
  valid->Modified();
  EXPECT_EQ(CountCovered(deformed), all - 1);
  EXPECT_FALSE(deformed.IsCovered(volume->ComputePointId(inside)));
  auto ghosts = MakeBytes(vtkDataSetAttributes::GhostArrayName(), volume->GetNumberOfPoints(), 0);
  ghosts->SetValue(volume->ComputePointId(other), vtkDataSetAttributes::HIDDENPOINT);
  volume->GetPointData()->AddArray(ghosts);
  EXPECT_EQ(CountCovered(deformed), all - 2);
  valid->Fill(1);
  valid->Modified();
  EXPECT_EQ(CountCovered(deformed), all - 1);
  EXPECT_TRUE(deformed.IsCovered(volume->ComputePointId(inside)));
  // A log of the ghosts does not keep points hidden that have become valid.
  vtkNew<vtkArrayChanges> changes;
  changes->SetArray(ghosts);
  CountCovered(deformed);
  valid->SetValue(volume->ComputePointId(inside), 0);
  valid->Modified();
  EXPECT_EQ(CountCovered(deformed), all - 2);
  valid->Fill(1);
  valid->Modified();
  ghosts->SetValue(volume->ComputePointId(other), 0);
  changes->AddTuples(volume->ComputePointId(other), volume->ComputePointId(other));
  EXPECT_EQ(CountCovered(deformed), all);
  // With a sampling factor only every other point counts.
  deformed.Filter->SetSamplingFactor(2);
  const vtkIdType coarse = CountCovered(deformed);
  valid->SetValue(volume->ComputePointId(inside), 0); // not sampled
  valid->Modified();
  EXPECT_EQ(CountCovered(deformed), coarse);
  int sampled[3] = { 2, 4, 6 };
  valid->SetValue(volume->ComputePointId(sampled), 0);
  valid->Modified();
  EXPECT_LT(CountCovered(deformed), coarse);
}

// The second filter does not take the background of the first one for values of the volume.
TEST(DeformMasks, Chain)
{
  const auto volume = MakeImage({ { 0, 19, 0, 19, 0, 19 } });
  AddScalars<short>(volume, "value", [](const glm::dvec3&) { return 1000.0; });
  const auto mesh = MakeMesh(volume, 3, -4.25);
  SetDisplacements(mesh, Shift(1.5, 0.0, 0.0));
  Deformed first(volume, mesh);
  first.Filter->SetBackgroundValue(-1000.0);
  first.Filter->SetOutputBoundsModeToVolumeBounds();
  Deformed second;
  second.Filter->SetInputConnection(first.Filter->GetOutputPort());
  second.Filter->SetDeformationData(mesh);
  second.Filter->SetBackgroundValue(-1000.0);
  second.Update();
  EXPECT_GT(second.Filter->GetNumberOfCoveredVoxels(), 300);
  EXPECT_LT(second.Filter->GetNumberOfCoveredVoxels(), first.Filter->GetNumberOfCoveredVoxels());
  int wrong = 0;
  for (vtkIdType id = 0; id < second.Filter->GetOutput()->GetNumberOfPoints(); ++id)
  {
    wrong += second.GetValues()->GetComponent(id, 0) != (second.IsCovered(id) ? 1000.0 : -1000.0);
  }
  EXPECT_EQ(wrong, 0);
}

// Vectors of a field where the mask is 0 are undefined, as those of hidden points are. fine: the
// field has twice the resolution of the volume, so that only some of its points are read.
void CheckValidVectors(bool inverse, bool fine)
{
  const auto volume = MakeVolume(Box);
  const Extent extent = fine ? Extent{ { -2, 16, 0, 16, 6, 20 } } : Box;
  const auto field = MakeImage(extent, glm::dvec3(fine ? 0.5 : 1.0));
  SetDisplacements(field, Shift(0.5, 0.0, 0.0));
  const auto valid = MakeValidMask<vtkCharArray>(field->GetNumberOfPoints());
  field->GetPointData()->AddArray(valid);
  Deformed deformed(volume, field);
  deformed.Filter->SetFieldIsInverse(inverse);
  const vtkIdType all = CountCovered(deformed);
  const vtkIdType point = field->FindPoint(3.0, 4.0, 7.0);
  valid->SetValue(point, 0);
  valid->Modified();
  const vtkIdType less = CountCovered(deformed);
  EXPECT_LT(less, all);
  vtkNew<vtkDeformGeometryFilter> points;
  vtkNew<vtkPolyData> surface;
  vtkNew<vtkPoints> positions;
  positions->InsertNextPoint(3.0, 4.0, 7.0);
  surface->SetPoints(positions);
  points->SetInputData(surface);
  points->SetDeformationData(field);
  points->SetFieldIsInverse(inverse);
  points->Update();
  const vtkIdType outside = points->GetNumberOfOutsidePoints();
  EXPECT_TRUE(outside == 1 || inverse);
  valid->SetValue(point, 1);
  valid->Modified();
  EXPECT_EQ(CountCovered(deformed), all);
  points->Update();
  EXPECT_EQ(points->GetNumberOfOutsidePoints(), 0);
  auto ghosts = MakeBytes(vtkDataSetAttributes::GhostArrayName(), field->GetNumberOfPoints(), 0);
  ghosts->SetValue(point, vtkDataSetAttributes::HIDDENPOINT);
  field->GetPointData()->AddArray(ghosts);
  EXPECT_EQ(CountCovered(deformed), less);
}

// Cells of a rectilinear mesh that have a point whose mask is 0 are left out.
TEST(DeformMasks, ValidNodes)
{
  const auto volume = MakeVolume(Box);
  vtkNew<vtkRectilinearGrid> mesh;
  vtkNew<vtkDoubleArray> coordinates[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int i = 0; i < 5; ++i)
    {
      coordinates[axis]->InsertNextValue(
        Box[2 * axis] - 0.5 + i * (Box[2 * axis + 1] - Box[2 * axis] + 1.0) / 4.0);
    }
  }
  mesh->SetDimensions(5, 5, 5);
  mesh->SetXCoordinates(coordinates[0]);
  mesh->SetYCoordinates(coordinates[1]);
  mesh->SetZCoordinates(coordinates[2]);
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  const vtkIdType all = CountCovered(deformed);
  const auto valid = MakeValidMask<vtkCharArray>(mesh->GetNumberOfPoints());
  valid->SetValue(62, 0); // the middle
  mesh->GetPointData()->AddArray(valid);
  const vtkIdType less = CountCovered(deformed);
  EXPECT_LT(less, all);
  auto ghosts = MakeBytes(vtkDataSetAttributes::GhostArrayName(), mesh->GetNumberOfPoints(), 0);
  ghosts->SetValue(62, vtkDataSetAttributes::HIDDENPOINT);
  mesh->GetPointData()->RemoveArray("vtkValidPointMask");
  mesh->GetPointData()->AddArray(ghosts);
  EXPECT_EQ(CountCovered(deformed), less);
}

TEST(DeformMasks, ValidMisuse)
{
  const auto volume = MakeVolume(Box);
  const auto mesh = MakeStillMesh(volume);
  volume->GetPointData()->AddArray(MakeValidMask<vtkCharArray>(3));
  Deformed deformed(volume, mesh);
  deformed.VerifyFailure("\"vtkValidPointMask\" of the volume has 3 tuples");
}

} // namespace

TEST(DeformMasks, ValidPoints)
{
  CheckValidPoints<vtkCharArray>();
  CheckValidPoints<vtkIntArray>();
}

TEST(DeformMasks, ValidVectors)
{
  for (const bool inverse : { false, true })
  {
    CheckValidVectors(inverse, false);
    CheckValidVectors(inverse, true);
  }
}
