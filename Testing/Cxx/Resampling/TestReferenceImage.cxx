// SPDX-License-Identifier: BSD-3-Clause
// Outputs on the grid of a reference image, as registration needs them. The reference values are
// those of a linear function of the world position under an affine map.
#include "FilterTesting.h"

#include "../../Sources.h"

#include <vtkPolyData.h>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

using namespace filterTesting;

namespace
{

const glm::dmat3 Matrix(1.1, 0.2, -0.1, -0.3, 0.9, 0.15, 0.1, -0.2, 1.2);
const glm::dvec3 Offset(1.5, -0.7, 0.4);
const glm::dvec3 Gradient(3.0, -2.0, 1.5);

glm::dvec3 Move(const glm::dvec3& point)
{
  return Matrix * point + Offset;
}
glm::dvec3 MoveBack(const glm::dvec3& point)
{
  return glm::inverse(Matrix) * (point - Offset);
}
double GetValue(const glm::dvec3& rest)
{
  return glm::dot(Gradient, rest) + 7.0;
}

vtkSmartPointer<vtkImageData> MakeOblique()
{
  auto volume =
    MakeImage({ { -7, 8, 3, 17, -20, -8 } }, glm::dvec3(0.7, 1.3, 1.1), glm::dvec3(4.0, -5.0, 2.5));
  SetObliqueDirection(volume);
  AddScalars<short>(volume, "kernels", GetValue); // with it the kernels are those of other tests
  AddScalars<float>(volume, "value", GetValue);
  return volume;
}

/// A reference image around the moved volume, with another direction. isMirrored: its axes are
/// left-handed.
vtkSmartPointer<vtkImageData> MakeReference(vtkImageData* volume, bool isMirrored)
{
  const double z = isMirrored ? -1.0 : 1.0;
  auto reference = MakeImage({ { 5, 34, -2, 33, 10, 41 } }, glm::dvec3(0.9, 0.8, 1.1));
  const double direction[9] = { 0.36, 0.48, -0.8 * z, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6 * z };
  reference->SetDirectionMatrix(direction);
  double middle[3];
  volume->GetCenter(middle);
  const glm::dvec3 wanted = Move(glm::dvec3(middle[0], middle[1], middle[2]));
  double is[3];
  reference->GetCenter(is);
  reference->SetOrigin(wanted.x - is[0], wanted.y - is[1], wanted.z - is[2]);
  return reference;
}

bool HasGridOf(vtkImageData* image, vtkImageData* reference)
{
  return GetExtent(image) == GetExtent(reference) &&
    std::equal(image->GetOrigin(), image->GetOrigin() + 3, reference->GetOrigin()) &&
    std::equal(image->GetSpacing(), image->GetSpacing() + 3, reference->GetSpacing()) &&
    std::equal(image->GetDirectionMatrix()->GetData(), image->GetDirectionMatrix()->GetData() + 9,
      reference->GetDirectionMatrix()->GetData());
}

/// Checks that values have an error of at most the slope times 3 x 2^-9 output voxels, and that
/// coverage is right, except near the surface of the volume.
void CheckValues(Deformed& deformed, vtkImageData* volume, vtkImageData* reference)
{
  vtkImageData* output = deformed.Update();
  EXPECT_TRUE(HasGridOf(output, reference));
  EXPECT_EQ(deformed.Filter->GetNumberOfInvertedTetrahedra(), 0);
  const double tolerance = glm::length(Gradient * glm::inverse(Matrix)) * 1.1 * 3.0 / 512.0 + 1e-9;
  const Extent extent = GetExtent(volume);
  int wrong = 0;
  int covered = 0;
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 rest = MoveBack(GetPoint(output, id));
    glm::dvec3 index;
    volume->TransformPhysicalPointToContinuousIndex(&rest.x, &index.x);
    double inside = 1e9;
    for (int axis = 0; axis < 3; ++axis)
    {
      inside =
        std::min({ inside, index[axis] - extent[2 * axis], extent[2 * axis + 1] - index[axis] });
    }
    const bool isCovered = deformed.IsCovered(id);
    const double value = deformed.GetValues()->GetComponent(id, 0);
    covered += isCovered ? 1 : 0;
    wrong += (inside > 0.05 && !isCovered) || (inside < -0.05 && isCovered) ? 1 : 0;
    wrong += isCovered && !(std::abs(value - GetValue(rest)) <= tolerance) ? 1 : 0;
    wrong += !isCovered && value != -1000.0 ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(covered, 2000);
  EXPECT_LT(covered, output->GetNumberOfPoints());
  EXPECT_EQ(static_cast<vtkIdType>(covered), deformed.Filter->GetNumberOfCoveredVoxels());
}

/// A filter with a reference image.
struct OnReference : Deformed
{
  OnReference(vtkDataObject* volume, vtkDataObject* deformation, vtkImageData* reference)
    : Deformed(volume, deformation)
  {
    this->Filter->SetReferenceData(reference);
    this->Filter->SetBackgroundValue(-1000.0);
  }
};

vtkSmartPointer<vtkUnstructuredGrid> MakeMoved(vtkImageData* volume, int nodes = 4)
{
  auto mesh = MakeMesh(volume, nodes);
  SetDisplacements(mesh, Move);
  return mesh;
}

/// An inverse or forward field of the map.
vtkSmartPointer<vtkImageData> MakeField(vtkImageData* volume, bool isInverse)
{
  double bounds[6];
  volume->GetBounds(bounds);
  auto field = MakeImage({ { 0, 12, 0, 12, 0, 12 } });
  // The field contains the volume at rest and the moved volume.
  field->SetOrigin(bounds[0] - 15.0, bounds[2] - 15.0, bounds[4] - 15.0);
  field->SetSpacing((bounds[1] - bounds[0] + 30.0) / 12.0, (bounds[3] - bounds[2] + 30.0) / 12.0,
    (bounds[5] - bounds[4] + 30.0) / 12.0);
  SetDisplacements(field, isInverse ? MoveBack : Move);
  return field;
}

TEST(ReferenceImage, OwnGrid)
{
  auto volume = MakeOblique();
  auto mesh = MakeMesh(volume, 4);
  SetDisplacements(mesh,
    [](const glm::dvec3& p)
    { return p + glm::dvec3(0.6 * std::sin(0.4 * p.y), 0.5 * std::cos(0.5 * p.z), 0.3); });
  auto field = MakeField(volume, true);
  for (const bool isInverse : { false, true })
  {
    Deformed plain(volume, isInverse ? static_cast<vtkDataObject*>(field) : mesh);
    plain.Filter->SetFieldIsInverse(isInverse);
    plain.Filter->SetBackgroundValue(-1000.0);
    vtkImageData* expected = plain.Update();
    vtkNew<vtkImageData> reference;
    reference->CopyStructure(expected);
    OnReference same(volume, isInverse ? static_cast<vtkDataObject*>(field) : mesh, reference);
    same.Filter->SetFieldIsInverse(isInverse);
    EXPECT_TRUE(AreEqual(same.Update(), expected));
    EXPECT_TRUE(HasGridOf(same.Filter->GetOutput(), reference));
    EXPECT_EQ(same.TakeWarning(), "");
    // Without a reference image the output is the same.
    same.Filter->SetInputConnection(3, nullptr);
    EXPECT_TRUE(AreEqual(same.Update(), expected));
  }
}

TEST(ReferenceImage, Rotated)
{
  auto volume = MakeOblique();
  for (const bool isMirrored : { false, true })
  {
    auto reference = MakeReference(volume, isMirrored);
    OnReference byMesh(volume, MakeMoved(volume), reference);
    CheckValues(byMesh, volume, reference);
    byMesh.Filter->SetResamplerToMeshRasterization();
    CheckValues(byMesh, volume, reference);
    OnReference byField(volume, MakeField(volume, false), reference);
    CheckValues(byField, volume, reference);
    OnReference byInverse(volume, MakeField(volume, true), reference);
    byInverse.Filter->FieldIsInverseOn();
    CheckValues(byInverse, volume, reference);
    // With SamplingFactor the output still has all voxels of the reference image. The values are
    // linear, so they do not change.
    auto even = MakeImage(
      { { -8, 8, 4, 18, -20, -8 } }, glm::dvec3(0.7, 1.3, 1.1), glm::dvec3(4.0, -5.0, 2.5));
    SetObliqueDirection(even);
    AddScalars<short>(even, "kernels", GetValue);
    AddScalars<float>(even, "value", GetValue);
    OnReference coarse(even, MakeMoved(even), reference);
    coarse.Filter->SetSamplingFactor(2);
    CheckValues(coarse, even, reference);
  }
}

// Without a deformation the volume at rest is resampled.
TEST(ReferenceImage, AtRest)
{
  auto volume = MakeOblique();
  for (const bool isMirrored : { false, true })
  {
    auto reference = MakeReference(volume, isMirrored);
    OnReference deformed(volume, nullptr, reference);
    vtkImageData* output = deformed.Update();
    EXPECT_TRUE(HasGridOf(output, reference));
    int wrong = 0;
    for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
    {
      const double value = deformed.GetValues()->GetComponent(id, 0);
      const double wanted = GetValue(GetPoint(output, id));
      wrong += deformed.IsCovered(id) &&
          !(std::abs(value - wanted) <= glm::length(Gradient) * 1.1 * 3.0 / 512.0)
        ? 1
        : 0;
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(deformed.Filter->GetNumberOfCoveredVoxels(), 2000);
    EXPECT_EQ(deformed.Filter->GetNumberOfInvertedTetrahedra(), 0);
  }
}

/// Filters with a mesh, with mesh rasterization, with a forward field and with an inverse field.
std::vector<std::pair<std::string, std::function<void(OnReference&)>>> GetWays(vtkImageData* volume)
{
  return { { "mesh",
             [=](OnReference& subject) { subject.Filter->SetDeformationData(MakeMoved(volume)); } },
    { "mesh rasterization",
      [=](OnReference& subject)
      {
        subject.Filter->SetDeformationData(MakeMoved(volume));
        subject.Filter->SetResamplerToMeshRasterization();
      } },
    { "field",
      [=](OnReference& subject) { subject.Filter->SetDeformationData(MakeField(volume, false)); } },
    { "inverse field",
      [=](OnReference& subject)
      {
        subject.Filter->SetDeformationData(MakeField(volume, true));
        subject.Filter->FieldIsInverseOn();
      } } };
}

TEST(ReferenceImage, PartsAndUpdates)
{
  auto volume = MakeOblique();
  auto mesh = MakeMoved(volume, 6);
  auto reference = MakeReference(volume, true);
  OnReference whole(volume, mesh, reference);
  vtkNew<vtkImageData> expected;
  expected->DeepCopy(whole.Update());
  OnReference part(volume, mesh, reference);
  for (const Extent& extent :
    { Extent{ { 5, 20, -2, 33, 10, 24 } }, Extent{ { 18, 34, 12, 33, 20, 41 } } })
  {
    part.Filter->UpdateInformation();
    part.Filter->UpdateExtent(extent.data());
    EXPECT_EQ(GetExtent(part.Filter->GetOutput()), extent);
    EXPECT_TRUE(IsPartOf(part.Filter->GetOutput(), expected));
  }
  auto* vectors = vtkFloatArray::SafeDownCast(mesh->GetPointData()->GetVectors());
  const vtkIdType node = 3 * 36 + 3 * 6 + 2;
  vectors->SetTypedComponent(node, 1, vectors->GetTypedComponent(node, 1) + 0.8F);
  vectors->Modified();
  mesh->Modified();
  OnReference fresh(volume, mesh, reference);
  EXPECT_TRUE(AreEqual(whole.Update(), fresh.Update()));
  EXPECT_FALSE(AreEqual(whole.Filter->GetOutput(), expected));
  EXPECT_GT(GetReported(whole.Filter, "Bricks resampled"), 0);
  // Another reference image of the same extent.
  vtkNew<vtkImageData> shifted;
  shifted->CopyStructure(reference);
  double origin[3];
  reference->GetOrigin(origin);
  shifted->SetOrigin(origin[0] + 0.3, origin[1], origin[2] - 0.2);
  whole.Filter->SetReferenceData(shifted);
  OnReference elsewhere(volume, mesh, shifted);
  EXPECT_TRUE(AreEqual(whole.Update(), elsewhere.Update()));
  EXPECT_FALSE(AreEqual(whole.Filter->GetOutput(), fresh.Filter->GetOutput()));
}

// Reference images of one plane, one row and one voxel.
TEST(ReferenceImage, ThinReferences)
{
  auto volume = MakeOblique();
  auto reference = MakeReference(volume, true);
  for (const auto& [name, set] : GetWays(volume))
  {
    OnReference whole(volume, nullptr, reference);
    set(whole);
    vtkImageData* expected = whole.Update();
    for (const Extent& extent : { Extent{ { 18, 18, -2, 33, 10, 41 } },
           Extent{ { 5, 34, 15, 15, 10, 41 } }, Extent{ { 5, 34, -2, 33, 25, 25 } },
           Extent{ { 18, 18, -2, 33, 25, 25 } }, Extent{ { 19, 19, 15, 15, 25, 25 } } })
    {
      vtkNew<vtkImageData> layer;
      layer->CopyStructure(reference);
      layer->SetExtent(const_cast<int*>(extent.data()));
      OnReference thin(volume, nullptr, layer);
      set(thin);
      EXPECT_EQ(GetExtent(thin.Update()), extent);
      EXPECT_TRUE(IsPartOf(thin.Filter->GetOutput(), expected));
      EXPECT_EQ(thin.TakeWarning(), "");
      EXPECT_GT(thin.Filter->GetNumberOfCoveredVoxels(), 0);
    }
  }
}

TEST(ReferenceImage, DataAreNotRequested)
{
  auto volume = MakeOblique();
  auto mesh = MakeMoved(volume);
  vtkNew<PartSource> source;
  source->CanMakeParts = false;
  auto reference = MakeReference(volume, true);
  source->SetVolume(reference);
  Deformed deformed(volume, mesh);
  deformed.Filter->SetBackgroundValue(-1000.0);
  deformed.Filter->SetReferenceConnection(source->GetOutputPort());
  CheckValues(deformed, volume, reference);
  // The reference image changes, and a part of the output is requested.
  reference = MakeReference(volume, false);
  source->SetVolume(reference);
  CheckValues(deformed, volume, reference);
  int extent[6] = { 6, 20, 0, 20, 12, 30 };
  source->Modified();
  deformed.Filter->UpdateInformation();
  deformed.Filter->UpdateExtent(extent);
  EXPECT_EQ(deformed.TakeErrors(), 0);
  EXPECT_TRUE(source->Made.empty());

  // An inverse field that is the reference image, too.
  const auto inverse = MakeField(volume, true);
  vtkNew<PartSource> field;
  field->CanMakeParts = false;
  field->SetVolume(inverse);
  Deformed own(volume, nullptr);
  own.Filter->SetBackgroundValue(-1000.0);
  own.Filter->SetDeformationConnection(field->GetOutputPort());
  own.Filter->SetReferenceConnection(field->GetOutputPort());
  own.Filter->FieldIsInverseOn();
  vtkImageData* output = own.Update();
  EXPECT_TRUE(HasGridOf(output, inverse));
  EXPECT_EQ(field->Made.size(), 1U);
  EXPECT_GT(own.Filter->GetNumberOfCoveredVoxels(), 10);
}

TEST(ReferenceImage, Warnings)
{
  auto volume = MakeOblique();
  auto mesh = MakeMoved(volume);
  auto reference = MakeReference(volume, false);
  OnReference deformed(volume, mesh, reference);
  vtkNew<vtkImageData> expected;
  expected->DeepCopy(deformed.Update());
  EXPECT_EQ(deformed.TakeWarning(), "");
  deformed.Filter->SetPadding(3);
  deformed.Filter->SetBoundsGranularity(8);
  deformed.Filter->SetOutputBoundsModeToCustomBounds();
  deformed.Filter->SetOutputSpacingModeToCustomSpacing();
  deformed.Filter->Update();
  EXPECT_TRUE(AreEqual(deformed.Filter->GetOutput(), expected));
  const std::string warning = deformed.TakeWarning();
  for (const char* name :
    { "Padding", "BoundsGranularity", "OutputBoundsMode", "OutputSpacingMode" })
  {
    EXPECT_TRUE(HasPart(warning, name));
  }
  deformed.Filter->Modified();
  deformed.Filter->Update();
  EXPECT_EQ(deformed.TakeWarning(), ""); // the warning is not repeated
}

// If no voxel is covered, the output is background, and there is one warning.
TEST(ReferenceImage, NothingCovered)
{
  auto volume = MakeOblique();
  auto reference = MakeReference(volume, false);
  vtkNew<vtkImageData> far;
  far->CopyStructure(reference);
  far->SetOrigin(300.0, 0.0, 0.0);
  const auto check = [&](const std::string& name, OnReference& apart, const std::string& words)
  {
    apart.Filter->Update();
    const std::string warnings = apart.Observer->GetWarningMessage();
    EXPECT_EQ(apart.TakeErrors(), 0);
    EXPECT_TRUE(HasPart(warnings, words)) << name;
    EXPECT_TRUE(HasPart(warnings, "Warning: ")) << name;
    EXPECT_EQ(warnings.find("Warning: "), warnings.rfind("Warning: ")) << name;
    EXPECT_TRUE(HasGridOf(apart.Filter->GetOutput(), far));
    EXPECT_EQ(apart.Filter->GetNumberOfCoveredVoxels(), 0);
    double range[2];
    apart.GetValues()->GetRange(range);
    EXPECT_EQ(range[0], -1000.0);
    EXPECT_EQ(range[1], -1000.0);
  };
  for (const auto& [name, set] : GetWays(volume))
  {
    // The inverse field does not overlap the reference image.
    OnReference apart(volume, nullptr, far);
    set(apart);
    check(name, apart, name == "inverse field" ? "inverse displacement field" : "reference image");
  }
  OnReference atRest(volume, nullptr, far);
  check("at rest", atRest, "reference image");
  // The inverse field contains the reference image, but its displacements lead outside the volume.
  auto field = MakeImage({ { 0, 4, 0, 4, 0, 4 } }, glm::dvec3(40.0));
  field->SetOrigin(260.0, -80.0, -80.0);
  SetDisplacements(field, Shift(90.0, 0.0, 0.0));
  OnReference beside(volume, field, far);
  beside.Filter->FieldIsInverseOn();
  check("outside", beside, "inverse displacement field");
}

TEST(ReferenceImage, Misuse)
{
  auto volume = MakeOblique();
  auto mesh = MakeMoved(volume);
  auto good = MakeReference(volume, false);
  OnReference deformed(volume, mesh, good);
  vtkNew<vtkImageData> expected;
  expected->DeepCopy(deformed.Update());
  const auto restore = [&]
  {
    deformed.Filter->SetInputData(volume);
    deformed.Filter->SetDeformationData(mesh);
    deformed.Filter->SetReferenceData(good);
    deformed.Filter->SetDisplacementScale(1.0);
    deformed.Filter->SetOutsideModeToDiscard();
    deformed.Filter->SetFadeDistance(0.0);
    deformed.Filter->FieldIsInverseOff();
  };
  const auto expectError = [&](const std::string& words)
  {
    deformed.VerifyFailure(words);
    restore();
    EXPECT_TRUE(AreEqual(deformed.Update(), expected));
    EXPECT_EQ(deformed.TakeWarning(), "");
  };
  const auto fails = [&](vtkImageData* reference, const std::string& words)
  {
    deformed.Filter->SetReferenceData(reference);
    expectError(words);
  };
  const auto copy = [&]
  {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->CopyStructure(good);
    return image;
  };
  auto spoilt = copy();
  spoilt->SetExtent(0, -1, 0, -1, 0, -1);
  fails(spoilt, "empty");
  spoilt = copy();
  spoilt->SetSpacing(1.0, 0.0, 1.0);
  fails(spoilt, "spacing of the reference image on axis y");
  spoilt = copy();
  const double singular[9] = { 1, 0, 0, 1, 0, 0, 0, 0, 1 };
  spoilt->SetDirectionMatrix(singular);
  fails(spoilt, "direction matrix of the reference image");
  spoilt = copy();
  spoilt->SetSpacing(1e-6, 1e-6, 1e-6);
  fails(spoilt, "grid of the reference image on axis x, beyond 2^21");
  spoilt = copy();
  spoilt->SetOrigin(0.0, 0.0, 4e6);
  fails(spoilt, "beyond 2^21");
  deformed.Filter->SetDisplacementScale(1e5);
  expectError("spacing of the output or of its reference image");
  vtkNew<PartSource> large;
  large->CanMakeParts = false;
  large->SetVolume(copy());
  large->WholeExtent = { { 0, 1 << 20, 0, 1 << 20, 0, 1 << 20 } };
  deformed.Filter->SetReferenceConnection(large->GetOutputPort());
  expectError("The reference image has more than 2^48 voxels");

  // Errors in the geometry of the volume, with a reference image.
  const auto failsWith = [&](const std::function<void(vtkImageData*)>& spoil, const char* words)
  {
    vtkNew<vtkImageData> spoiltVolume;
    spoiltVolume->DeepCopy(volume);
    spoil(spoiltVolume);
    deformed.Filter->SetInputData(spoiltVolume);
    expectError(words);
  };
  failsWith(
    [&](vtkImageData* v) { v->SetDirectionMatrix(singular); }, "direction matrix of the volume");
  failsWith(
    [](vtkImageData* v)
    {
      vtkNew<vtkFloatArray> other;
      other->SetNumberOfTuples(v->GetNumberOfPoints());
      other->Fill(0.0);
      v->GetPointData()->AddArray(other);
      other->SetName("value"); // VTK does not detect the second array of this name
    },
    "several point arrays with the name \"value\"");

  // Errors in the deformation.
  vtkNew<vtkUnstructuredGrid> broken;
  broken->DeepCopy(mesh);
  broken->GetPointData()->GetVectors()->SetComponent(
    21, 1, std::numeric_limits<double>::quiet_NaN());
  deformed.Filter->SetDeformationData(broken);
  expectError("not finite");
  for (const double distance : { std::numeric_limits<double>::quiet_NaN(), -1.0 })
  {
    deformed.Filter->SetOutsideModeToKeep();
    deformed.Filter->SetFadeDistance(distance);
    expectError("fade distance is ");
  }
  for (const bool isInverse : { false, true })
  {
    auto field = MakeField(volume, isInverse);
    field->GetPointData()->GetVectors()->SetComponent(
      field->GetNumberOfPoints() / 2, 2, std::numeric_limits<double>::quiet_NaN());
    deformed.Filter->SetDeformationData(field);
    deformed.Filter->SetFieldIsInverse(isInverse);
    expectError("not finite");
  }

  // A reference that is not an image: one error of the executive.
  vtkNew<vtkPolyData> surface;
  deformed.Filter->SetReferenceData(surface);
  deformed.Filter->Update();
  const std::string all =
    deformed.Observer->GetErrorMessage() + deformed.ExecutiveObserver->GetErrorMessage();
  EXPECT_TRUE(HasPart(all, "ERROR: "));
  EXPECT_EQ(all.find("ERROR: "), all.rfind("ERROR: "));
  deformed.TakeErrors();
  deformed.Filter->SetReferenceData(good);
  EXPECT_TRUE(AreEqual(deformed.Update(), expected));
}

} // namespace
