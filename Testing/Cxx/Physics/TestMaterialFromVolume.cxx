// SPDX-License-Identifier: BSD-3-Clause
// vtkMaterialFromVolume: misuse, means compared with a search of all voxels, shared arrays, and a
// simulation with a soft and a stiff part.
#include "ArrayMaking.h"
#include "ChainMailTesting.h"

#include "vtkFiniteElementDeformation.h"
#include "vtkMaterialFromVolume.h"

#include <vtkCellArray.h>
#include <vtkSMPTools.h>
#include <vtkShortArray.h>
#include <vtkSignedCharArray.h>
#include <vtkUnsignedCharArray.h>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <limits>
#include <random>

using namespace chainMailTesting;
using namespace filterTesting;

namespace
{

constexpr const char* Names[3] = { "YoungModulus", "PoissonRatio", "Density" };

// An oblique volume of random labels 0 to 4, as shorts.
vtkSmartPointer<vtkImageData> MakeVolume()
{
  auto volume = vtkSmartPointer<vtkImageData>::New();
  volume->SetExtent(-2, 17, 3, 20, -1, 13);
  volume->SetOrigin(10.0, -4.0, 2.0);
  volume->SetSpacing(1.0, 0.75, 1.5);
  volume->SetDirectionMatrix(0.8, -0.6, 0.0, 0.6, 0.8, 0.0, 0.0, 0.0, 1.0);
  const auto labels = MakeArray<vtkShortArray>("labels", volume->GetNumberOfPoints());
  std::mt19937 random(3);
  for (vtkIdType i = 0; i < labels->GetNumberOfTuples(); ++i)
  {
    labels->SetValue(i, static_cast<short>(random() % 5));
  }
  volume->GetPointData()->SetScalars(labels);
  return volume;
}

// A mesh of tetrahedra in general position that contains most of the volume and some space outside.
vtkSmartPointer<vtkUnstructuredGrid> MakeMesh(vtkImageData* volume, int nodes)
{
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetInputData(volume);
  lattice->SetNumberOfNodes(nodes, nodes, nodes);
  lattice->EqualSpacingOff();
  lattice->Update();
  auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  mesh->DeepCopy(lattice->GetOutput());
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
  {
    glm::dvec3 point;
    mesh->GetPoint(i, &point.x);
    point.z += 3.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      point[axis] += jitter(random);
    }
    mesh->GetPoints()->SetPoint(i, &point.x);
  }
  return mesh;
}

struct Tested : Observed<vtkMaterialFromVolume>
{
  explicit Tested(vtkDataObject* mesh, vtkDataObject* volume)
  {
    this->Filter->SetInputDataObject(mesh);
    this->Filter->SetVolumeData(volume);
    this->Filter->SetMaterialArrayName("labels");
  }
  double Get(int name, vtkIdType cell)
  {
    return this->Filter->GetOutput()->GetCellData()->GetArray(Names[name])->GetComponent(cell, 0);
  }
};

TEST(MaterialFromVolume, Misuse)
{
  vtkSmartPointer<vtkImageData> volume = MakeVolume();
  vtkSmartPointer<vtkUnstructuredGrid> mesh = MakeMesh(volume, 4);
  Tested tested(mesh, volume);
  EXPECT_EQ(tested.TryUpdate(), "");

  tested.Filter->SetMaterialArrayName("none");
  EXPECT_TRUE(HasPart(tested.TryUpdate(), "no point array \"none\""));
  tested.Filter->SetMaterialArrayName("");
  EXPECT_EQ(tested.TryUpdate(), ""); // all tetrahedra have the default material
  EXPECT_EQ(tested.Get(0, 0), 1e4);
  tested.Filter->SetMaterialArrayName("labels");

  const auto tryMaterial = [&](double youngModulus, double poissonRatio, double density)
  {
    tested.Filter->SetMaterial(2, youngModulus, poissonRatio, density);
    const std::string errors = tested.TryUpdate();
    tested.Filter->SetMaterial(2, 5e4, 0.4, 1060.0);
    return errors;
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(HasPart(tryMaterial(0.0, 0.3, 1.0), "Young modulus of material 2"));
  EXPECT_TRUE(HasPart(tryMaterial(nan, 0.3, 1.0), "Young modulus of material 2"));
  EXPECT_TRUE(HasPart(tryMaterial(1.0, 0.495, 1.0), "Poisson ratio of material 2"));
  EXPECT_TRUE(HasPart(tryMaterial(1.0, 0.3, -1.0), "density of material 2"));
  EXPECT_EQ(tested.TryUpdate(), "");

  tested.Filter->SetMaterial(256, 1.0, 0.0, 1.0);
  EXPECT_TRUE(HasPart(tested.Observer->GetErrorMessage(), "material index 256 is not valid"));
  tested.Observer->Clear();
  tested.Filter->SetMaterial(1.5, 1.0, 0.0, 1.0);
  EXPECT_TRUE(HasPart(tested.Observer->GetErrorMessage(), "material index 1.5 is not valid"));
  tested.Observer->Clear();
  tested.Filter->AddMaterialRange(0.0, 1.0, -1.0);
  EXPECT_TRUE(HasPart(tested.Observer->GetErrorMessage(), "material index -1 is not valid"));
  tested.Observer->Clear();
  EXPECT_EQ(tested.Filter->GetNumberOfMaterialRanges(), 0);

  vtkShortArray::SafeDownCast(volume->GetPointData()->GetScalars())->SetValue(11, 5);
  EXPECT_TRUE(HasPart(tested.TryUpdate(), "Voxel 11 has the value 5"));
  vtkShortArray::SafeDownCast(volume->GetPointData()->GetScalars())->SetValue(11, 1);

  // Values of hidden and duplicate voxels need no material.
  for (const int kind : { vtkDataSetAttributes::HIDDENPOINT, vtkDataSetAttributes::DUPLICATEPOINT })
  {
    vtkShortArray::SafeDownCast(volume->GetPointData()->GetScalars())->SetValue(11, -1000);
    const auto marked =
      MakeArray<vtkUnsignedCharArray>("vtkGhostType", volume->GetNumberOfPoints());
    marked->SetValue(11, static_cast<unsigned char>(kind));
    volume->GetPointData()->AddArray(marked);
    EXPECT_EQ(tested.TryUpdate(), "");
    vtkShortArray::SafeDownCast(volume->GetPointData()->GetScalars())->SetValue(12, -1000);
    EXPECT_TRUE(HasPart(tested.TryUpdate(), "Voxel 12 has the value -1000"));
    vtkShortArray::SafeDownCast(volume->GetPointData()->GetScalars())->SetValue(12, 1);
  }
  volume->GetPointData()->RemoveArray("vtkGhostType");
  const auto valid =
    MakeArray<vtkSignedCharArray>("vtkValidPointMask", volume->GetNumberOfPoints());
  valid->Fill(1.0);
  valid->SetValue(11, 0);
  volume->GetPointData()->AddArray(valid);
  EXPECT_EQ(tested.TryUpdate(), "");
  volume->GetPointData()->RemoveArray("vtkValidPointMask");
  vtkShortArray::SafeDownCast(volume->GetPointData()->GetScalars())->SetValue(11, 1);

  tested.Filter->ClearMaterials();
  EXPECT_EQ(tested.Filter->GetNumberOfMaterials(), 0);
  EXPECT_TRUE(HasPart(tested.TryUpdate(), "DefaultMaterial 1 is not defined"));
  tested.Filter->SetMaterial(1, 1e4, 0.3, 1000.0);
  EXPECT_TRUE(HasPart(tested.TryUpdate(), "for which there is no material"));

  // A ghost array that is too short.
  tested.Filter->SetMaterial(0, 100.0, 0.0, 100.0);
  for (int index = 2; index < 5; ++index)
  {
    tested.Filter->SetMaterial(index, 1e4, 0.3, 1000.0);
  }
  EXPECT_EQ(tested.TryUpdate(), "");
  const auto ghosts = MakeArray<vtkUnsignedCharArray>("vtkGhostType", 7);
  volume->GetPointData()->AddArray(ghosts);
  EXPECT_TRUE(HasPart(tested.TryUpdate(), "vtkGhostType"));
  volume->GetPointData()->RemoveArray("vtkGhostType");

  vtkNew<vtkImageData> flat;
  flat->SetDimensions(5, 5, 1);
  Tested onFlat(mesh, flat);
  EXPECT_TRUE(HasPart(onFlat.TryUpdate(), "The volume has one voxel only on axis z"));
  vtkNew<vtkUnstructuredGrid> hexahedron;
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(8);
  const vtkIdType ids[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };
  hexahedron->SetPoints(points);
  hexahedron->InsertNextCell(VTK_HEXAHEDRON, 8, ids);
  EXPECT_TRUE(HasPart(Tested(hexahedron, volume).TryUpdate(), "hexahedron"));
  mesh->GetPoints()->SetPoint(3, nan, 0.0, 0.0);
  EXPECT_TRUE(HasPart(Tested(mesh, volume).TryUpdate(), "Point 3"));
  vtkNew<vtkUnstructuredGrid> empty;
  EXPECT_EQ(Tested(empty, volume).TryUpdate(), "");
}

// Compares means with a search of all voxels. Since nodes are rounded to 1/256 voxel, tetrahedra
// with a voxel near one of their faces are skipped.
void CheckMeans(bool hides)
{
  vtkSmartPointer<vtkImageData> volume = MakeVolume();
  vtkSmartPointer<vtkUnstructuredGrid> mesh = MakeMesh(volume, 12);
  const auto other = MakeArray<vtkFloatArray>("other", mesh->GetNumberOfCells());
  mesh->GetCellData()->AddArray(other);
  vtkNew<vtkUnsignedCharArray> ghosts;
  if (hides)
  {
    ghosts->SetName("vtkGhostType");
    ghosts->SetNumberOfTuples(volume->GetNumberOfPoints());
    for (vtkIdType i = 0; i < ghosts->GetNumberOfTuples(); ++i)
    {
      ghosts->SetValue(i, i % 3 == 0 ? vtkDataSetAttributes::HIDDENPOINT : 0);
    }
    volume->GetPointData()->AddArray(ghosts);
  }
  Tested tested(mesh, volume);
  EXPECT_EQ(tested.TryUpdate(), "");
  vtkUnstructuredGrid* output = tested.Filter->GetOutput();
  EXPECT_EQ(output->GetPoints(), mesh->GetPoints());
  EXPECT_EQ(output->GetCellData()->GetArray("other"), other);

  vtkIdType held = 0;
  vtkIdType nearest = 0;
  vtkIdType outside = 0;
  vtkIdType nearBorder = 0;
  double worst = 0.0;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    const vtkIdType* ids = nullptr;
    vtkIdType size = 0;
    mesh->GetCells()->GetCellAtId(cell, size, ids);
    glm::dvec3 p[4];
    for (int k = 0; k < 4; ++k)
    {
      mesh->GetPoint(ids[k], &p[k].x);
    }
    const glm::dmat3 inverse = glm::inverse(glm::dmat3(p[1] - p[0], p[2] - p[0], p[3] - p[0]));
    double sums[3] = { 0.0, 0.0, 0.0 };
    int voxels = 0;
    bool isNearBorder = false;
    const auto add = [&](vtkIdType voxel)
    {
      double values[3];
      const int label =
        static_cast<int>(volume->GetPointData()->GetScalars()->GetComponent(voxel, 0));
      EXPECT_TRUE(tested.Filter->GetMaterialValues(label, values));
      for (int k = 0; k < 3; ++k)
      {
        sums[k] += values[k];
      }
      ++voxels;
    };
    for (vtkIdType voxel = 0; voxel < volume->GetNumberOfPoints(); ++voxel)
    {
      glm::dvec3 point;
      volume->GetPoint(voxel, &point.x);
      const glm::dvec3 w = inverse * (point - p[0]);
      constexpr double margin = 0.02;
      const double least = std::min({ w.x, w.y, w.z, 1.0 - w.x - w.y - w.z });
      isNearBorder |= std::abs(least) < margin;
      if (least >= 0.0 && !(hides && voxel % 3 == 0))
      {
        add(voxel);
      }
    }
    if (isNearBorder)
    {
      ++nearBorder;
      continue;
    }
    held += voxels > 0 ? 1 : 0;
    if (voxels == 0)
    {
      const glm::dvec3 centroid = 0.25 * (p[0] + p[1] + p[2] + p[3]);
      double index[3];
      volume->TransformPhysicalPointToContinuousIndex(&centroid.x, index);
      int ijk[3];
      const int* extent = volume->GetExtent();
      bool isInside = true;
      for (int k = 0; k < 3; ++k)
      {
        ijk[k] = static_cast<int>(std::lround(index[k]));
        isInside &= ijk[k] >= extent[2 * k] && ijk[k] <= extent[2 * k + 1];
      }
      const vtkIdType voxel = isInside ? volume->ComputePointId(ijk) : -1;
      if (voxel >= 0 && !(hides && voxel % 3 == 0))
      {
        add(voxel);
        ++nearest;
      }
      else
      {
        sums[0] = 1e4;
        sums[1] = 0.3;
        sums[2] = 1000.0;
        voxels = 1;
        ++outside;
      }
    }
    for (int k = 0; k < 3; ++k)
    {
      const double wanted = sums[k] / voxels;
      worst = std::max(worst, std::abs(tested.Get(k, cell) - wanted) / (wanted + 1e-3));
    }
  }
  std::cout << held << " tetrahedra contain voxels, " << nearest << " have the nearest, " << outside
            << " none, " << nearBorder << " are skipped; largest relative error " << worst << "\n";
  EXPECT_LT(worst, 1e-12);
  EXPECT_TRUE(held > 1000 && nearest > 100 && outside > 100);
  EXPECT_LT(nearBorder, mesh->GetNumberOfCells() / 4);
  const auto differs = [&](vtkIdType count, vtkIdType wanted)
  { return count < wanted || count > wanted + nearBorder; };
  EXPECT_FALSE(differs(tested.Filter->GetNumberOfTetrahedraWithoutVoxels(), nearest));
  EXPECT_FALSE(differs(tested.Filter->GetNumberOfTetrahedraOutside(), outside));

  // The result does not depend on the number of threads.
  vtkNew<vtkUnstructuredGrid> before;
  before->DeepCopy(output);
  vtkSMPTools::LocalScope(vtkSMPTools::Config{ 1 }, [&] { EXPECT_EQ(tested.TryUpdate(), ""); });
  for (const char* name : Names)
  {
    vtkDataArray* a = before->GetCellData()->GetArray(name);
    vtkDataArray* b = tested.Filter->GetOutput()->GetCellData()->GetArray(name);
    EXPECT_TRUE(std::equal(static_cast<double*>(a->GetVoidPointer(0)),
      static_cast<double*>(a->GetVoidPointer(0)) + a->GetNumberOfTuples(),
      static_cast<double*>(b->GetVoidPointer(0))));
  }
}

// Ranges of values instead of labels. If ranges overlap, the first one is used.
TEST(MaterialFromVolume, Ranges)
{
  vtkSmartPointer<vtkImageData> volume = MakeVolume();
  vtkSmartPointer<vtkUnstructuredGrid> mesh = MakeMesh(volume, 3);
  Tested byLabels(mesh, volume);
  EXPECT_EQ(byLabels.TryUpdate(), "");
  Tested byRanges(mesh, volume);
  byRanges.Filter->SetMaterialArrayName("");
  byRanges.Filter->AddMaterialRange(-5.0, 1.0, 0);
  byRanges.Filter->AddMaterialRange(2.0, 3.0, 2);
  byRanges.Filter->AddMaterialRange(3.0, 3.5, 3);
  byRanges.Filter->AddMaterialRange(2.5, 10.0, 4);
  EXPECT_EQ(byRanges.TryUpdate(), "");
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    for (int k = 0; k < 3; ++k)
    {
      EXPECT_EQ(byRanges.Get(k, cell), byLabels.Get(k, cell));
    }
  }
}

// Presets of tissues: errors do not change the filter, and presets give the same means as their
// values.
TEST(MaterialFromVolume, Presets)
{
  vtkSmartPointer<vtkImageData> volume = MakeVolume();
  vtkSmartPointer<vtkUnstructuredGrid> mesh = MakeMesh(volume, 5);
  Tested tested(mesh, volume);
  vtkMaterialFromVolume* filter = tested.Filter;
  const auto fail = [&](int index, int preset, const std::string& words)
  {
    const vtkMTimeType time = filter->GetMTime();
    filter->SetMaterialPreset(index, preset);
    const std::string errors = tested.Observer->GetErrorMessage();
    tested.Observer->Clear();
    EXPECT_TRUE(HasPart(errors, words));
    EXPECT_EQ(filter->GetMTime(), time);
    EXPECT_EQ(filter->GetNumberOfMaterialPresets(), 0);
  };
  fail(256, vtkElasticDeformation::LIVER, "material index 256 is not valid");
  fail(-1, vtkElasticDeformation::LIVER, "material index -1 is not valid");
  fail(4, 8, "preset 8 of material 4 is not defined");
  fail(4, -1, "preset -1 of material 4 is not defined");
  for (const int index : { -1, 0, 256 })
  {
    EXPECT_EQ(filter->GetMaterialPreset(index), static_cast<int>(vtkElasticDeformation::CUSTOM));
  }

  using Means = std::vector<double>;
  const auto find = [&](Tested& one)
  {
    EXPECT_EQ(one.TryUpdate(), "");
    Means means;
    for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
    {
      for (int name = 0; name < 3; ++name)
      {
        means.push_back(one.Get(name, cell));
      }
    }
    return means;
  };
  const Means before = find(tested);
  Tested wanted(mesh, volume);
  wanted.Filter->SetMaterial(1, 1600.0, 0.49, 1040.0);
  wanted.Filter->SetMaterial(4, 18.6e9, 0.3, 1920.0);
  // The order of SetMaterial() and SetMaterialPreset() does not matter.
  filter->SetMaterialPreset(1, vtkElasticDeformation::BRAIN);
  filter->SetMaterialPreset(4, vtkElasticDeformation::BONE);
  filter->SetMaterial(1, -1.0, 0.3, 1000.0);
  EXPECT_EQ(filter->GetNumberOfMaterialPresets(), 2);
  EXPECT_EQ(filter->GetMaterialPreset(4), static_cast<int>(vtkElasticDeformation::BONE));
  const Means means = find(tested);
  EXPECT_NE(means, before);
  EXPECT_EQ(means, find(wanted));
  std::ostringstream printed;
  filter->Print(printed);
  EXPECT_TRUE(HasPart(printed.str(), "4: Bone"));
  // With CUSTOM the values of SetMaterial() are used again.
  filter->SetMaterialPreset(1, vtkElasticDeformation::CUSTOM);
  EXPECT_TRUE(HasPart(tested.TryUpdate(), "Young modulus of material 1"));
  filter->SetMaterial(1, 1e4, 0.3, 1000.0);
  filter->ClearMaterialPresets();
  EXPECT_EQ(filter->GetNumberOfMaterialPresets(), 0);
  EXPECT_EQ(find(tested), before);

  // An index with a preset needs no call of SetMaterial().
  filter->ClearMaterials();
  for (int index = 0; index < 5; ++index)
  {
    filter->SetMaterialPreset(index, vtkElasticDeformation::FAT);
  }
  EXPECT_EQ(filter->GetNumberOfMaterials(), 0);
  const Means fat = find(tested);
  for (std::size_t i = 0; i < fat.size(); i += 3)
  {
    EXPECT_LT(std::abs(fat[i] - 3250.0), 1e-9 * 3250.0);
    EXPECT_LT(std::abs(fat[i + 1] - 0.49), 1e-12);
    EXPECT_LT(std::abs(fat[i + 2] - 950.0), 1e-9 * 950.0);
  }
}

TEST(MaterialFromVolume, Abort)
{
  vtkSmartPointer<vtkImageData> volume = MakeVolume();
  Tested tested(MakeMesh(volume, 4), volume);
  tested.Abort();
  tested.Filter->Update();
  EXPECT_GT(tested.Filter->GetOutput()->GetNumberOfPoints(), 0);
}

// One half of a bar is a hundred times as stiff as the other one. When the bar is pulled, the soft
// half is elongated.
TEST(MaterialFromVolume, InSimulation)
{
  vtkNew<vtkImageData> volume;
  volume->SetDimensions(9, 9, 41);
  volume->AllocateScalars(VTK_FLOAT, 1);
  for (int z = 0; z < 41; ++z)
  {
    for (int i = 0; i < 81; ++i)
    {
      volume->GetPointData()->GetScalars()->SetTuple1(z * 81 + i, z < 20 ? 0.5 : 7.0);
    }
  }
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetInputData(volume);
  lattice->SetNumberOfNodes(3, 3, 11);
  lattice->EqualSpacingOff();
  lattice->Update();
  vtkNew<vtkUnstructuredGrid> bar;
  bar->ShallowCopy(lattice->GetOutput());
  // Both ends are fixed, with their mid-side nodes. One end is displaced so little that the
  // deformation is linear.
  constexpr double pull = 0.02;
  vtkNew<vtkUnsignedCharArray> fixed;
  fixed->SetName("Fixed");
  vtkNew<vtkDoubleArray> prescribed;
  prescribed->SetName("PrescribedDisplacement");
  prescribed->SetNumberOfComponents(3);
  for (vtkIdType i = 0; i < bar->GetNumberOfPoints(); ++i)
  {
    const double z = bar->GetPoint(i)[2];
    fixed->InsertNextValue(z == 0.0 || z == 40.0 ? 1 : 0);
    prescribed->InsertNextTuple3(0.0, 0.0, z == 40.0 ? pull : 0.0);
  }
  bar->GetPointData()->AddArray(fixed);
  bar->GetPointData()->AddArray(prescribed);
  Tested tested(bar, volume);
  tested.Filter->SetMaterialArrayName("");
  tested.Filter->ClearMaterials();
  tested.Filter->SetMaterial(1, 1e6, 0.0, 1000.0);
  tested.Filter->SetMaterial(7, 1e4, 0.0, 1000.0);
  tested.Filter->AddMaterialRange(5.0, 10.0, 7);
  vtkNew<vtkFiniteElementDeformation> body;
  body->SetModeToConverged();
  body->SetInputConnection(tested.Filter->GetOutputPort());
  body->Update();
  // The stress is uniform, so strains are 1 : 100 over two lengths of 20. Tetrahedra with voxels of
  // both materials are an exception.
  double moved[2] = { 0.0, 0.0 };
  for (vtkIdType i = 0; i < bar->GetNumberOfPoints(); ++i)
  {
    const double z = bar->GetPoint(i)[2];
    const double displacement =
      body->GetOutput()->GetPointData()->GetArray("Displacement")->GetComponent(i, 2);
    moved[0] += z == 16.0 ? displacement / 9.0 : 0.0;
    moved[1] += z == 24.0 ? displacement / 9.0 : 0.0;
  }
  std::cout << "displacements at 16 and 24: " << moved[0] << " " << moved[1] << "\n";
  constexpr double unit = pull / (20.0 + 100.0 * 20.0);
  EXPECT_LT(std::abs(moved[0] - 16.0 * unit), 0.02 * 16.0 * unit);
  EXPECT_LT(std::abs(moved[1] - 420.0 * unit), 0.02 * 420.0 * unit);
}

} // namespace

TEST(MaterialFromVolume, Means)
{
  CheckMeans(false);
  CheckMeans(true);
}
