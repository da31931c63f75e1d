// SPDX-License-Identifier: BSD-3-Clause
// Different descriptions of one deformation give the same result: displacements, meshes at rest and
// deformed, cells other than tetrahedra, and displacement fields. TestDeformMeshes.cxx has
// composite datasets.
#include "ArrayMaking.h"
#include "FilterTesting.h"

#include <vtkCellType.h>
#include <vtkDoubleArray.h>

#include <algorithm>

using namespace filterTesting;

namespace
{

glm::dvec3 Bend(const glm::dvec3& p)
{
  return p +
    glm::dvec3(0.6 * std::sin(0.4 * p.y), 0.5 * std::cos(0.5 * p.z), 0.4 * std::sin(0.3 * p.x));
}

vtkSmartPointer<vtkUnstructuredGrid> Warp(vtkUnstructuredGrid* rest, const WorldMap& map)
{
  auto deformed = vtkSmartPointer<vtkUnstructuredGrid>::New();
  deformed->DeepCopy(rest);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType id = 0; id < rest->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 moved = map(GetPoint(rest, id));
    points->InsertNextPoint(&moved.x);
  }
  deformed->SetPoints(points);
  return deformed;
}

/// Checks the largest difference of scalars of voxels that both images cover, and the number of
/// voxels that only one image covers.
void Compare(vtkImageData* first, vtkImageData* second, double tolerance, int border)
{
  EXPECT_EQ(GetExtent(first), GetExtent(second));
  double worst = 0.0;
  int differences = 0;
  for (vtkIdType id = 0; id < std::min(first->GetNumberOfPoints(), second->GetNumberOfPoints());
       ++id)
  {
    const auto covers = [id](vtkImageData* image)
    { return image->GetPointData()->GetArray("vtkValidPointMask")->GetComponent(id, 0) != 0.0; };
    differences += covers(first) != covers(second) ? 1 : 0;
    if (covers(first) && covers(second))
    {
      worst = std::max(worst,
        std::abs(first->GetPointData()->GetScalars()->GetComponent(id, 0) -
          second->GetPointData()->GetScalars()->GetComponent(id, 0)));
    }
  }
  EXPECT_LE(worst, tolerance);
  EXPECT_LE(differences, border); // in coverage
}

vtkSmartPointer<vtkImageData> MakeFloatVolume()
{
  auto volume = MakeImage({ { 0, 13, 0, 11, 0, 9 } });
  AddScalars<float>(volume, "value",
    [](const glm::dvec3& p) { return 30.0 * std::sin(0.7 * p.x) + 20.0 * p.y - 10.0 * p.z; });
  return volume;
}

TEST(DeformSources, Meshes)
{
  auto volume = MakeFloatVolume();
  auto rest = MakeMesh(volume, 4);
  SetDisplacements(rest, Bend);
  Deformed byDisplacement(volume, rest);
  vtkImageData* expected = byDisplacement.Update();
  EXPECT_GT(byDisplacement.Filter->GetNumberOfCoveredVoxels(), 1000);

  // Rounding differs between positions and displacements as floats. It may move a vertex by 1/256
  // voxel. Values of the volume change by at most 41 a voxel.
  const double tolerance = 41.0 * 3.0 / 256.0;
  auto deformed = Warp(rest, Bend);
  Deformed byRestMesh(volume, deformed);
  byRestMesh.Filter->SetRestData(rest);
  Compare(byRestMesh.Update(), expected, tolerance, 12);

  // If port 2 is connected, displacements are ignored.
  byRestMesh.Filter->SetDisplacementScale(5.0);
  Compare(byRestMesh.Update(), expected, tolerance, 12);

  // The mesh at rest on both ports.
  byRestMesh.Filter->SetDeformationData(rest);
  Deformed still(volume, rest);
  still.Filter->SetDisplacementScale(0.0);
  EXPECT_TRUE(AreEqual(byRestMesh.Update(), still.Update()));
  EXPECT_EQ(GetExtent(still.Filter->GetOutput()), GetExtent(volume));
}

TEST(DeformSources, ChoiceOfDisplacements)
{
  auto volume = MakeFloatVolume();
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(1.0, 0.0, 0.0), "first");
  vtkSmartPointer<vtkDataArray> first = mesh->GetPointData()->GetVectors();
  SetDisplacements(mesh, Shift(0.0, 2.0, 0.0), "second");
  mesh->GetPointData()->AddArray(first);
  Deformed deformed(volume, mesh);
  EXPECT_EQ(GetExtent(deformed.Update()), (Extent{ { 0, 13, 2, 13, 0, 9 } }));
  deformed.Filter->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "first");
  EXPECT_EQ(GetExtent(deformed.Update()), (Extent{ { 1, 14, 0, 11, 0, 9 } }));
  deformed.Filter->SetDisplacementScale(-3.0);
  EXPECT_EQ(GetExtent(deformed.Update()), (Extent{ { -3, 10, 0, 11, 0, 9 } }));
  deformed.Filter->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "second");
  EXPECT_EQ(GetExtent(deformed.Update()), (Extent{ { 0, 13, -6, 5, 0, 9 } }));

  // Displacements may have any numeric type.
  const auto doubles = MakeArray<vtkDoubleArray>("doubles", mesh->GetNumberOfPoints(), 3);
  doubles->Fill(1.0);
  mesh->GetPointData()->AddArray(doubles);
  mesh->Modified();
  deformed.Filter->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "doubles");
  deformed.Filter->SetDisplacementScale(1.0);
  EXPECT_EQ(GetExtent(deformed.Update()), (Extent{ { 1, 14, 1, 12, 1, 10 } }));

  // Without a name the active vectors are used, or the only array of vectors.
  deformed.Filter->SetInputArrayToProcess(0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "");
  EXPECT_EQ(GetExtent(deformed.Update()), (Extent{ { 0, 13, 2, 13, 0, 9 } }));
  mesh->GetPointData()->SetActiveVectors(nullptr);
  mesh->Modified();
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeErrors(), 1);
  mesh->GetPointData()->RemoveArray("second");
  mesh->GetPointData()->RemoveArray("doubles");
  mesh->Modified();
  EXPECT_EQ(GetExtent(deformed.Update()), (Extent{ { 1, 14, 0, 11, 0, 9 } }));
}

TEST(DeformSources, OtherCells)
{
  // An affine map does not depend on how cells are split.
  auto volume = MakeFloatVolume();
  const WorldMap map = [](const glm::dvec3& p)
  { return glm::dvec3(1.2 * p.x + 0.1 * p.y, p.y - 0.2 * p.z, 1.1 * p.z + 0.3); };
  auto tetrahedra = MakeMesh(volume);
  SetDisplacements(tetrahedra, map);
  Deformed expected(volume, tetrahedra);
  expected.Update();

  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int corner = 0; corner < 12; ++corner)
  {
    points->InsertNextPoint(corner % 3 == 0 ? -0.5
        : corner % 3 == 1                   ? 6.0
                                            : 13.5,
      corner / 3 % 2 == 0 ? -0.5 : 11.5, corner / 6 == 0 ? -0.5 : 9.5);
  }
  vtkNew<vtkUnstructuredGrid> hexahedra;
  hexahedra->SetPoints(points);
  const vtkIdType left[8] = { 0, 1, 4, 3, 6, 7, 10, 9 };
  const vtkIdType right[8] = { 1, 2, 4, 5, 7, 8, 10, 11 };
  hexahedra->InsertNextCell(VTK_HEXAHEDRON, 8, left);
  hexahedra->InsertNextCell(VTK_VOXEL, 8, right);
  SetDisplacements(hexahedra, map);
  Deformed deformed(volume, hexahedra);
  Compare(deformed.Update(), expected.Filter->GetOutput(), 41.0 * 3.0 / 256.0, 30);

  // Wedges and pyramids fill the same box.
  vtkNew<vtkUnstructuredGrid> mixed;
  points->InsertNextPoint(9.75, 5.5, 4.5);
  mixed->SetPoints(points);
  const vtkIdType lower[6] = { 0, 1, 4, 6, 7, 10 };
  const vtkIdType upper[6] = { 0, 4, 3, 6, 10, 9 };
  mixed->InsertNextCell(VTK_WEDGE, 6, lower);
  mixed->InsertNextCell(VTK_WEDGE, 6, upper);
  const vtkIdType faces[6][5] = { { 1, 2, 5, 4, 12 }, { 7, 10, 11, 8, 12 }, { 1, 7, 8, 2, 12 },
    { 4, 5, 11, 10, 12 }, { 1, 4, 10, 7, 12 }, { 2, 8, 11, 5, 12 } };
  for (const auto& face : faces)
  {
    mixed->InsertNextCell(VTK_PYRAMID, 5, face);
  }
  // A surface cell is ignored with a warning.
  const vtkIdType triangle[3] = { 0, 1, 4 };
  mixed->InsertNextCell(VTK_TRIANGLE, 3, triangle);
  SetDisplacements(mixed, map);
  deformed.Filter->SetDeformationData(mixed);
  deformed.Filter->Update();
  EXPECT_FALSE(deformed.TakeWarning().empty());
  Compare(deformed.Update(), expected.Filter->GetOutput(), 41.0 * 3.0 / 256.0, 30);
}

TEST(DeformSources, FlatTetrahedraAreCounted)
{
  auto volume = MakeFloatVolume();
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Bend);
  Deformed deformed(volume, mesh);
  deformed.Update();
  EXPECT_EQ(deformed.Filter->GetNumberOfFlatTetrahedra(), 0);
  vtkNew<vtkImageData> expected;
  expected->DeepCopy(deformed.Filter->GetOutput());
  const vtkIdType flat[2][4] = { { 0, 1, 2, 3 }, { 4, 4, 7, 13 } };
  for (const auto& tetrahedron : flat)
  {
    mesh->InsertNextCell(VTK_TETRA, 4, tetrahedron);
  }
  mesh->Modified();
  EXPECT_TRUE(AreEqual(deformed.Update(), expected));
  EXPECT_EQ(deformed.Filter->GetNumberOfFlatTetrahedra(), 2);
}

// A field of one slice holds no two neighboring voxels on one of the axes.
TEST(DeformSources, FieldOfOneSlice)
{
  auto volume = MakeFloatVolume();
  auto field = MakeImage({ { 0, 13, 0, 11, 5, 5 } });
  SetDisplacements(field, Shift(0.0, 0.0, 0.0));
  Deformed deformed(volume, field);
  deformed.Expect("and that the displacement field holds neighboring voxels");
}

TEST(DeformSources, DisplacementFields)
{
  auto volume = MakeFloatVolume();
  // The map is trilinear, and hence independent of the resolution of the field.
  const WorldMap map = [](const glm::dvec3& p)
  {
    return p +
      glm::dvec3(0.02 * p.x * p.y, 0.3 + 0.01 * p.y * p.z, 0.002 * p.x * p.y * p.z - 0.05 * p.x);
  };
  auto atVoxels = MakeImage({ { 0, 13, 0, 11, 0, 9 } });
  SetDisplacements(atVoxels, map);
  Deformed fine(volume, atVoxels);
  fine.Update();
  EXPECT_GT(fine.Filter->GetNumberOfCoveredVoxels(), 1000);
  EXPECT_EQ(fine.Filter->GetNumberOfInvertedTetrahedra(), 0);
  EXPECT_EQ(GetReported(fine.Filter, "Static mappings made"), 0);

  auto coarse =
    MakeImage({ { -1, 3, 2, 5, -4, -1 } }, glm::dvec3(4.0, 5.0, 4.5), glm::dvec3(2.0, -12.0, 17.0));
  SetDisplacements(coarse, map);
  Deformed other(volume, coarse);
  // The bounds by a coarse field may be larger.
  for (vtkDeformVolumeFilter* filter : { fine.Filter.Get(), other.Filter.Get() })
  {
    filter->SetOutputBoundsModeToVolumeBounds();
    filter->SetPadding(3);
  }
  fine.Update();
  Compare(other.Update(), fine.Filter->GetOutput(), 41.0 * 3.0 / 256.0, 12);

  // Vectors of type double, chosen by name.
  auto doubles = vtkSmartPointer<vtkImageData>::New();
  doubles->CopyStructure(coarse);
  vtkNew<vtkDoubleArray> vectors;
  vectors->DeepCopy(coarse->GetPointData()->GetVectors());
  vectors->SetName("field");
  doubles->GetPointData()->AddArray(vectors);
  other.Filter->SetDeformationData(doubles);
  other.Filter->SetInputArrayToProcess(0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "field");
  Compare(other.Update(), fine.Filter->GetOutput(), 41.0 * 3.0 / 256.0, 12);

  // DisplacementScale also applies to fields.
  other.Filter->SetDisplacementScale(0.0);
  other.Filter->SetOutputBoundsModeToDeformedBounds();
  other.Filter->SetPadding(0);
  EXPECT_EQ(GetExtent(other.Update()), GetExtent(volume));
  EXPECT_TRUE(HaveEqualBits(other.GetValues(), volume->GetPointData()->GetScalars()));
}

TEST(DeformSources, FieldWithDirection)
{
  // Field and volume have different directions. Displacements are in world coordinates.
  auto volume = MakeImage({ { 0, 9, 0, 9, 0, 9 } }, glm::dvec3(1.0, 1.5, 0.5));
  SetObliqueDirection(volume);
  AddScalars<float>(volume, "value", [](const glm::dvec3& p) { return p.x + 10.0 * p.y - p.z; });
  auto field = MakeImage({ { -15, 15, -15, 15, -15, 15 } }, glm::dvec3(2.0));
  SetDisplacements(field, Shift(0.4, -0.7, 0.9));
  Deformed straight(volume, field);
  straight.Update();
  auto turned = MakeImage({ { -15, 15, -15, 15, -15, 15 } }, glm::dvec3(2.5));
  SetObliqueDirection(turned);
  SetDisplacements(turned, Shift(0.4, -0.7, 0.9));
  Deformed oblique(volume, turned);
  EXPECT_TRUE(AreEqual(straight.Filter->GetOutput(), oblique.Update()));
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.4, -0.7, 0.9));
  Deformed byMesh(volume, mesh);
  Compare(byMesh.Update(), oblique.Filter->GetOutput(), 12.0 * 3.0 / 256.0, 30);
}

} // namespace
