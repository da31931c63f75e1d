// SPDX-License-Identifier: BSD-3-Clause
// Additional arrays of the output: rest positions, Jacobians, fold counts, and densities, whose sum
// the deformation does not change.
#include "ArrayMaking.h"
#include "FilterTesting.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <vtkAppendFilter.h>
#include <vtkCellData.h>
#include <vtkShortArray.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

using namespace filterTesting;

namespace
{

// A volume with a blob that is 0 near the faces of the volume, as short and as double, and with a
// linear function.
vtkSmartPointer<vtkImageData> MakeDose(const Extent& extent = { { 0, 39, 0, 37, 0, 35 } },
  const glm::dvec3& spacing = glm::dvec3(1.0), bool isOblique = false)
{
  auto volume = MakeImage(extent, spacing, glm::dvec3(-7.0, 3.0, 11.0));
  if (isOblique)
  {
    SetObliqueDirection(volume);
  }
  double middle[3];
  volume->GetCenter(middle);
  const auto blob = [=](const glm::dvec3& p)
  {
    const glm::dvec3 r = (p - glm::dvec3(middle[0], middle[1], middle[2])) / 9.0;
    const double square = glm::dot(r, r);
    return square < 1.0 ? 20000.0 * (1.0 - square) * (1.0 - square) : 0.0;
  };
  AddScalars<short>(volume, "dose", blob);
  AddScalars<double>(volume, "activity", blob);
  AddScalars<float>(
    volume, "linear", [](const glm::dvec3& p) { return 0.3 * p.x - 0.7 * p.y + 1.1 * p.z; });
  return volume;
}

// factor: the name of an array by which values are multiplied, or null.
double Sum(vtkImageData* image, const char* name, const char* factor = nullptr)
{
  vtkDataArray* array = image->GetPointData()->GetArray(name);
  vtkDataArray* factors = factor ? image->GetPointData()->GetArray(factor) : nullptr;
  double sum = 0.0;
  for (vtkIdType id = 0; id < array->GetNumberOfTuples(); ++id)
  {
    sum += array->GetComponent(id, 0) * (factors ? factors->GetComponent(id, 0) : 1.0);
  }
  const double* spacing = image->GetSpacing();
  return sum * std::abs(spacing[0] * spacing[1] * spacing[2]);
}

struct Derived : Deformed
{
  Derived(vtkDataObject* volume, vtkDataObject* deformation)
    : Deformed(volume, deformation)
  {
    this->Filter->GenerateRestPositionsOn();
    this->Filter->GenerateJacobianOn();
    this->Filter->AddDensityArray("dose");
    this->Filter->AddDensityArray("activity");
  }
  vtkDataArray* Get(const char* name)
  {
    return this->Filter->GetOutput()->GetPointData()->GetArray(name);
  }
};

TEST(ExtraArrays, Misuse)
{
  const auto volume = MakeDose();
  const auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.5, 0.0, 0.0));
  Derived subject(volume, mesh);
  vtkDeformVolumeFilter* filter = subject.Filter;
  EXPECT_EQ(filter->GetNumberOfDensityArrays(), 2);
  EXPECT_EQ(std::string(filter->GetDensityArray(0)), "activity");
  EXPECT_TRUE(filter->GetDensityArray(2) == nullptr && filter->GetDensityArray(-1) == nullptr);
  const vtkMTimeType before = filter->GetMTime();
  filter->AddDensityArray(nullptr);
  filter->AddDensityArray("dose");
  filter->RemoveDensityArray("none");
  EXPECT_EQ(filter->GetMTime(), before);
  vtkNew<vtkImageData> expected;
  expected->DeepCopy(subject.Expect(""));
  filter->AddDensityArray("does");
  subject.VerifyFailure("\"does\" is not a numeric point array");
  filter->RemoveDensityArray("does");
  filter->AddCategoricalArray("dose");
  subject.VerifyFailure("\"dose\" is categorical");
  filter->ClearCategoricalArrays();
  filter->SetInterpolationToNearestInterpolation();
  subject.VerifyFailure("is categorical");
  filter->SetInterpolationToLinearInterpolation();
  filter->SetResamplerToMeshRasterization();
  subject.VerifyFailure("cannot do Jacobians of meshes");
  filter->SetResamplerToAutomatic();
  for (const char* name : { "Jacobian", "RestPosition", "RestPosition y" })
  {
    AddScalars<float>(volume, name, [](const glm::dvec3& p) { return p.x; });
    subject.VerifyFailure("has a point array \"" + std::string(name) + "\"");
    volume->GetPointData()->RemoveArray(name);
  }
  volume->GetPointData()->SetActiveScalars("linear");
  EXPECT_TRUE(AreEqual(subject.Expect(""), expected));
  filter->ClearDensityArrays();
  filter->GenerateJacobianOff();
  filter->GenerateRestPositionsOff();
  vtkImageData* output = subject.Expect("");
  EXPECT_EQ(output->GetPointData()->GetNumberOfArrays(), 4);
  EXPECT_EQ(output->GetPointData()->GetArray("dose")->GetDataType(), VTK_SHORT);
}

// Without displacements Jacobians are 1, rest positions are those of the output, and values do not
// change. Densities of integers are floats.
TEST(ExtraArrays, AtRest)
{
  const auto volume = MakeDose({ { -3, 20, 2, 18, 0, 16 } }, glm::dvec3(0.7, 1.1, 2.0), true);
  for (const bool hasMesh : { false, true })
  {
    const auto mesh = MakeMesh(volume);
    SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
    Derived subject(volume, hasMesh ? mesh : nullptr);
    vtkImageData* output = subject.Expect("");
    EXPECT_EQ(GetExtent(output), GetExtent(volume));
    EXPECT_EQ(subject.Get("dose")->GetDataType(), VTK_FLOAT);
    EXPECT_EQ(subject.Get("activity")->GetDataType(), VTK_DOUBLE);
    EXPECT_EQ(output->GetPointData()->GetScalars(), output->GetPointData()->GetArray("linear"));
    for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
    {
      const glm::dvec3 p = GetPoint(volume, id);
      for (int axis = 0; axis < 3; ++axis)
      {
        EXPECT_EQ(subject.Get("RestPosition")->GetComponent(id, axis),
          static_cast<double>(static_cast<float>(p[axis])));
      }
      EXPECT_EQ(subject.Get("Jacobian")->GetComponent(id, 0), 1.0);
      for (const char* name : { "dose", "activity", "linear" })
      {
        EXPECT_EQ(subject.Get(name)->GetComponent(id, 0),
          volume->GetPointData()->GetArray(name)->GetComponent(id, 0));
      }
    }
  }
}

// The exact results of an affine map, for all kinds of deformations and grids.
TEST(ExtraArrays, Affine)
{
  const glm::dmat3 matrix(1.2, 0.1, -0.05, -0.15, 0.85, 0.1, 0.05, -0.1, 1.1);
  const glm::dvec3 shift(1.5, -2.0, 0.75);
  const double determinant = glm::determinant(matrix);
  const glm::dmat3 inverse = glm::inverse(matrix);
  const auto map = [&](const glm::dvec3& p) { return matrix * p + shift; };
  const auto back = [&](const glm::dvec3& p) { return inverse * (p - shift); };
  for (const bool isOblique : { false, true })
  {
    const auto volume =
      MakeDose({ { 0, 29, -4, 22, 3, 27 } }, glm::dvec3(0.9, 1.1, 1.3), isOblique);
    // The mesh named tight ends inside the volume.
    const auto mesh = MakeMesh(volume, 4, 2.0);
    SetDisplacements(mesh, map);
    const auto tight = MakeMesh(volume, 5, -4.3);
    SetDisplacements(tight, map);
    const auto field = MakeImage({ { 0, 9, 0, 9, 0, 9 } }, glm::dvec3(9.0), glm::dvec3(-40.0));
    SetDisplacements(field, map);
    const auto backField = MakeImage({ { 0, 9, 0, 9, 0, 9 } }, glm::dvec3(9.0), glm::dvec3(-40.0));
    SetDisplacements(backField, back);
    const auto fixed = MakeImage(
      { { 0, 40, 0, 40, 0, 40 } }, glm::dvec3(-1.1, 1.3, 1.2), glm::dvec3(20.0, -20.0, 5.0));
    SetObliqueDirection(fixed);
    const std::vector<vtkDataSet*> deformations{ mesh, tight, field, backField };
    for (vtkDataSet* deformation : deformations)
    {
      for (const bool hasReference : { false, true })
      {
        Derived subject(volume, deformation);
        subject.Filter->SetFieldIsInverse(deformation == backField);
        subject.Filter->SetInterpolation(isOblique && !hasReference
            ? vtkDeformVolumeFilter::CUBIC_INTERPOLATION
            : vtkDeformVolumeFilter::LINEAR_INTERPOLATION);
        subject.Filter->SetReferenceData(hasReference ? fixed : nullptr);
        vtkImageData* output = subject.Expect("");
        vtkIdType covered = 0;
        double worst = 0.0;
        double farthest = 0.0;
        for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
        {
          if (!subject.IsCovered(id))
          {
            EXPECT_EQ(subject.Get("Jacobian")->GetComponent(id, 0), 0.0);
            continue;
          }
          ++covered;
          const double jacobian = subject.Get("Jacobian")->GetComponent(id, 0);
          worst = std::max(worst, std::abs(jacobian - determinant));
          glm::dvec3 rest;
          subject.Get("RestPosition")->GetTuple(id, &rest.x);
          farthest = std::max(farthest, glm::distance(rest, back(GetPoint(output, id))));
          // The values of this array are interpolated like the rest position.
          EXPECT_LT(std::abs(subject.Get("linear")->GetComponent(id, 0) -
                      (0.3 * rest.x - 0.7 * rest.y + 1.1 * rest.z)),
            1e-4);
        }
        EXPECT_GT(covered, 50);
        EXPECT_LT(worst, 1e-5 * determinant) << deformation->GetClassName();
        // Positions are rounded to 1/512 voxel of the output on each axis.
        EXPECT_LT(farthest, 1.3 * 1.8 / 256.0) << deformation->GetClassName();
      }
    }
  }
}

// Compresses the middle to no less than half of its volume, and stretches the region around it.
glm::dvec3 Press(const glm::dvec3& p, const glm::dvec3& middle)
{
  const glm::dvec3 r = p - middle;
  const double square = glm::dot(r, r) / 256.0;
  return square < 1.0 ? middle + r * (1.0 - 0.206 * (1.0 - square) * (1.0 - square)) : p;
}

// The sum of densities does not change, with meshes and fields, and for any grid of the output.
TEST(ExtraArrays, Sums)
{
  for (const bool isOblique : { false, true })
  {
    const auto volume =
      MakeDose({ { 0, 91, 0, 81, 0, 73 } }, glm::dvec3(0.45, 0.5, 0.55), isOblique);
    double center[3];
    volume->GetCenter(center);
    const glm::dvec3 middle(center[0], center[1], center[2]);
    const auto press = [&](const glm::dvec3& p) { return Press(p, middle); };
    const auto mesh = MakeMesh(volume, 15, 1.0);
    SetDisplacements(mesh, press);
    const auto field = MakeImage({ { 0, 23, 0, 23, 0, 23 } }, glm::dvec3(2.3), middle - 2.3 * 11.5);
    SetDisplacements(field, press);
    const auto voxels = MakeImage({ { 0, 0, 0, 0, 0, 0 } });
    voxels->CopyStructure(volume);
    SetDisplacements(voxels, press);
    const std::vector<vtkDataSet*> deformations{ mesh, field, voxels };
    for (vtkDataSet* deformation : deformations)
    {
      Derived subject(volume, deformation);
      subject.Filter->SetOutsideModeToExtrapolate();
      for (const double spacing : { 0.0, 0.7 })
      {
        subject.Filter->SetOutputSpacingMode(spacing > 0.0 ? vtkDeformVolumeFilter::CUSTOM_SPACING
                                                           : vtkDeformVolumeFilter::VOLUME_SPACING);
        subject.Filter->SetCustomSpacing(spacing, spacing, spacing);
        vtkImageData* output = subject.Expect("");
        for (const char* name : { "dose", "activity" })
        {
          const double sum = Sum(volume, name);
          const double ratio = Sum(output, name) / sum;
          EXPECT_LT(std::abs(ratio - 1.0), 0.005) << name << ", " << deformation->GetClassName();
          // Without the division by the Jacobian the sum changes.
          EXPECT_LT(Sum(output, name, "Jacobian"), 0.8 * sum);
        }
        double least = 2.0;
        for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
        {
          const double jacobian = subject.Get("Jacobian")->GetComponent(id, 0);
          least = subject.IsCovered(id) ? std::min(least, jacobian) : least;
        }
        EXPECT_TRUE(least > 0.49 && least < 0.6); // 0.5006 without linear interpolation of the map
      }
    }
  }
}

// Tissue that is kept outside a moving body is compressed on one side and stretched on the other:
// it has Jacobians, too.
TEST(ExtraArrays, Kept)
{
  const auto volume = MakeImage({ { 0, 49, 0, 39, 0, 35 } });
  AddScalars<float>(volume, "dose", [](const glm::dvec3&) { return 2.0; });
  AddScalars<double>(volume, "activity", [](const glm::dvec3& p) { return 5.0 + 0.1 * p.x; });
  AddScalars<float>(volume, "linear", [](const glm::dvec3& p) { return p.y; });
  const auto mesh = MakeTetrahedra({ { 18.2, 29.7, 15.1, 24.4, 13.3, 22.8 } }, { { 4, 4, 4 } });
  SetDisplacements(mesh, Shift(2.5, 0.0, 0.0));
  const auto field =
    MakeImage({ { 0, 1, 0, 1, 0, 1 } }, glm::dvec3(10.0), glm::dvec3(18.0, 15.0, 13.0));
  SetDisplacements(field, Shift(2.5, 0.0, 0.0));
  const std::vector<vtkDataSet*> deformations{ mesh, field };
  for (vtkDataSet* deformation : deformations)
  {
    Derived subject(volume, deformation);
    subject.Filter->SetOutsideModeToKeep();
    subject.Filter->SetFadeDistance(9.0);
    vtkImageData* output = subject.Expect("");
    EXPECT_EQ(subject.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
    for (const char* name : { "dose", "activity" })
    {
      EXPECT_LT(std::abs(Sum(output, name) / Sum(volume, name) - 1.0), 0.005);
    }
    double range[2];
    subject.Get("Jacobian")->GetRange(range);
    // The largest slope of the fading displacement is 1.5 times 2.5 / 9.
    EXPECT_TRUE(range[0] > 0.55 && range[0] < 0.62 && range[1] > 1.38 && range[1] < 1.45);
    // The Jacobian is 1 inside the body, and far away from it.
    int inside[3] = { 26, 20, 18 };
    int far[3] = { 2, 3, 33 };
    for (int* index : { inside, far })
    {
      EXPECT_EQ(subject.Get("Jacobian")->GetComponent(output->ComputePointId(index), 0), 1.0);
    }
  }
}

// Layers of a mesh, four voxels thick, that are pressed to a twentieth between rigid layers:
// densities keep their sum, although the Jacobian changes from voxel to voxel.
TEST(ExtraArrays, CrushedLayers)
{
  const auto volume = MakeImage({ { 0, 32, 0, 4, 0, 4 } });
  AddScalars<float>(volume, "dose", [](const glm::dvec3&) { return 2.0; });
  AddScalars<double>(volume, "activity", [](const glm::dvec3& p) { return 5.0 + 0.1 * p.x; });
  AddScalars<float>(volume, "linear", [](const glm::dvec3& p) { return p.y; });
  for (const double offset : { 0.0, 0.5 })
  {
    const auto mesh =
      MakeTetrahedra({ { -4.0 + offset, 36.0 + offset, -1.0, 5.0, -1.0, 5.0 } }, { { 11, 2, 2 } });
    SetDisplacements(mesh,
      [&](const glm::dvec3& p)
      {
        const auto layer = std::lround((p.x - offset + 4.0) / 4.0);
        return glm::dvec3(0.2 * ((layer + 1) / 2) + 4.0 * (layer / 2), p.y, p.z);
      });
    Derived subject(volume, mesh);
    subject.Filter->SetOutputSpacingModeToCustomSpacing();
    subject.Filter->SetCustomSpacing(0.01, 1.0, 1.0);
    vtkImageData* output = subject.Expect("");
    // At rest the voxels at the two ends count by half.
    for (const auto& [name, sum] :
      { std::pair<const char*, double>("dose", 25 * 64.0), { "activity", 25 * 32 * 6.6 } })
    {
      EXPECT_LT(std::abs(Sum(output, name) / sum - 1.0), 0.005) << name << ", " << offset;
    }
  }
}

// Two sides of a cut or of a split mesh move apart without deformation: Jacobians and densities are
// those at rest.
TEST(ExtraArrays, BesideCuts)
{
  const auto move = [](const glm::dvec3& p)
  { return p + glm::dvec3(p.x > 9.55 ? 3.0 : 0.0, 0.0, 0.0); };
  const auto field = MakeImage({ { 0, 19, 0, 9, 0, 9 } });
  SetDisplacements(field, move);
  const auto right = MakeTetrahedra({ { 9.6, 30.0, -2.0, 12.0, -2.0, 12.0 } }, { { 2, 2, 2 } });
  SetDisplacements(right, move);
  const auto left = MakeTetrahedra({ { -10.0, 9.6, -2.0, 12.0, -2.0, 12.0 } }, { { 2, 2, 2 } });
  SetDisplacements(left, [](const glm::dvec3& p) { return p; });
  vtkNew<vtkAppendFilter> both;
  both->AddInputData(left);
  both->AddInputData(right);
  both->Update();
  const std::vector<vtkDataObject*> deformations{ field, right, both->GetOutput() };
  for (vtkDataObject* deformation : deformations)
  {
    const auto volume = MakeImage({ { 0, 19, 0, 9, 0, 9 } });
    AddScalars<float>(volume, "dose", [](const glm::dvec3&) { return 2.0; });
    AddScalars<double>(volume, "activity", [](const glm::dvec3&) { return 5.0; });
    AddScalars<float>(volume, "linear", [](const glm::dvec3& p) { return p.y; });
    const auto active = AddActiveTetrahedra(volume);
    const bool isSplit = deformation == both->GetOutput();
    for (vtkIdType cell = 9; cell < active->GetNumberOfTuples() && !isSplit; cell += 19)
    {
      active->SetValue(cell, 0); // between x = 9 and x = 10
    }
    Derived subject(volume, deformation);
    subject.Filter->SetOpenSplits(isSplit);
    subject.Filter->SetOutsideMode(
      deformation == right ? vtkDeformVolumeFilter::KEEP : vtkDeformVolumeFilter::DISCARD);
    vtkImageData* output = subject.Update();
    EXPECT_EQ(subject.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
    for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
    {
      if (subject.IsCovered(id))
      {
        EXPECT_NEAR(subject.Get("Jacobian")->GetComponent(id, 0), 1.0, 1e-6);
        EXPECT_NEAR(subject.Get("dose")->GetComponent(id, 0), 2.0, 1e-5);
        EXPECT_NEAR(subject.Get("activity")->GetComponent(id, 0), 5.0, 1e-5);
      }
    }
  }
}

// Beyond a field in z, at the border of field and volume in x: the Jacobian is that of the map.
TEST(ExtraArrays, BesideThinFields)
{
  const auto volume = MakeImage({ { 0, 11, 0, 11, 0, 11 } });
  AddScalars<float>(volume, "dose", [](const glm::dvec3&) { return 2.0; });
  AddScalars<double>(volume, "activity", [](const glm::dvec3& p) { return 5.0 + 0.1 * p.x; });
  // With a third array the kernels are those of the other tests.
  AddScalars<float>(volume, "linear", [](const glm::dvec3& p) { return p.y; });
  for (const bool isInverse : { false, true })
  {
    const int last = isInverse ? 17 : 11;
    const double factor = isInverse ? 1.0 / 1.5 : 1.5;
    const auto field = MakeImage({ { 0, last, 0, 11, 5, 5 } });
    SetDisplacements(
      field, [&](const glm::dvec3& p) { return glm::dvec3(factor * p.x, p.y, p.z); });
    Derived subject(volume, field);
    subject.Filter->SetFieldIsInverse(isInverse);
    subject.Filter->SetOutsideModeToExtrapolate();
    subject.Expect("");
    double range[2];
    subject.Get("Jacobian")->GetRange(range);
    EXPECT_NEAR(range[0], 1.5, 1e-5);
    EXPECT_NEAR(range[1], 1.5, 1e-5);
  }
}

// Near undefined points of a field the Jacobian is computed from the defined points only.
TEST(ExtraArrays, Holes)
{
  const glm::dmat3 matrix(1.2, 0.1, -0.05, -0.15, 0.85, 0.1, 0.05, -0.1, 1.1);
  const auto map = [&](const glm::dvec3& p) { return matrix * p + glm::dvec3(3.0, -2.0, 1.0); };
  const auto back = [&](const glm::dvec3& p)
  { return glm::inverse(matrix) * (p - glm::dvec3(3.0, -2.0, 1.0)); };
  const auto volume = MakeDose({ { 0, 23, 0, 21, 0, 19 } });
  for (const double spacing : { 1.0, 2.5 })
  {
    for (const bool isInverse : { false, true })
    {
      const auto field = MakeImage({ { 0, 40, 0, 40, 0, 40 } }, glm::dvec3(spacing),
        glm::dvec3(-7.0, 3.0, 11.0) - 5.0 * spacing);
      if (isInverse)
      {
        SetDisplacements(field, back);
      }
      else
      {
        SetDisplacements(field, map);
      }
      const auto ghosts = MakeArray<vtkUnsignedCharArray>(
        vtkDataSetAttributes::GhostArrayName(), field->GetNumberOfPoints());
      Derived subject(volume, field);
      subject.Filter->SetFieldIsInverse(isInverse);
      subject.Expect("");
      const std::int64_t covered = subject.Filter->GetNumberOfCoveredVoxels();
      // Hide three points in a row, and both neighbors of another point. Set their vectors to zero.
      for (const int z : { 8, 9, 10, 12, 14 })
      {
        int hidden[3] = { 10, 9, z };
        const vtkIdType id = field->ComputePointId(hidden);
        field->GetPointData()->GetVectors()->SetTuple3(id, 0.0, 0.0, 0.0);
        ghosts->SetValue(id, vtkDataSetAttributes::HIDDENPOINT);
      }
      field->GetPointData()->GetVectors()->Modified();
      field->GetPointData()->AddArray(ghosts);
      field->Modified();
      vtkImageData* output = subject.Expect("");
      EXPECT_LT(subject.Filter->GetNumberOfCoveredVoxels(), covered);
      for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
      {
        const double jacobian = subject.Get("Jacobian")->GetComponent(id, 0);
        const double difference = std::abs(jacobian - glm::determinant(matrix));
        EXPECT_TRUE(!subject.IsCovered(id) || difference < 1e-5);
      }
    }
  }
}

// A fold causes one warning with the lost density. Inverted tetrahedra have no density.
TEST(ExtraArrays, Folds)
{
  const auto volume = MakeDose();
  const auto active = AddActiveTetrahedra(volume);
  const auto mesh = MakeMesh(volume, 9, 0.5);
  double center[3];
  volume->GetCenter(center);
  SetDisplacements(mesh,
    [&](const glm::dvec3& p)
    {
      const double r = (p.x - center[0]) / 10.0;
      return p -
        glm::dvec3(std::abs(r) < 1.0 ? 30.0 * r * (1.0 - r * r) * (1.0 - r * r) : 0.0, 0.0, 0.0);
    });
  Derived subject(volume, mesh);
  subject.Filter->SetBackgroundValue(-3.0);
  vtkImageData* output =
    subject.Expect("folds the volume over. The sums of density arrays lack the ");
  EXPECT_GT(subject.Filter->GetNumberOfInvertedTetrahedra(), 1000);
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    const double jacobian = subject.Get("Jacobian")->GetComponent(id, 0);
    EXPECT_TRUE(jacobian > 0.0 || subject.Get("dose")->GetComponent(id, 0) == 0.0);
  }
  // Tetrahedra that are not inverted win, and the density of inverted ones is lost.
  EXPECT_LT(Sum(output, "activity"), 0.95 * Sum(volume, "activity"));
  // If the tetrahedra that are not inverted are switched off, inverted ones are visible. Their
  // density is 0, as that of voxels that are not covered. Other arrays have BackgroundValue there,
  // limited to the range of the type.
  for (vtkIdType id = 0; id < active->GetNumberOfTuples(); ++id)
  {
    const vtkIdType x = id % 39;
    const bool isUpright = x < 14 || x > 24; // not inverted
    active->SetValue(id, isUpright && id / 39 % 37 < 12 ? 0 : 31);
  }
  active->Modified();
  subject.Filter->SetBackgroundValue(1e300);
  output = subject.Expect("density arrays have 0 there.");
  vtkIdType lost = 0;
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    const double jacobian = subject.Get("Jacobian")->GetComponent(id, 0);
    const bool isLost = subject.IsCovered(id) && !(jacobian > 0.0);
    lost += isLost ? 1 : 0;
    if (isLost || !subject.IsCovered(id))
    {
      EXPECT_EQ(subject.Get("dose")->GetComponent(id, 0), 0.0);
      EXPECT_EQ(subject.Get("activity")->GetComponent(id, 0), 0.0);
    }
    EXPECT_TRUE(subject.IsCovered(id) ||
      subject.Get("linear")->GetComponent(id, 0) == std::numeric_limits<float>::max());
  }
  EXPECT_GT(lost, 500);
  // There is no other warning if the lost density changes only slightly.
  active->SetValue(0, 0);
  active->Modified();
  subject.Expect("");
  subject.Filter->SetPadding(1);
  subject.Expect("");
  SetDisplacements(mesh, Shift(1.0, 0.0, 0.0));
  subject.Expect("");
}

// SetArray() replaces the values of an array without changing its modification time.
TEST(ExtraArrays, ReplacedValues)
{
  const auto volume = MakeDose();
  const auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
  Derived subject(volume, mesh);
  subject.Expect("");
  auto* dose = vtkShortArray::SafeDownCast(volume->GetPointData()->GetArray("dose"));
  std::vector<short> sevens(static_cast<std::size_t>(dose->GetNumberOfTuples()), 7);
  dose->SetArray(sevens.data(), dose->GetNumberOfTuples(), 1);
  subject.Filter->Modified();
  subject.Expect("");
  EXPECT_EQ(subject.Get("dose")->GetRange(0)[0], 7.0);
}

// In a mirrored volume all tetrahedra are inverted, but none overlap.
TEST(ExtraArrays, Mirrored)
{
  const auto volume = MakeDose();
  const auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, [](const glm::dvec3& p) { return glm::dvec3(-p.x, p.y, p.z); });
  Derived subject(volume, mesh);
  subject.Filter->Update();
  const std::string warning = subject.TakeWarning();
  EXPECT_TRUE(HasPart(warning, "voxels show the volume inside out"));
  EXPECT_FALSE(HasPart(warning, "folds"));
  double range[2];
  subject.Get("Jacobian")->GetRange(range);
  EXPECT_LT(std::abs(range[0] + 1.0), 1e-5);
}

// Fold counts of a map that folds along x. The reference counts the intervals between voxels whose
// images contain a sample.
TEST(ExtraArrays, FoldCounts)
{
  auto volume = MakeVolume({ { 0, 60, 0, 12, 0, 11 } });
  volume->SetOrigin(-7.0, 3.0, 11.0);
  const auto map = [](double x)
  {
    const double r = (x - 23.0) / 15.0;
    return x - (std::abs(r) < 1.0 ? 30.0 * r * (1.0 - r * r) * (1.0 - r * r) : 0.0);
  };
  // The field has points at voxels, so it is linear between voxels like the deformed volume.
  const auto field = MakeImage({ { 0, 60, 0, 12, 0, 11 } });
  field->CopyStructure(volume);
  SetDisplacements(field, [&](const glm::dvec3& p) { return glm::dvec3(map(p.x), p.y, p.z); });
  // A mesh with the same displacements, whose nodes are between voxels.
  const auto mesh = MakeTetrahedra({ { -7.5, 53.5, 2.0, 16.0, 10.0, 23.0 } }, { { 62, 2, 2 } });
  SetDisplacements(mesh, [&](const glm::dvec3& p) { return glm::dvec3(map(p.x), p.y, p.z); });
  for (const bool isCubic : { false, true })
  {
    Deformed subject(volume, field);
    subject.Filter->GenerateFoldCountOn();
    subject.Filter->SetInterpolation(isCubic ? vtkDeformVolumeFilter::CUBIC_INTERPOLATION
                                             : vtkDeformVolumeFilter::LINEAR_INTERPOLATION);
    for (int repeat = 0; repeat < 2; ++repeat)
    {
      vtkImageData* output = subject.Update();
      vtkDataArray* counts = output->GetPointData()->GetArray("FoldCount");
      EXPECT_EQ(counts->GetDataType(), VTK_UNSIGNED_INT);
      vtkIdType folded = 0;
      vtkIdType hidden = 0;
      for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
      {
        const double x = GetPoint(output, id).x;
        int expected = 0;
        bool isClear = true;
        for (int i = 0; i < 60; ++i)
        {
          const double a = std::round((map(-7.0 + i) + 7.0) * 256.0) / 256.0 - 7.0;
          const double b = std::round((map(-6.0 + i) + 7.0) * 256.0) / 256.0 - 7.0;
          expected += x > std::min(a, b) && x < std::max(a, b);
          isClear = isClear && std::abs(x - a) > 1.0 / 128.0 && std::abs(x - b) > 1.0 / 128.0;
        }
        EXPECT_EQ(counts->GetComponent(id, 0) > 0.0, subject.IsCovered(id));
        hidden += static_cast<vtkIdType>(std::max(counts->GetComponent(id, 0) - 1.0, 0.0));
        if (isClear)
        {
          EXPECT_EQ(counts->GetComponent(id, 0), static_cast<double>(expected));
          folded += expected == 3;
        }
      }
      EXPECT_GT(folded, 500);
      EXPECT_EQ(subject.Filter->GetNumberOfHiddenVoxels(), hidden);
      // A change of a vector, for another update.
      vtkDataArray* vectors = field->GetPointData()->GetVectors();
      vectors->SetTuple3(0, 0.0, 0.0, 0.0);
      vectors->Modified();
    }
    // Fold counts of pieces are equal to those of the whole output.
    vtkNew<vtkImageData> whole;
    whole->DeepCopy(subject.Filter->GetOutput());
    VerifyPieces(subject, 3, whole);
  }
  Deformed subject(volume, mesh);
  subject.Filter->GenerateFoldCountOn();
  vtkImageData* output = subject.Update();
  double range[2];
  output->GetPointData()->GetArray("FoldCount")->GetRange(range);
  EXPECT_TRUE(range[0] <= 1.0 && range[1] == 3.0);
  subject.Filter->SetResamplerToMeshRasterization();
  subject.VerifyFailure("fold counts");
  // Without a fold the count is 1.
  subject.Filter->SetResamplerToAutomatic();
  SetDisplacements(mesh, Shift(1.0, 0.0, 0.0));
  subject.Update()->GetPointData()->GetArray("FoldCount")->GetRange(range);
  EXPECT_EQ(range[1], 1.0);
}

} // namespace
