// SPDX-License-Identifier: BSD-3-Clause
// Invalid inputs: one error that says what is wrong, an empty output, and a filter that works with
// valid inputs again.
#include "FilterTesting.h"
#include "PolyhedronCells.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
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
class Misuse
{
public:
  Misuse()
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
    this->Subject.Filter->Modified();
    for (int repeat = 0; repeat < 2; ++repeat) // nothing changes before the second update
    {
      VERIFY(!this->Subject.Filter->GetExecutive()->Update());
      const int errors = this->Subject.TakeErrors();
      const std::string message = this->Subject.LastError;
      if (errors != 1 || message.find(word) == std::string::npos)
      {
        ++GetNumberOfFailures();
        std::cerr << what << ": " << errors << " errors, expected one with \"" << word << "\"\n";
        std::cerr << (message.empty() ? "" : message.substr(message.find("):") + 2)) << '\n';
      }
      vtkImageData* output = this->Subject.Filter->GetOutput();
      if (output->GetNumberOfPoints() != 0 || output->GetPointData()->GetNumberOfArrays() != 0)
      {
        ++GetNumberOfFailures();
        std::cerr << what << ": expected an empty output after the error instead of one with "
                  << output->GetNumberOfPoints() << " points and "
                  << output->GetPointData()->GetNumberOfArrays() << " arrays\n";
      }
    }
    this->Restore();
    vtkImageData* output = this->Subject.Update();
    if (!AreEqual(output, this->Expected))
    {
      ++GetNumberOfFailures();
      std::cerr << what << ": without the error the output differs from the one before the error\n";
    }
  }

  vtkDeformVolumeFilter* GetFilter() { return this->Subject.Filter; }
  vtkSmartPointer<vtkUnstructuredGrid> CopyMesh()
  {
    auto copy = vtkSmartPointer<vtkUnstructuredGrid>::New();
    copy->DeepCopy(this->Mesh);
    return copy;
  }
  vtkImageData* GetVolume() { return this->Volume; }

private:
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

void TestVolumes(Misuse& misuse)
{
  for (const Extent& extent : { Extent{ { 0, 9, 0, 8, 3, 3 } }, Extent{ { 0, 0, 0, 8, 0, 3 } },
         Extent{ { 1, 1, 2, 2, 3, 3 } } })
  {
    auto flat = MakeImage(extent);
    AddScalars<short>(flat, "value", [](const glm::dvec3&) { return 1.0; });
    misuse.GetFilter()->SetInputData(flat);
    misuse.Expect("a flat volume", "two voxels");
  }

  vtkNew<vtkImageData> empty;
  misuse.GetFilter()->SetInputData(empty);
  misuse.Expect("an empty volume", "volume");

  auto bare = MakeImage({ { 0, 4, 0, 4, 0, 4 } });
  misuse.GetFilter()->SetInputData(bare);
  misuse.Expect("a volume without arrays", "no numeric point array");

  auto strange = MakeVolume();
  strange->SetSpacing(1.0, 0.0, 1.0);
  misuse.GetFilter()->SetInputData(strange);
  misuse.Expect("a volume without spacing", "pacing");

  auto unnumbered = MakeVolume();
  strange->SetSpacing(1.0, 1.0, 1.0);
  unnumbered->SetOrigin(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0);
  misuse.GetFilter()->SetInputData(unnumbered);
  misuse.Expect("a volume with an origin that is no number", "rigin");

  auto active = MakeVolume();
  vtkNew<vtkFloatArray> mask;
  mask->SetName("ActiveTetrahedra");
  mask->SetNumberOfTuples(active->GetNumberOfCells());
  active->GetCellData()->AddArray(mask);
  misuse.GetFilter()->SetInputData(active);
  misuse.Expect("active tetrahedra of another type", "ActiveTetrahedra");
}

void TestMeshes(Misuse& misuse)
{
  vtkNew<vtkUnstructuredGrid> empty;
  misuse.GetFilter()->SetDeformationData(empty);
  misuse.Expect("an empty mesh", "no points");

  auto pointsOnly = misuse.CopyMesh();
  pointsOnly->SetCells(VTK_TETRA, vtkNew<vtkCellArray>());
  misuse.GetFilter()->SetDeformationData(pointsOnly);
  misuse.Expect("a mesh without cells", "no tetrahedra");

  auto triangles = misuse.CopyMesh();
  vtkNew<vtkCellArray> cells;
  const vtkIdType triangle[3] = { 0, 1, 5 };
  cells->InsertNextCell(3, triangle);
  triangles->SetCells(VTK_TRIANGLE, cells);
  misuse.GetFilter()->SetDeformationData(triangles);
  misuse.Expect("a mesh of triangles", "no tetrahedra");

  auto away = misuse.CopyMesh();
  for (vtkIdType id = 0; id < away->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 point = GetPoint(away, id) + glm::dvec3(1000.0, 0.0, 0.0);
    away->GetPoints()->SetPoint(id, &point.x);
  }
  misuse.GetFilter()->SetDeformationData(away);
  misuse.Expect("a mesh outside the volume", "volume");

  auto flat = misuse.CopyMesh();
  for (vtkIdType id = 0; id < flat->GetNumberOfPoints(); ++id)
  {
    glm::dvec3 point = GetPoint(flat, id);
    point.z = 3.0;
    flat->GetPoints()->SetPoint(id, &point.x);
  }
  misuse.GetFilter()->SetDeformationData(flat);
  misuse.Expect("a mesh of flat tetrahedra only", "flat");

  for (const double bad :
    { std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity() })
  {
    auto nowhere = misuse.CopyMesh();
    nowhere->GetPoints()->SetPoint(3, 0.0, bad, 0.0);
    misuse.GetFilter()->SetDeformationData(nowhere);
    misuse.Expect("a point that is no number", "Point 3");

    auto moved = misuse.CopyMesh();
    moved->GetPointData()->GetVectors()->SetComponent(4, 2, bad);
    misuse.GetFilter()->SetDeformationData(moved);
    misuse.Expect("a displacement that is no number", "isplacement");
  }

  auto dangling = misuse.CopyMesh();
  vtkNew<vtkCellArray> tetrahedra;
  const vtkIdType tetrahedron[4] = { 0, 1, 5, 1000 };
  tetrahedra->InsertNextCell(4, tetrahedron);
  dangling->SetCells(VTK_TETRA, tetrahedra);
  misuse.GetFilter()->SetDeformationData(dangling);
  misuse.Expect("a cell with a point that does not exist", "1000");

  vtkNew<vtkMultiBlockDataSet> blocks;
  misuse.GetFilter()->SetDeformationData(blocks);
  misuse.Expect("a composite dataset of nothing", "vtkUnstructuredGrid");
}

void TestCells(Misuse& misuse)
{
  // The invalid cell is between two valid ones, so that the error must have the right id.
  const vtkIdType good[4] = { 0, 1, 3, 9 };
  std::vector<vtkIdType> points(13);
  std::iota(points.begin(), points.end(), 0);
  const auto insert = [&](vtkIdType count, int type)
  {
    auto mesh = misuse.CopyMesh();
    mesh->Reset();
    mesh->Allocate(3);
    mesh->InsertNextCell(VTK_TETRA, 4, good);
    mesh->InsertNextCell(type, count, points.data());
    mesh->InsertNextCell(VTK_TETRA, 4, good);
    misuse.GetFilter()->SetDeformationData(mesh);
  };
  const struct
  {
    int Type;
    const char* Name;
    vtkIdType Points;
  } shapes[] = { { VTK_TETRA, "tetra", 4 }, { VTK_VOXEL, "voxel", 8 },
    { VTK_HEXAHEDRON, "hexahedron", 8 }, { VTK_WEDGE, "wedge", 6 }, { VTK_PYRAMID, "pyramid", 5 },
    { VTK_PENTAGONAL_PRISM, "pentagonal prism", 10 },
    { VTK_HEXAGONAL_PRISM, "hexagonal prism", 12 } };
  for (const auto& shape : shapes)
  {
    for (const vtkIdType count : { vtkIdType(0), vtkIdType(3), shape.Points - 1, shape.Points + 1 })
    {
      insert(count, shape.Type);
      const std::string expected = std::string("Cell 1 of the deformation mesh is a ") +
        shape.Name + " with " + std::to_string(count) + " points instead of " +
        std::to_string(shape.Points);
      misuse.Expect("a cell with a wrong number of points", expected);
    }
  }

  points[4] = -1;
  insert(8, VTK_HEXAHEDRON);
  misuse.Expect("a cell with a negative point", "Cell 1 of the deformation mesh uses point -1");

  auto untyped = misuse.CopyMesh();
  vtkNew<vtkUnsignedCharArray> types;
  types->InsertNextValue(VTK_TETRA);
  untyped->SetCells(types, untyped->GetCells());
  misuse.GetFilter()->SetDeformationData(untyped);
  misuse.Expect("fewer types than cells", "1 cell types");

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
    auto mesh = misuse.CopyMesh();
    SetPolyhedron(mesh, { good, good + 4 }, entry.Polyhedron);
    misuse.GetFilter()->SetDeformationData(mesh);
    misuse.Expect("a polyhedron with bad faces", entry.Complaint);
  }
}

void TestDisplacements(Misuse& misuse)
{
  auto without = misuse.CopyMesh();
  without->GetPointData()->Initialize();
  misuse.GetFilter()->SetDeformationData(without);
  misuse.Expect("no displacements", "SetInputArrayToProcess");

  misuse.GetFilter()->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "absent");
  misuse.Expect("an array that does not exist", "absent");

  auto pairs = misuse.CopyMesh();
  vtkNew<vtkFloatArray> two;
  two->SetName("two");
  two->SetNumberOfComponents(2);
  two->SetNumberOfTuples(pairs->GetNumberOfPoints());
  two->Fill(0.0);
  pairs->GetPointData()->AddArray(two);
  misuse.GetFilter()->SetDeformationData(pairs);
  misuse.GetFilter()->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "two");
  misuse.Expect("displacements of two components", "three components");

  auto few = misuse.CopyMesh();
  vtkNew<vtkFloatArray> less;
  less->SetName("less");
  less->SetNumberOfComponents(3);
  less->SetNumberOfTuples(few->GetNumberOfPoints() - 1);
  less->Fill(0.0);
  few->GetPointData()->AddArray(less);
  misuse.GetFilter()->SetDeformationData(few);
  misuse.GetFilter()->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "less");
  misuse.Expect("too few displacements", "tuples");

  misuse.GetFilter()->SetDisplacementScale(1e12);
  misuse.Expect("displacements beyond all bounds", "scale of the displacements");

  auto field = MakeImage({ { 0, 4, 0, 4, 0, 4 } });
  AddScalars<float>(field, "scalar", [](const glm::dvec3&) { return 1.0; });
  misuse.GetFilter()->SetDeformationData(field);
  misuse.Expect("a displacement field without vectors", "displacement field");

  vtkNew<vtkImageData> nothing;
  misuse.GetFilter()->SetDeformationData(nothing);
  misuse.Expect("an empty displacement field", "displacement field");

  auto besides = MakeImage({ { 0, 4, 0, 4, 0, 4 } }, glm::dvec3(1.0), glm::dvec3(500.0, 0.0, 0.0));
  SetDisplacements(besides, Shift(0.0, 0.0, 0.0));
  misuse.GetFilter()->SetDeformationData(besides);
  misuse.Expect("a displacement field outside the volume", "no voxel of the volume");
}

void TestRestMeshes(Misuse& misuse)
{
  vtkNew<vtkUnstructuredGrid> empty;
  misuse.GetFilter()->SetRestData(empty);
  misuse.Expect("an empty rest mesh", "no points");

  auto other = MakeMesh(misuse.GetVolume(), 4);
  misuse.GetFilter()->SetRestData(other);
  misuse.Expect("a rest mesh with other points", "points");

  auto fewer = misuse.CopyMesh();
  vtkNew<vtkCellArray> cells;
  for (vtkIdType cell = 1; cell < fewer->GetNumberOfCells(); ++cell)
  {
    cells->InsertNextCell(fewer->GetCell(cell));
  }
  fewer->SetCells(VTK_TETRA, cells);
  misuse.GetFilter()->SetRestData(fewer);
  misuse.Expect("a rest mesh with other cells", "cells");

  auto field = MakeImage({ { -1, 10, -1, 10, -1, 10 } });
  SetDisplacements(field, Shift(0.0, 0.0, 0.0));
  misuse.GetFilter()->SetDeformationData(field);
  misuse.GetFilter()->SetRestData(misuse.CopyMesh());
  misuse.Expect("a rest mesh with a displacement field", "Disconnect the rest configuration");
}

void TestSettings(Misuse& misuse)
{
  misuse.GetFilter()->SetDevice("a device that nobody has");
  misuse.Expect("an unknown device", "a device that nobody has");

  misuse.GetFilter()->SetMemoryLimit(1000);
  misuse.Expect("not enough memory", "1000");

  misuse.GetFilter()->SetOutputSpacingModeToCustomSpacing();
  misuse.GetFilter()->SetCustomSpacing(1.0, 0.0, 1.0);
  misuse.Expect("no output spacing", "CustomSpacing");

  misuse.GetFilter()->SetOutputBoundsModeToCustomBounds();
  misuse.GetFilter()->SetCustomBounds(5.0, 1.0, 0.0, 1.0, 0.0, 1.0);
  misuse.Expect("bounds the wrong way round", "bounds of the output are no box");
}

// A correction after a failure may also change the extent of the output.
void TestExtentAfterFailure(vtkImageData* volume, vtkUnstructuredGrid* mesh)
{
  Deformed deformed(volume, mesh);
  vtkDeformVolumeFilter* filter = deformed.Filter;
  for (const bool device : { false, true })
  {
    filter->SetOutputBoundsModeToDeformedBounds();
    filter->SetDevice(device ? "a device that nobody has" : "");
    filter->SetMemoryLimit(device ? 0 : 1000);
    filter->Update();
    VERIFY_EQUAL(deformed.TakeErrors(), 1);
    filter->SetDevice("");
    filter->SetMemoryLimit(0);
    filter->SetOutputBoundsModeToCustomBounds();
    filter->SetCustomBounds(0.0, 2.0, 0.0, 2.0, 0.0, 2.0);
    const Extent small{ { 0, 2, 0, 2, 0, 2 } };
    VERIFY_EQUAL(GetExtent(deformed.Update()), small);
  }
}

// The origin of the world is a voxel of many scans. So a mesh or a field in meters holds a voxel of
// a volume in millimeters, and only a warning can tell.
void TestUnits()
{
  const auto volume =
    MakeImage({ { 0, 40, 0, 40, 0, 40 } }, glm::dvec3(1.0), glm::dvec3(-20.0, -20.0, -20.0));
  AddScalars<float>(volume, "values", [](const glm::dvec3& p) { return p.x; });
  const auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(1.0, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  deformed.Filter->SetOutsideModeToKeep();
  deformed.Filter->Update();
  VERIFY(deformed.TakeWarning().empty());
  for (vtkIdType point = 0; point < mesh->GetNumberOfPoints(); ++point)
  {
    const glm::dvec3 inMeters = 0.001 * GetPoint(mesh, point);
    mesh->GetPoints()->SetPoint(point, &inMeters.x);
  }
  mesh->GetPoints()->Modified();
  SetDisplacements(mesh, Shift(0.001, 0.0, 0.0));
  deformed.Filter->Update();
  VERIFY_CONTAINS(deformed.TakeWarning(), "meters");
  deformed.Filter->Modified();
  deformed.Filter->Update();
  VERIFY(deformed.TakeWarning().empty()); // the warning is not repeated
  const auto field =
    MakeImage({ { 0, 4, 0, 4, 0, 4 } }, glm::dvec3(0.01), glm::dvec3(-0.02, -0.02, -0.02));
  SetDisplacements(field, Shift(0.001, 0.0, 0.0));
  deformed.Filter->SetDeformationData(field);
  deformed.Filter->Update();
  VERIFY_CONTAINS(deformed.TakeWarning(), "meters");
  deformed.Filter->SetOutsideModeToExtrapolate();
  deformed.Filter->SetDeformationData(mesh);
  deformed.Filter->Update();
  VERIFY(deformed.TakeWarning().empty());
}

// An output that is larger than any memory: one error before anything is allocated.
void TestOutputBeyondAllMemory(vtkImageData* volume, vtkUnstructuredGrid* mesh)
{
  Deformed deformed(volume, mesh);
  deformed.Filter->SetOutputBoundsModeToCustomBounds();
  deformed.Filter->SetCustomBounds(0.0, 20000.0, 0.0, 20000.0, 0.0, 20000.0);
  deformed.Filter->Update();
  VERIFY_EQUAL(deformed.TakeErrors(), 1);
  VERIFY_CONTAINS(deformed.LastError, "Not enough memory");
}

} // namespace

int TestDeformMisuse(int, char*[])
{
  Misuse misuse;
  TestVolumes(misuse);
  TestMeshes(misuse);
  TestCells(misuse);
  TestDisplacements(misuse);
  TestRestMeshes(misuse);
  TestSettings(misuse);
  TestUnits();
  auto mesh = misuse.CopyMesh();
  TestExtentAfterFailure(misuse.GetVolume(), mesh);
  TestOutputBeyondAllMemory(misuse.GetVolume(), mesh);
  return GetExitCode();
}
