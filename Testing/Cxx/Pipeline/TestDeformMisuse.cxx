// SPDX-License-Identifier: BSD-3-Clause
// Invalid inputs: one error that says what is wrong, an empty output, and a filter that works with
// valid inputs again.
#include "ArrayMaking.h"
#include "FilterTesting.h"
#include "PolyhedronCells.h"

#include <vtkBitArray.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkFloatArray.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>

#include <limits>
#include <numeric>

using namespace filterTesting;

namespace
{

/// A filter that gets an invalid input, must report one error, and must work again with valid
/// inputs.
class DeformMisuse : public testing::Test
{
protected:
  DeformMisuse()
    : Volume(MakeVolume())
    , Mesh(MakeMesh(Volume))
    , Subject(Volume, Mesh)
  {
    SetDisplacements(this->Mesh, Shift(1.0, 0.0, 0.0));
    this->Subject.Update();
    this->Expected->DeepCopy(this->Subject.Filter->GetOutput());
  }

  void Expect(const char* what, const std::string& word)
  {
    SCOPED_TRACE(what);
    this->Subject.Filter->Modified();
    this->Subject.VerifyFailure(word);
    EXPECT_EQ(this->Subject.Filter->GetOutput()->GetPointData()->GetNumberOfArrays(), 0);
    this->Restore();
    EXPECT_TRUE(AreEqual(this->Subject.Update(), this->Expected));
  }

  vtkDeformVolumeFilter* GetFilter() { return this->Subject.Filter; }
  vtkSmartPointer<vtkUnstructuredGrid> CopyMesh()
  {
    auto copy = vtkSmartPointer<vtkUnstructuredGrid>::New();
    copy->DeepCopy(this->Mesh);
    return copy;
  }

  void Restore()
  {
    vtkDeformVolumeFilter* filter = this->GetFilter();
    filter->SetInputData(this->Volume);
    filter->SetDeformationData(this->Mesh);
    filter->SetInputConnection(2, nullptr);
    filter->SetInputArrayToProcess(
      0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::VECTORS);
    filter->SetDevice("");
    filter->SetMemoryLimit(0);
    filter->SetDisplacementScale(1.0);
    filter->SetOutputSpacingModeToVolumeSpacing();
    filter->SetOutputBoundsModeToDeformedBounds();
  }

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Deformed Subject;
  vtkNew<vtkImageData> Expected;
};

TEST_F(DeformMisuse, Volumes)
{
  for (const Extent& extent : { Extent{ { 0, 9, 0, 8, 3, 3 } }, Extent{ { 0, 0, 0, 8, 0, 3 } },
         Extent{ { 1, 1, 2, 2, 3, 3 } } })
  {
    auto flat = MakeImage(extent);
    AddScalars<short>(flat, "value", [](const glm::dvec3&) { return 1.0; });
    this->GetFilter()->SetInputData(flat);
    this->Expect("a flat volume", "two voxels");
  }

  vtkNew<vtkImageData> empty;
  this->GetFilter()->SetInputData(empty);
  this->Expect("an empty volume", "volume");

  auto bare = MakeImage({ { 0, 4, 0, 4, 0, 4 } });
  this->GetFilter()->SetInputData(bare);
  this->Expect("a volume without arrays", "no numeric point array");
  bare->GetCellData()->AddArray(MakeArray<vtkFloatArray>("CT", bare->GetNumberOfCells()));
  this->GetFilter()->SetInputData(bare);
  this->Expect("a volume with cell arrays", "It has cell arrays: \"CT\". vtkCellDataToPointData");
  const auto bits = MakeArray<vtkBitArray>("bits", bare->GetNumberOfPoints());
  bare->GetPointData()->SetScalars(bits);
  this->GetFilter()->SetInputData(bare);
  this->Expect("a volume of bits", "\"bits\" (bit; copy it into a vtkUnsignedCharArray");

  auto strange = MakeVolume();
  strange->SetSpacing(1.0, 0.0, 1.0);
  this->GetFilter()->SetInputData(strange);
  this->Expect("a volume without spacing", "pacing");

  auto unnumbered = MakeVolume();
  strange->SetSpacing(1.0, 1.0, 1.0);
  unnumbered->SetOrigin(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0);
  this->GetFilter()->SetInputData(unnumbered);
  this->Expect("a volume with an origin that is no number", "rigin");

  auto active = MakeVolume();
  const auto mask = MakeArray<vtkFloatArray>("ActiveTetrahedra", active->GetNumberOfCells());
  active->GetCellData()->AddArray(mask);
  this->GetFilter()->SetInputData(active);
  this->Expect("active tetrahedra of another type", "ActiveTetrahedra");
}

TEST_F(DeformMisuse, Meshes)
{
  vtkNew<vtkUnstructuredGrid> empty;
  this->GetFilter()->SetDeformationData(empty);
  this->Expect("an empty mesh", "no points");

  auto pointsOnly = this->CopyMesh();
  pointsOnly->SetCells(VTK_TETRA, vtkNew<vtkCellArray>());
  this->GetFilter()->SetDeformationData(pointsOnly);
  this->Expect("a mesh without cells", "no tetrahedra");

  auto triangles = this->CopyMesh();
  vtkNew<vtkCellArray> cells;
  const vtkIdType triangle[3] = { 0, 1, 5 };
  cells->InsertNextCell(3, triangle);
  triangles->SetCells(VTK_TRIANGLE, cells);
  this->GetFilter()->SetDeformationData(triangles);
  this->Expect("a mesh of triangles", "no tetrahedra");

  auto away = this->CopyMesh();
  MovePoints(away, Shift(1000.0, 0.0, 0.0));
  this->GetFilter()->SetDeformationData(away);
  this->Expect("a mesh outside the volume", "volume");

  auto flat = this->CopyMesh();
  MovePoints(flat, [](const glm::dvec3& p) { return glm::dvec3(p.x, p.y, 3.0); });
  this->GetFilter()->SetDeformationData(flat);
  this->Expect("a mesh of flat tetrahedra only", "flat");

  for (const double bad :
    { std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity() })
  {
    auto nowhere = this->CopyMesh();
    nowhere->GetPoints()->SetPoint(3, 0.0, bad, 0.0);
    this->GetFilter()->SetDeformationData(nowhere);
    this->Expect("a point that is no number", "Point 3");

    auto moved = this->CopyMesh();
    moved->GetPointData()->GetVectors()->SetComponent(4, 2, bad);
    this->GetFilter()->SetDeformationData(moved);
    this->Expect("a displacement that is no number", "isplacement");
  }

  auto dangling = this->CopyMesh();
  vtkNew<vtkCellArray> tetrahedra;
  const vtkIdType tetrahedron[4] = { 0, 1, 5, 1000 };
  tetrahedra->InsertNextCell(4, tetrahedron);
  dangling->SetCells(VTK_TETRA, tetrahedra);
  this->GetFilter()->SetDeformationData(dangling);
  this->Expect("a cell with a point that does not exist", "1000");

  vtkNew<vtkMultiBlockDataSet> blocks;
  this->GetFilter()->SetDeformationData(blocks);
  this->Expect("a composite dataset of nothing", "vtkUnstructuredGrid");
}

TEST_F(DeformMisuse, Cells)
{
  // The invalid cell is between two valid ones, so that the error must have the right id.
  const vtkIdType good[4] = { 0, 1, 3, 9 };
  std::vector<vtkIdType> points(13);
  std::iota(points.begin(), points.end(), 0);
  const auto insert = [&](vtkIdType count, int type)
  {
    auto mesh = this->CopyMesh();
    mesh->Reset();
    mesh->Allocate(3);
    mesh->InsertNextCell(VTK_TETRA, 4, good);
    mesh->InsertNextCell(type, count, points.data());
    mesh->InsertNextCell(VTK_TETRA, 4, good);
    this->GetFilter()->SetDeformationData(mesh);
  };
  // HigherOrderCells.Tables compares the numbers of all types with VTK's.
  for (const vtkIdType count : { 0, 3, 7, 9 })
  {
    insert(count, VTK_HEXAHEDRON);
    this->Expect("a cell with a wrong number of points",
      "Cell 1 of the deformation mesh is a hexahedron with " + std::to_string(count) +
        " points instead of 8");
  }

  points[4] = -1;
  insert(8, VTK_HEXAHEDRON);
  this->Expect("a cell with a negative point", "Cell 1 of the deformation mesh uses point -1");

  auto untyped = this->CopyMesh();
  vtkNew<vtkUnsignedCharArray> types;
  types->InsertNextValue(VTK_TETRA);
  untyped->SetCells(types, untyped->GetCells());
  this->GetFilter()->SetDeformationData(untyped);
  this->Expect("fewer types than cells", "1 cell types");

  // Faces that are missing, too few, too small, truncated, or refer to a point that does not exist.
  const struct
  {
    PolyhedronDescription Polyhedron;
    const char* Complaint;
  } cases[] = { { { -1, 4, { { 0, 1, 3 } } }, " with 4 points and incomplete faces" },
    { { 5, 4, { { 0, 1, 3 } } }, "incomplete faces" },
    { { 0, 0, { { 0, 1, 3 } } }, "incomplete faces" },
    { { 0, 4, { { 0, 1 } } }, "incomplete faces" },
    { { 0, 4, { { 0, 1, 3 }, { 0, 1 }, { 0, 1, 3 }, { 1, 3, 0 } } }, "incomplete faces" },
    { { 0, 4, { { 0, 1, 3 } } }, "incomplete faces" },
    { { 0, 4, { { 0, 1, 5000 } } }, " uses point 5000" } };
  for (const auto& entry : cases)
  {
    auto mesh = this->CopyMesh();
    SetPolyhedron(mesh, { good, good + 4 }, entry.Polyhedron);
    this->GetFilter()->SetDeformationData(mesh);
    this->Expect("a polyhedron with bad faces", entry.Complaint);
  }
}

TEST_F(DeformMisuse, Displacements)
{
  auto without = this->CopyMesh();
  without->GetPointData()->Initialize();
  this->GetFilter()->SetDeformationData(without);
  this->Expect("no displacements", "SetInputArrayToProcess");

  this->GetFilter()->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "absent");
  this->Expect("an array that does not exist", "absent");

  auto pairs = this->CopyMesh();
  const auto two = MakeArray<vtkFloatArray>("two", pairs->GetNumberOfPoints(), 2);
  pairs->GetPointData()->AddArray(two);
  this->GetFilter()->SetDeformationData(pairs);
  this->GetFilter()->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "two");
  this->Expect("displacements of two components", "three components");

  auto few = this->CopyMesh();
  const auto less = MakeArray<vtkFloatArray>("less", few->GetNumberOfPoints() - 1, 3);
  few->GetPointData()->AddArray(less);
  this->GetFilter()->SetDeformationData(few);
  this->GetFilter()->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "less");
  this->Expect("too few displacements", "tuples");

  this->GetFilter()->SetDisplacementScale(1e12);
  this->Expect("displacements beyond all bounds", "scale of the displacements");

  auto field = MakeImage({ { 0, 4, 0, 4, 0, 4 } });
  AddScalars<float>(field, "scalar", [](const glm::dvec3&) { return 1.0; });
  this->GetFilter()->SetDeformationData(field);
  this->Expect("a displacement field without vectors", "displacement field");

  vtkNew<vtkImageData> nothing;
  this->GetFilter()->SetDeformationData(nothing);
  this->Expect("an empty displacement field", "displacement field");

  auto besides = MakeImage({ { 0, 4, 0, 4, 0, 4 } }, glm::dvec3(1.0), glm::dvec3(500.0, 0.0, 0.0));
  SetDisplacements(besides, Shift(0.0, 0.0, 0.0));
  this->GetFilter()->SetDeformationData(besides);
  this->Expect("a displacement field outside the volume", "no voxel of the volume");
}

TEST_F(DeformMisuse, RestMeshes)
{
  vtkNew<vtkUnstructuredGrid> empty;
  this->GetFilter()->SetRestData(empty);
  this->Expect("an empty mesh at rest", "no points");

  auto other = MakeMesh(this->Volume, 4);
  this->GetFilter()->SetRestData(other);
  this->Expect("a mesh at rest with other points", "points");

  auto fewer = this->CopyMesh();
  vtkNew<vtkCellArray> cells;
  for (vtkIdType cell = 1; cell < fewer->GetNumberOfCells(); ++cell)
  {
    cells->InsertNextCell(fewer->GetCell(cell));
  }
  fewer->SetCells(VTK_TETRA, cells);
  this->GetFilter()->SetRestData(fewer);
  this->Expect("a mesh at rest with other cells", "cells");

  auto field = MakeImage({ { -1, 10, -1, 10, -1, 10 } });
  SetDisplacements(field, Shift(0.0, 0.0, 0.0));
  this->GetFilter()->SetDeformationData(field);
  this->GetFilter()->SetRestData(this->CopyMesh());
  this->Expect("a mesh at rest with a displacement field", "Disconnect the mesh at rest");
}

TEST_F(DeformMisuse, Settings)
{
  this->GetFilter()->SetDevice("a device that nobody has");
  this->Expect("an unknown device", "a device that nobody has");

  this->GetFilter()->SetMemoryLimit(1000);
  this->Expect("not enough memory",
    "and 1000 are available. Use a smaller volume, fewer arrays or smaller output bounds, raise "
    "the memory limit");

  this->GetFilter()->SetOutputSpacingModeToCustomSpacing();
  this->GetFilter()->SetCustomSpacing(1.0, 0.0, 1.0);
  this->Expect("no output spacing", "CustomSpacing");

  this->GetFilter()->SetOutputBoundsModeToCustomBounds();
  this->GetFilter()->SetCustomBounds(5.0, 1.0, 0.0, 1.0, 0.0, 1.0);
  this->Expect("bounds the wrong way round", "bounds of the output are no box");
}

// A correction after a failure may also change the extent of the output.
TEST_F(DeformMisuse, ExtentAfterFailure)
{
  Deformed deformed(this->Volume, this->Mesh);
  vtkDeformVolumeFilter* filter = deformed.Filter;
  for (const bool device : { false, true })
  {
    filter->SetOutputBoundsModeToDeformedBounds();
    filter->SetDevice(device ? "a device that nobody has" : "");
    filter->SetMemoryLimit(device ? 0 : 1000);
    filter->Update();
    EXPECT_EQ(deformed.TakeErrors(), 1);
    filter->SetDevice("");
    filter->SetMemoryLimit(0);
    filter->SetOutputBoundsModeToCustomBounds();
    filter->SetCustomBounds(0.0, 2.0, 0.0, 2.0, 0.0, 2.0);
    const Extent small{ { 0, 2, 0, 2, 0, 2 } };
    EXPECT_EQ(GetExtent(deformed.Update()), small);
  }
}

// The origin of the world is a voxel of many scans. So a mesh or a field in meters holds a voxel of
// a volume in millimeters, and only a warning can tell.
TEST_F(DeformMisuse, Units)
{
  const auto volume =
    MakeImage({ { 0, 40, 0, 40, 0, 40 } }, glm::dvec3(1.0), glm::dvec3(-20.0, -20.0, -20.0));
  AddScalars<float>(volume, "values", [](const glm::dvec3& p) { return p.x; });
  const auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(1.0, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  deformed.Filter->SetOutsideModeToKeep();
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeWarning(), "");
  MovePoints(mesh, [](const glm::dvec3& p) { return 0.001 * p; });
  SetDisplacements(mesh, Shift(0.001, 0.0, 0.0));
  deformed.Filter->Update();
  EXPECT_TRUE(HasPart(deformed.TakeWarning(), "meters"));
  deformed.Filter->Modified();
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeWarning(), ""); // the warning is not repeated
  const auto field =
    MakeImage({ { 0, 4, 0, 4, 0, 4 } }, glm::dvec3(0.01), glm::dvec3(-0.02, -0.02, -0.02));
  SetDisplacements(field, Shift(0.001, 0.0, 0.0));
  deformed.Filter->SetDeformationData(field);
  deformed.Filter->Update();
  EXPECT_TRUE(HasPart(deformed.TakeWarning(), "meters"));
  deformed.Filter->SetOutsideModeToExtrapolate();
  deformed.Filter->SetDeformationData(mesh);
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeWarning(), "");
  // The size of a field does not matter if it translates all voxels.
  for (const double spacing : { 0.01, 20000.0 })
  {
    for (const double slope : { 0.0, 1e-3 })
    {
      field->SetSpacing(spacing, spacing, spacing);
      field->SetOrigin(-2.0 * spacing, -2.0 * spacing, -2.0 * spacing);
      SetDisplacements(
        field, [&](const glm::dvec3& p) { return p + glm::dvec3(1.0 + slope * p.x, 0.0, 0.0); });
      deformed.Filter->SetDeformationData(field);
      deformed.Filter->Update();
      const std::string words = spacing < 1.0 ? "smaller than two" : "a hundred times as long";
      EXPECT_EQ(HasPart(deformed.TakeWarning(), words), slope > 0.0);
    }
  }
}

// An output that is larger than any memory: one error before anything is allocated.
TEST_F(DeformMisuse, OutputBeyondAllMemory)
{
  Deformed deformed(this->Volume, this->Mesh);
  deformed.Filter->SetOutputBoundsModeToCustomBounds();
  deformed.Filter->SetCustomBounds(0.0, 20000.0, 0.0, 20000.0, 0.0, 20000.0);
  deformed.VerifyFailure("Not enough memory");
}

} // namespace
