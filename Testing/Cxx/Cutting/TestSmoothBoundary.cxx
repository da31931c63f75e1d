// SPDX-License-Identifier: BSD-3-Clause
// Carving with SmoothBoundary: misuse, spheres and planes in fine outputs, undo and redo, chains of
// filters, tools, labels and deformed volumes.
#include "EditChecks.h"

#include "vtkCarveVolume.h"
#include "vtkCutVolume.h"

#include <vtkDoubleArray.h>
#include <vtkImplicitBoolean.h>
#include <vtkPlane.h>
#include <vtkSphere.h>
#include <vtkSphereSource.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <limits>
#include <random>

using namespace filterTesting;

namespace
{

const char* const NAME = "BoundaryDistance";
constexpr double Pi = 3.14159265358979323846;

vtkDataArray* GetDistances(vtkImageData* image)
{
  return image->GetPointData()->GetArray(NAME);
}

/// A carved volume at rest, sampled with a spacing that is smaller by a factor.
struct Fine
{
  Fine(vtkImageData* volume, vtkAlgorithmOutput* carved, int factor)
  {
    auto mesh = MakeMesh(volume, 2);
    SetDisplacements(mesh, Shift(0, 0, 0));
    this->Deformed.Filter->SetInputConnection(carved);
    this->Deformed.Filter->SetDeformationData(mesh);
    this->Deformed.Filter->SetOutputSpacingModeToCustomSpacing();
    this->Deformed.Filter->SetCustomSpacing(volume->GetSpacing()[0] / factor,
      volume->GetSpacing()[1] / factor, volume->GetSpacing()[2] / factor);
  }

  /// The volume of the carved part, in world units: one box of the spacing for each sample that is
  /// not covered.
  double GetMissing()
  {
    vtkImageData* image = this->Deformed.Update();
    const double* spacing = image->GetSpacing();
    const auto missing = static_cast<double>(
      image->GetNumberOfPoints() - this->Deformed.Filter->GetNumberOfCoveredVoxels());
    return missing * spacing[0] * spacing[1] * spacing[2];
  }

  filterTesting::Deformed Deformed;
};

TEST(SmoothBoundary, Misuse)
{
  auto volume = MakeVolume(CarvedBox);
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(5, 5, 6);
  sphere->SetRadius(3.3);
  Edited<vtkCarveVolume> carve;
  carve.Filter->SetInputData(volume);
  carve.Filter->SetImplicitFunction(sphere);
  EXPECT_FALSE(carve.Filter->GetSmoothBoundary());
  carve.CopyMask();
  EXPECT_EQ(GetDistances(carve.Filter->GetOutput()), nullptr);
  carve.Filter->SmoothBoundaryOn();
  const auto mask = carve.CopyMask();
  vtkNew<vtkFloatArray> before;
  before->DeepCopy(GetDistances(carve.Filter->GetOutput()));
  EXPECT_EQ(before->GetNumberOfTuples(), volume->GetNumberOfPoints());

  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.25, 0, 0));
  for (const int components : { 1, 2 })
  {
    auto wrong = MakeVolume(CarvedBox);
    wrong->GetPointData()->AddArray(
      MakeArray<vtkShortArray>(NAME, components == 1 ? 7 : wrong->GetNumberOfPoints(), components));
    carve.Filter->SetInputData(wrong);
    carve.Fails("\"BoundaryDistance\"");
    filterTesting::Deformed deformed(wrong, mesh);
    deformed.VerifyFailure("\"BoundaryDistance\"");
  }
  carve.Filter->SetInputData(volume);
  EXPECT_EQ(carve.CopyMask(), mask);
  EXPECT_TRUE(HaveEqualBits(GetDistances(carve.Filter->GetOutput()), before));

  filterTesting::Deformed deformed;
  deformed.Filter->SetInputConnection(carve.Filter->GetOutputPort());
  deformed.Filter->SetDeformationData(mesh);
  deformed.Update();
  // The output of the deformation filter has no array of distances.
  EXPECT_EQ(GetDistances(deformed.Filter->GetOutput()), nullptr);
}

// BoundaryDistance may have any numeric type. A NaN is not a boundary.
TEST(SmoothBoundary, Types)
{
  auto volume = MakeVolume(CarvedBox);
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.3, 0.2, -0.4));
  vtkNew<vtkFloatArray> floats;
  vtkNew<vtkDoubleArray> doubles;
  for (vtkDataArray* array :
    { static_cast<vtkDataArray*>(floats), static_cast<vtkDataArray*>(doubles) })
  {
    array->SetName(NAME);
    array->SetNumberOfTuples(volume->GetNumberOfPoints());
    for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
    {
      const glm::dvec3 p = GetPoint(volume, id);
      const double distance = 0.25 * std::floor(8.0 * std::sin(p.x + 2.0 * p.y) + p.z);
      array->SetComponent(
        id, 0, id % 50 == 0 ? std::numeric_limits<double>::quiet_NaN() : distance);
    }
  }
  vtkNew<vtkImageData> other;
  other->ShallowCopy(volume);
  volume->GetPointData()->AddArray(floats);
  other->GetPointData()->AddArray(doubles);
  filterTesting::Deformed first(volume, mesh);
  filterTesting::Deformed second(other, mesh);
  EXPECT_TRUE(AreEqual(first.Update(), second.Update()));
  EXPECT_LT(first.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
  EXPECT_GT(first.Filter->GetNumberOfCoveredVoxels(), 0);
  // A change with a log and one without a log give the same result.
  floats->SetValue(333, -2.0F);
  floats->Modified();
  doubles->SetValue(333, -2.0);
  doubles->Modified();
  EXPECT_TRUE(AreEqual(first.Update(), second.Update()));
}

// The volume of a sphere of a radius of 20 voxels is right to 0.1 %, for any center and any
// direction of the volume.
TEST(SmoothBoundary, VolumeOfSphere)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> anywhere(-0.5, 0.5);
  for (int geometry = 0; geometry < 3; ++geometry)
  {
    auto volume = MakeVolume({ { 0, 46, 1, 47, -1, 45 } });
    if (geometry > 0)
    {
      volume->SetOrigin(3.0, -90.0, 12.0);
      volume->SetSpacing(0.5, 0.5, 0.5);
    }
    if (geometry == 2)
    {
      SetObliqueDirection(volume);
    }
    double center[3];
    volume->GetCenter(center);
    for (double& component : center)
    {
      component += anywhere(random) * volume->GetSpacing()[0];
    }
    const double radius = 20.0 * volume->GetSpacing()[0];
    const double expected = 4.0 / 3.0 * Pi * radius * radius * radius;
    vtkNew<vtkSphere> sphere;
    sphere->SetCenter(center);
    sphere->SetRadius(radius);
    Edited<vtkCarveVolume> carve;
    carve.Filter->SetInputData(volume);
    carve.Filter->SmoothBoundaryOn();
    carve.Filter->SetImplicitFunction(sphere);
    Fine fine(volume, carve.Filter->GetOutputPort(), 3);
    const double byFunction = fine.GetMissing();
    std::cout << "sphere by function: " << byFunction / expected - 1.0 << "\n";
    EXPECT_LT(std::abs(byFunction - expected), 0.001 * expected);

    // The same sphere by a tool, and as a surface, whose facets are slightly inside the sphere.
    carve.Filter->SetImplicitFunction(nullptr);
    carve.Filter->SetToolRadius(radius);
    carve.Filter->AddToolPosition(center[0], center[1], center[2]);
    const double byTool = fine.GetMissing();
    EXPECT_LT(std::abs(byTool - expected), 0.001 * expected);
    carve.Filter->Undo();
    vtkNew<vtkSphereSource> surface;
    surface->SetCenter(center);
    surface->SetRadius(radius);
    surface->SetThetaResolution(240);
    surface->SetPhiResolution(120);
    carve.Filter->SetSurfaceConnection(surface->GetOutputPort());
    const double bySurface = fine.GetMissing();
    std::cout << "sphere by surface: " << bySurface / expected - 1.0 << "\n";
    EXPECT_LT(std::abs(bySurface - expected), 0.002 * expected);
  }
}

// Each sample of the output is covered if it is on the right side of a plane.
TEST(SmoothBoundary, Plane)
{
  for (const bool isOblique : { false, true })
  {
    auto volume = MakeVolume(CarvedBox);
    if (isOblique)
    {
      volume->SetOrigin(3.0, -90.0, 12.0);
      volume->SetSpacing(0.5, 0.5, 0.25);
      SetObliqueDirection(volume);
    }
    glm::dvec3 center;
    volume->GetCenter(&center.x);
    vtkNew<vtkPlane> plane;
    Edited<vtkCarveVolume> carve;
    carve.Filter->SetInputData(volume);
    carve.Filter->SmoothBoundaryOn();
    Fine fine(volume, carve.Filter->GetOutputPort(), 4);
    const auto check =
      [&](vtkImplicitFunction* function, const glm::dvec3& origin, const glm::dvec3& normal)
    {
      plane->SetOrigin(origin.x, origin.y, origin.z);
      plane->SetNormal(normal.x, normal.y, normal.z);
      carve.Filter->SetImplicitFunction(function);
      vtkImageData* image = fine.Deformed.Update();
      int wrong = 0;
      for (vtkIdType id = 0; id < image->GetNumberOfPoints(); ++id)
      {
        const double side = glm::dot(GetPoint(image, id) - origin, normal);
        wrong += std::abs(side) > 1e-5 && fine.Deformed.IsCovered(id) != (side > 0.0) ? 1 : 0;
      }
      EXPECT_EQ(wrong, 0);
    };
    check(plane, center + glm::dvec3(0.3, 0, 0), glm::dvec3(1, 0, 0));
    check(plane, center + glm::dvec3(0.1, -0.3, 0.2), glm::dvec3(0.48, 0.6, 0.64));
    // A plane inside another function, for which the filter knows neither bounds nor linearity.
    vtkNew<vtkImplicitBoolean> wrapped;
    wrapped->AddFunction(plane);
    check(wrapped, center + glm::dvec3(0.1, -0.3, 0.2), glm::dvec3(0.48, 0.6, 0.64));
  }
}

// Labels end halfway between voxels.
TEST(SmoothBoundary, Labels)
{
  auto volume = MakeVolume(CarvedBox);
  AddLabels(volume);
  Edited<vtkCarveVolume> carve;
  carve.Filter->SetInputData(volume);
  carve.Filter->SetLabelArrayName("label");
  carve.Filter->SetLabel(7);
  carve.Filter->SmoothBoundaryOn();
  EXPECT_EQ(carve.CountOff(), 5 * 8 * 13 * 14);
  Fine fine(volume, carve.Filter->GetOutputPort(), 4);
  vtkImageData* image = fine.Deformed.Update();
  int wrong = 0;
  for (vtkIdType id = 0; id < image->GetNumberOfPoints(); ++id)
  {
    wrong += fine.Deformed.IsCovered(id) != (GetPoint(image, id).x <= 5.5) ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0);
}

// In a chain of filters each voxel has the least distance.
TEST(SmoothBoundary, Chains)
{
  auto volume = MakeVolume(CarvedBox);
  const auto copy = [&](vtkAlgorithm* filter)
  {
    filter->Update();
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->DeepCopy(filter->GetOutputDataObject(0));
    return image;
  };
  Edited<vtkCarveVolume> carve;
  carve.Filter->SetInputData(volume);
  carve.Filter->SmoothBoundaryOn();
  // Two filters one after another, compared with one filter that carves both bodies.
  vtkNew<vtkSphere> first;
  first->SetCenter(4, 5, 6);
  first->SetRadius(3.4);
  vtkNew<vtkSphere> second;
  second->SetCenter(8.2, 6, 7);
  second->SetRadius(2.9);
  carve.Filter->SetImplicitFunction(first);
  Edited<vtkCarveVolume> next;
  next.Filter->SetInputConnection(carve.Filter->GetOutputPort());
  next.Filter->SmoothBoundaryOn();
  next.Filter->SetImplicitFunction(second);
  Edited<vtkCarveVolume> both;
  both.Filter->SetInputData(volume);
  both.Filter->SmoothBoundaryOn();
  both.Filter->AccumulateOn();
  both.Filter->SetImplicitFunction(first);
  both.Update();
  both.Filter->SetImplicitFunction(second);
  both.Update();
  EXPECT_TRUE(AreEqual(copy(next.Filter), both.Filter->GetOutput()));
  const auto joined = copy(next.Filter);
  // A cut between the two filters does not change the distances.
  Edited<vtkCutVolume> cut;
  cut.Filter->SetInputConnection(carve.Filter->GetOutputPort());
  cut.Filter->SetSheetData(MakePlaneX(volume, 12.5));
  next.Filter->SetInputConnection(cut.Filter->GetOutputPort());
  next.Update();
  EXPECT_EQ(GetDistances(cut.Filter->GetOutput()), GetDistances(carve.Filter->GetOutput()));
  EXPECT_TRUE(HaveEqualBits(GetDistances(next.Filter->GetOutput()), GetDistances(joined)));
  // A change of the first body does not change the second one.
  first->SetRadius(2.0);
  next.Update();
  first->SetRadius(3.4);
  next.Update();
  EXPECT_TRUE(HaveEqualBits(GetDistances(next.Filter->GetOutput()), GetDistances(joined)));
}

// With SamplingFactor, too, the volume has a hole.
TEST(SmoothBoundary, SamplingFactor)
{
  auto volume = MakeVolume({ { 0, 60, 0, 50, 0, 40 } });
  auto mesh = MakeMesh(volume, 4);
  SetDisplacements(mesh, Shift(0.3, 0.1, 0.7));
  Edited<vtkCarveVolume> carve;
  carve.Filter->SetInputData(volume);
  carve.Filter->SmoothBoundaryOn();
  carve.Filter->SetToolRadius(3.7);
  carve.Filter->AddToolPosition(30, 25, 20);
  filterTesting::Deformed deformed;
  deformed.Filter->SetInputConnection(carve.Filter->GetOutputPort());
  deformed.Filter->SetDeformationData(mesh);
  deformed.Filter->SetOutputBoundsModeToVolumeBounds();
  deformed.Filter->SetSamplingFactor(2);
  const auto count = [&]()
  {
    deformed.Update();
    return deformed.Filter->GetNumberOfCoveredVoxels();
  };
  const vtkIdType covered = count();
  deformed.Filter->SetInputData(volume);
  EXPECT_LT(covered, count());
}

} // namespace
