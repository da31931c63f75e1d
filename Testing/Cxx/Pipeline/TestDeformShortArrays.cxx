// SPDX-License-Identifier: BSD-3-Clause
// Arrays with too few tuples: one error that names the array, no access beyond its end, and a
// filter that works again. Arrays also become shorter after an update, when the filter has buffers
// of their previous size.
#include "ArrayMaking.h"
#include "FilterTesting.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkIdTypeArray.h>
#include <vtkIntArray.h>
#include <vtkSOADataArrayTemplate.h>
#include <vtkUnsignedCharArray.h>

using namespace filterTesting;

namespace
{

const char* const GHOSTS = "vtkGhostType";

/// A volume and a mesh, which are deformed once before a test makes them invalid.
struct Case
{
  Case()
    : Volume(MakeVolume())
    , Mesh(MakeOwnMesh(Volume))
    , Subject(Volume, Mesh)
  {
    this->Subject.Update();
    this->Expected->DeepCopy(this->Subject.Filter->GetOutput());
  }
  static vtkSmartPointer<vtkUnstructuredGrid> MakeOwnMesh(vtkImageData* volume)
  {
    auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
    mesh->DeepCopy(MakeMesh(volume));
    SetDisplacements(mesh, Shift(1.0, 0.0, 0.0));
    return mesh;
  }

  /// Updates the filter, which must report one error with these words and have an empty output.
  /// Then valid inputs are set, and the output must be the expected one.
  void Fails(const char* what, const std::string& words)
  {
    SCOPED_TRACE(what);
    this->Subject.VerifyFailure(words);
    this->Volume = MakeVolume();
    this->Mesh = MakeOwnMesh(this->Volume);
    this->Subject.Filter->SetInputData(this->Volume);
    this->Subject.Filter->SetDeformationData(this->Mesh);
    this->Subject.Filter->SetInputConnection(2, nullptr);
    EXPECT_TRUE(AreEqual(this->Subject.Update(), this->Expected));
  }

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Deformed Subject;
  vtkNew<vtkImageData> Expected;
};

// Points are added and removed, while displacements and cells do not change.
TEST(DeformShortArrays, PointsAgainstDisplacements)
{
  for (const int resampler :
    { vtkDeformVolumeFilter::EXACT, vtkDeformVolumeFilter::MESH_RASTERIZATION })
  {
    for (const int outside : { vtkDeformVolumeFilter::DISCARD, vtkDeformVolumeFilter::EXTRAPOLATE })
    {
      if (resampler != vtkDeformVolumeFilter::EXACT &&
        outside == vtkDeformVolumeFilter::EXTRAPOLATE)
      {
        continue;
      }
      for (const bool gridIsModified : { false, true })
      {
        Case spoilt;
        spoilt.Subject.Filter->SetResampler(resampler);
        spoilt.Subject.Filter->SetOutsideMode(outside);
        spoilt.Subject.Update();
        spoilt.Mesh->GetPoints()->InsertNextPoint(4.0, 4.0, 4.0);
        (gridIsModified ? static_cast<vtkObject*>(spoilt.Mesh) : spoilt.Mesh->GetPoints())
          ->Modified();
        spoilt.Fails("more points than displacements", "27 tuples for 28 points");
      }
    }
  }
  Case spoilt;
  // The points change without a call of Modified(), and the filter executes for another reason.
  spoilt.Mesh->GetPoints()->InsertNextPoint(4.0, 4.0, 4.0);
  spoilt.Subject.Filter->Modified();
  spoilt.Fails("one more point without Modified()", "27 tuples for 28 points");

  spoilt.Mesh->GetPoints()->SetNumberOfPoints(20);
  spoilt.Mesh->GetPoints()->Modified();
  spoilt.Fails("fewer points than cells use", "the mesh has only 20 points");

  spoilt.Mesh->GetPointData()->GetVectors()->SetNumberOfTuples(26);
  spoilt.Mesh->GetPointData()->GetVectors()->Modified();
  spoilt.Fails("fewer displacements", "26 tuples for 27 points");

  spoilt.Mesh->GetPointData()->GetVectors()->SetNumberOfTuples(25);
  spoilt.Subject.Filter->SetDisplacementScale(2.0);
  spoilt.Subject.Filter->SetDisplacementScale(1.0);
  spoilt.Fails("fewer displacements without Modified()", "25 tuples for 27 points");

  // The same values with another number of components.
  spoilt.Mesh->GetPoints()->GetData()->SetNumberOfComponents(1);
  spoilt.Mesh->GetPoints()->Modified();
  spoilt.Fails("points of one component", "1 components");
}

TEST(DeformShortArrays, Cells)
{
  Case spoilt;
  vtkCellArray* cells = spoilt.Mesh->GetCells();
  cells->GetConnectivityArray()->SetNumberOfTuples(cells->GetNumberOfConnectivityIds() - 3);
  spoilt.Mesh->Modified();
  spoilt.Fails("a truncated connectivity", "do not fit their connectivity");

  cells = spoilt.Mesh->GetCells();
  cells->GetOffsetsArray()->SetComponent(3, 0, 1e6);
  spoilt.Mesh->Modified();
  spoilt.Fails("an offset beyond the connectivity", "do not fit their connectivity");

  spoilt.Mesh->GetCells()->GetOffsetsArray()->SetComponent(3, 0, -4);
  spoilt.Mesh->Modified();
  spoilt.Fails("a negative offset", "do not fit their connectivity");

  cells = spoilt.Mesh->GetCells();
  const vtkIdType first[4] = { 0, 1, 3, 9 };
  cells->InsertNextCell(4, first);
  spoilt.Mesh->Modified();
  spoilt.Fails("more cells than cell types", "41 cells, but 40 cell types");
}

TEST(DeformShortArrays, GhostsOfTheMesh)
{
  Case spoilt;
  const vtkIdType count = spoilt.Mesh->GetNumberOfCells();
  const auto add = [&](vtkDataArray* array) { spoilt.Mesh->GetCellData()->AddArray(array); };
  add(MakeArray<vtkUnsignedCharArray>(GHOSTS, count - 1));
  spoilt.Fails("fewer ghosts than cells of the mesh", "vtkGhostType");
  add(MakeArray<vtkUnsignedCharArray>(GHOSTS, 0));
  spoilt.Fails("no ghosts for the cells of the mesh", "0 tuples");
  add(MakeArray<vtkUnsignedCharArray>(GHOSTS, count, 2));
  spoilt.Fails("ghosts of two components", "2 components");
  add(MakeArray<vtkIntArray>(GHOSTS, count));
  spoilt.Fails("ghosts of type int", "unsigned char");

  // An array that becomes shorter after an update.
  const auto ghosts = MakeArray<vtkUnsignedCharArray>(GHOSTS, count);
  add(ghosts);
  spoilt.Mesh->Modified();
  EXPECT_TRUE(AreEqual(spoilt.Subject.Update(), spoilt.Expected));
  ghosts->SetNumberOfTuples(count / 2);
  spoilt.Mesh->GetPoints()->Modified();
  spoilt.Fails("truncated ghosts", std::to_string(count / 2) + " tuples");
}

TEST(DeformShortArrays, ArraysOfTheVolume)
{
  Case spoilt;
  const vtkIdType points = spoilt.Volume->GetNumberOfPoints();
  const vtkIdType cells = spoilt.Volume->GetNumberOfCells();
  const auto changed = [&] { spoilt.Volume->Modified(); };

  spoilt.Volume->GetPointData()->GetScalars()->SetNumberOfTuples(points - 1);
  changed();
  spoilt.Fails("fewer values than voxels", std::to_string(points - 1) + " tuples");
  spoilt.Volume->GetPointData()->AddArray(MakeArray<vtkDoubleArray>("other", 0));
  changed();
  spoilt.Fails("an array without values", "0 tuples");
  spoilt.Volume->GetPointData()->AddArray(MakeArray<vtkDoubleArray>(nullptr, 5));
  changed();
  spoilt.Fails("a short array without a name", "number 1");

  for (const char* name : { GHOSTS, "ActiveTetrahedra" })
  {
    for (const bool ofCells : { false, true })
    {
      if (!ofCells && name != GHOSTS)
      {
        continue;
      }
      const vtkIdType count = ofCells ? cells : points;
      const auto attributes = [&]() -> vtkDataSetAttributes*
      {
        return ofCells ? static_cast<vtkDataSetAttributes*>(spoilt.Volume->GetCellData())
                       : spoilt.Volume->GetPointData();
      };
      attributes()->AddArray(MakeArray<vtkUnsignedCharArray>(name, count - 1));
      changed();
      spoilt.Fails("a short mask", std::to_string(count - 1) + " tuples");
      attributes()->AddArray(MakeArray<vtkUnsignedCharArray>(name, count, 2));
      changed();
      spoilt.Fails("a mask of two components", "2 components");
      const auto mask = MakeArray<vtkUnsignedCharArray>(name, count);
      mask->Fill(name == GHOSTS ? 0 : 31);
      attributes()->AddArray(mask);
      changed();
      EXPECT_TRUE(AreEqual(spoilt.Subject.Update(), spoilt.Expected));
      mask->SetNumberOfTuples(count / 3);
      changed();
      spoilt.Fails("a truncated mask", std::to_string(count / 3) + " tuples");
    }
  }
}

TEST(DeformShortArrays, RestConfiguration)
{
  Case spoilt;
  const auto connect = [&]
  {
    auto rest = Case::MakeOwnMesh(spoilt.Volume);
    spoilt.Subject.Filter->SetRestData(rest);
    spoilt.Subject.Update();
    return rest;
  };
  auto rest = connect();
  rest->GetPoints()->InsertNextPoint(0.0, 0.0, 0.0);
  rest->GetPoints()->Modified();
  spoilt.Fails("one more point at rest", "27 points");

  rest = connect();
  spoilt.Mesh->GetPoints()->InsertNextPoint(0.0, 0.0, 0.0);
  spoilt.Mesh->GetPoints()->Modified();
  spoilt.Fails("one more point in the deformed mesh", "28 points");

  rest = connect();
  for (vtkUnstructuredGrid* grid : { rest.Get(), spoilt.Mesh.Get() })
  {
    grid->GetPoints()->SetNumberOfPoints(20);
    grid->GetPoints()->Modified();
  }
  spoilt.Fails("fewer points in both", "the mesh has only 20 points");

  // One more point in both meshes, which no cell uses, is valid.
  rest = connect();
  for (vtkUnstructuredGrid* grid : { rest.Get(), spoilt.Mesh.Get() })
  {
    grid->GetPoints()->InsertNextPoint(0.0, 0.0, 0.0);
    grid->GetPoints()->Modified();
  }
  spoilt.Subject.Update();
  EXPECT_EQ(spoilt.Subject.Filter->GetNumberOfCoveredVoxels(), spoilt.Volume->GetNumberOfPoints());

  rest->GetCells()->GetConnectivityArray()->SetNumberOfTuples(100);
  rest->Modified();
  spoilt.Fails("a truncated connectivity at rest", "do not fit their connectivity");
}

TEST(DeformShortArrays, DisplacementFields)
{
  Case spoilt;
  const auto connect = [&]
  {
    auto field = MakeImage({ { -1, 10, -1, 10, -1, 10 } });
    SetDisplacements(field, Shift(1.0, 0.0, 0.0));
    spoilt.Subject.Filter->SetDeformationData(field);
    spoilt.Subject.Update();
    return field;
  };
  auto field = connect();
  field->GetPointData()->GetVectors()->SetNumberOfTuples(1000);
  field->GetPointData()->GetVectors()->Modified();
  spoilt.Fails("truncated vectors of a field", "1000 tuples for 1728 points");
  field = connect();
  field->SetExtent(-1, 20, -1, 20, -1, 20);
  spoilt.Fails("a field that has grown", "1728 tuples for 10648 points");
}

// Unusual arrays that are valid.
TEST(DeformShortArrays, UnusualArrays)
{
  Case unusual;
  vtkNew<vtkSOADataArrayTemplate<double>> positions;
  vtkNew<vtkSOADataArrayTemplate<float>> vectors;
  vectors->SetName("displacement");
  positions->DeepCopy(unusual.Mesh->GetPoints()->GetData());
  vectors->DeepCopy(unusual.Mesh->GetPointData()->GetVectors());
  unusual.Mesh->GetPoints()->SetData(positions);
  unusual.Mesh->GetPointData()->SetVectors(vectors);
  EXPECT_TRUE(AreEqual(unusual.Subject.Update(), unusual.Expected));

  vtkNew<vtkIntArray> whole; // integer displacements, then integer points
  whole->SetName("displacement");
  whole->DeepCopy(unusual.Mesh->GetPointData()->GetVectors());
  unusual.Mesh->GetPointData()->SetVectors(whole);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToInt();
  for (vtkIdType id = 0; id < unusual.Mesh->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 point = GetPoint(unusual.Mesh, id);
    points->InsertNextPoint(std::floor(point.x), std::floor(point.y), std::ceil(point.z));
  }
  unusual.Mesh->SetPoints(points);
  unusual.Subject.Update();
  EXPECT_GT(unusual.Subject.Filter->GetNumberOfCoveredVoxels(), 500);

  unusual.Mesh->GetPointData()->GetVectors()->SetName(nullptr);
  unusual.Mesh->Modified();
  unusual.Subject.Update();
  unusual.Volume->GetPointData()->GetScalars()->SetName(nullptr);
  unusual.Volume->Modified();
  unusual.Subject.Update();
  EXPECT_NE(unusual.Subject.GetValues(), nullptr);
}

} // namespace
