// SPDX-License-Identifier: BSD-3-Clause
// OutsideMode KEEP with displacement fields, forward and inverse: tissue outside the grid of the
// field is kept, and the displacement at the faces of the grid fades to zero within FadeDistance.
// The reference is another field, which has the displacement of each voxel.
#include "ArrayMaking.h"
#include "KeepTesting.h"

#include "vtkCutVolume.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <vtkCellData.h>
#include <vtkPlaneSource.h>
#include <vtkRTAnalyticSource.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <limits>
#include <random>
#include <string>
#include <vector>

using namespace filterTesting;

namespace
{

// The displacement of a field at a world position, in double precision.
glm::dvec3 Displace(vtkImageData* field, double fadeDistance, const glm::dvec3& point)
{
  double index[3];
  field->TransformPhysicalPointToContinuousIndex(&point.x, index);
  const Extent extent = GetExtent(field);
  int low[3];
  double part[3];
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double inside =
      std::clamp(index[axis], double(extent[2 * axis]), double(extent[2 * axis + 1]));
    const double beyond = (index[axis] - inside) * field->GetSpacing()[axis];
    square += std::abs(index[axis] - inside) > 1e-3 ? beyond * beyond : 0.0;
    low[axis] = std::min(static_cast<int>(std::floor(inside)), extent[2 * axis + 1] - 1);
    part[axis] = inside - low[axis];
  }
  glm::dvec3 sum(0.0);
  for (int corner = 0; corner < 8; ++corner)
  {
    int gridIndex[3];
    double weight = 1.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      const int upper = corner >> axis & 1;
      gridIndex[axis] = low[axis] + upper;
      weight *= upper ? part[axis] : 1.0 - part[axis];
    }
    glm::dvec3 vector;
    field->GetPointData()->GetVectors()->GetTuple(field->ComputePointId(gridIndex), &vector.x);
    sum += weight > 0.0 ? weight * vector : glm::dvec3(0.0);
  }
  const double distance = std::sqrt(square);
  return distance > 0.0 ? (fadeDistance > 0.0 ? Fade(distance / fadeDistance) : 0.0) * sum : sum;
}

// Adds the coordinates of each voxel as arrays, so that outputs have rest positions, and an array
// whose values vary in all directions.
vtkSmartPointer<vtkImageData> MakeTissue(vtkImageData* image)
{
  const char* const names[3] = { "x", "y", "z" };
  for (int axis = 0; axis < 3; ++axis)
  {
    AddScalars<double>(image, names[axis], [axis](const glm::dvec3& p) { return p[axis]; });
  }
  AddScalars<short>(image, "value",
    [](const glm::dvec3& p)
    { return 400.0 * std::sin(0.7 * p.x) + 300.0 * std::cos(0.9 * p.y + 0.2 * p.z); });
  return image;
}

// Sets a bend that is not zero at the faces of the field.
void SetBend(vtkImageData* field, double size)
{
  SetDisplacements(field,
    [size](const glm::dvec3& p)
    {
      return p +
        size *
        glm::dvec3(1.0 + 0.4 * std::sin(0.21 * p.y), -0.7 + 0.2 * std::cos(0.17 * p.z),
          0.5 + 0.3 * std::sin(0.13 * p.x));
    });
}

// A field with the same displacements, which has a point at each voxel of a grid.
vtkSmartPointer<vtkImageData> MakeVoxelField(
  vtkImageData* grid, vtkImageData* field, double fadeDistance)
{
  auto voxels = vtkSmartPointer<vtkImageData>::New();
  voxels->CopyStructure(grid);
  SetDisplacements(
    voxels, [&](const glm::dvec3& p) { return p + Displace(field, fadeDistance, p); });
  return voxels;
}

// Checks that the rest positions of two outputs differ by at most a tolerance.
void VerifyAlike(vtkImageData* found, vtkImageData* expected, double tolerance)
{
  EXPECT_EQ(GetExtent(found), GetExtent(expected));
  if (GetExtent(found) != GetExtent(expected))
  {
    return;
  }
  vtkIdType others = 0;
  vtkIdType covered = 0;
  double worst = 0.0;
  for (vtkIdType id = 0; id < found->GetNumberOfPoints(); ++id)
  {
    const auto get = [id](vtkImageData* image, const char* name)
    { return image->GetPointData()->GetArray(name)->GetComponent(id, 0); };
    const bool isCovered = get(found, "vtkValidPointMask") != 0.0;
    others += isCovered != (get(expected, "vtkValidPointMask") != 0.0);
    if (isCovered)
    {
      ++covered;
      for (const char* name : { "x", "y", "z" })
      {
        worst = std::max(worst, std::abs(get(found, name) - get(expected, name)));
      }
    }
  }
  EXPECT_GT(covered, 5000);
  // Coverage may differ on the surface of the volume, since positions are rounded.
  EXPECT_LE(others, covered / 2000);
  EXPECT_LE(worst, tolerance);
}

vtkSmartPointer<vtkImageData> MakeTissueVolume(bool oblique)
{
  auto volume =
    MakeImage({ { -2, 45, 3, 42, 0, 35 } }, glm::dvec3(0.9, 1.1, 1.4), glm::dvec3(5.0, -3.0, 2.0));
  if (oblique)
  {
    SetObliqueDirection(volume);
  }
  return MakeTissue(volume);
}

// A coarse field in the middle of a volume.
vtkSmartPointer<vtkImageData> MakeField(vtkImageData* volume, double size, bool oblique)
{
  auto field = MakeImage({ { 4, 9, -1, 4, 2, 6 } }, glm::dvec3(3.1, 3.3, 4.7));
  double bounds[6];
  volume->GetBounds(bounds);
  if (oblique)
  {
    SetObliqueDirection(field);
  }
  double middle[3];
  field->GetCenter(middle);
  const double* origin = field->GetOrigin();
  field->SetOrigin(origin[0] + 0.5 * (bounds[0] + bounds[1]) - middle[0],
    origin[1] + 0.5 * (bounds[2] + bounds[3]) - middle[1],
    origin[2] + 0.5 * (bounds[4] + bounds[5]) - middle[2]);
  SetBend(field, size);
  return field;
}

TEST(DeformKeepField, Misuse)
{
  const auto volume = MakeTissueVolume(false);
  const auto field = MakeField(volume, 1.0, false);
  Kept subject(volume, field, 6.0);
  vtkNew<vtkImageData> expected;
  expected->DeepCopy(subject.Expect(""));
  for (const double distance :
    { -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity() })
  {
    for (const bool isInverse : { false, true })
    {
      subject.Filter->SetFieldIsInverse(isInverse);
      subject.Filter->SetFadeDistance(distance);
      subject.VerifyFailure("fade distance is ");
    }
  }
  subject.Filter->FieldIsInverseOff();
  subject.Filter->SetFadeDistance(6.0);
  subject.Filter->SetResamplerToMeshRasterization();
  subject.VerifyFailure("forward displacement fields");
  subject.Filter->SetResamplerToAutomatic();
  EXPECT_TRUE(AreEqual(subject.Expect(""), expected));
}

// The output is that of a field with the displacement of each voxel, and has no holes.
TEST(DeformKeepField, Forward)
{
  for (const bool isOblique : { false, true })
  {
    const auto volume = MakeTissueVolume(isOblique);
    const auto field = MakeField(volume, 0.9, !isOblique);
    for (const double distance : { 0.0, 4.0, 9.0, 1e5 })
    {
      Kept subject(volume, field, distance);
      Deformed reference(volume, MakeVoxelField(volume, field, distance));
      reference.Update();
      // Positions are rounded to 1/512 voxel, and displacements are floats. Compression of the
      // volume multiplies the error of rest positions.
      const double tolerance = 1.4 / 256.0 * (distance == 0.0 ? 8.0 : 3.0);
      VerifyAlike(subject.Expect(""), reference.Filter->GetOutput(), tolerance);
      EXPECT_EQ(subject.Filter->GetNumberOfInvertedTetrahedra(),
        reference.Filter->GetNumberOfInvertedTetrahedra());
      if (distance <= 4.0) // otherwise the faces of the volume move
      {
        EXPECT_EQ(subject.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints());
      }
    }
  }
}

// Far from the field values do not change by a bit.
TEST(DeformKeepField, Far)
{
  const auto volume = MakeTissueVolume(true);
  const auto field = MakeField(volume, 0.9, true);
  Kept subject(volume, field, 3.0);
  vtkImageData* output = subject.Expect("");
  EXPECT_EQ(GetExtent(output), GetExtent(volume));
  vtkIdType far = 0;
  for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 p = GetPoint(volume, id);
    double index[3];
    field->TransformPhysicalPointToContinuousIndex(&p.x, index);
    const Extent extent = GetExtent(field);
    glm::dvec3 beyond;
    for (int axis = 0; axis < 3; ++axis)
    {
      beyond[axis] = field->GetSpacing()[axis] *
        (index[axis] -
          std::clamp(index[axis], double(extent[2 * axis]), double(extent[2 * axis + 1])));
    }
    if (glm::length(beyond) > 8.0)
    {
      ++far;
      for (const char* name : { "x", "value" })
      {
        EXPECT_EQ(output->GetPointData()->GetArray(name)->GetComponent(id, 0),
          volume->GetPointData()->GetArray(name)->GetComponent(id, 0));
      }
    }
  }
  EXPECT_GT(far, 5000);
}

// An inverse field, with outputs on the grid of the volume and on that of a reference image.
TEST(DeformKeepField, Inverse)
{
  for (const bool isOblique : { false, true })
  {
    const auto volume = MakeTissueVolume(isOblique);
    const auto field = MakeField(volume, 0.9, !isOblique);
    const auto fixed =
      MakeImage({ { 0, 30, 0, 30, 0, 30 } }, glm::dvec3(1.3), glm::dvec3(3.0, -5.0, 1.0));
    for (const double distance : { 0.0, 5.0, 1e5 })
    {
      for (const bool hasReference : { false, true })
      {
        Kept subject(volume, field, distance);
        subject.Filter->FieldIsInverseOn();
        subject.Filter->SetOutputBoundsModeToVolumeBounds();
        vtkImageData* grid = hasReference ? fixed : volume;
        Deformed reference(volume, MakeVoxelField(grid, field, distance));
        reference.Filter->FieldIsInverseOn();
        reference.Filter->SetOutputBoundsModeToVolumeBounds();
        if (hasReference)
        {
          for (auto* filter : { subject.Filter.Get(), reference.Filter.Get() })
          {
            filter->SetOutputBoundsModeToDeformedBounds();
            filter->SetReferenceData(fixed);
          }
        }
        reference.Update();
        // Rest positions are rounded to 1/256 voxel.
        VerifyAlike(subject.Expect(""), reference.Filter->GetOutput(), 1.4 / 256.0);
        // The bounds are the smallest that contain all covered voxels.
        if (!hasReference)
        {
          subject.Filter->SetOutputBoundsModeToDeformedBounds();
          subject.Expect("");
          Deformed whole(volume, nullptr);
          vtkNew<vtkImageData> large;
          large->CopyStructure(volume);
          Extent extent = GetExtent(volume);
          for (int i = 0; i < 6; ++i)
          {
            extent[i] += i % 2 == 0 ? -6 : 6;
          }
          large->SetExtent(extent.data());
          whole.Filter->SetDeformationData(MakeVoxelField(large, field, distance));
          whole.Filter->FieldIsInverseOn();
          whole.Update();
          EXPECT_EQ(GetExtent(subject.Filter->GetOutput()), GetExtent(whole.Filter->GetOutput()));
        }
      }
    }
  }
}

// Displacements, masks and FadeDistance change. The output must be equal to that of a new filter.
TEST(DeformKeepField, Incremental)
{
  const auto volume = MakeTissueVolume(false);
  const auto field = MakeField(volume, 1.0, false);
  const auto active = AddActiveTetrahedra(volume);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  double distance = 7.0;
  Kept subject(volume, field, distance);
  subject.Filter->SetOutputBoundsModeToVolumeBounds();
  subject.Filter->Update();
  vtkIdType parts = 0;
  for (int step = 0; step < 6; ++step)
  {
    vtkDataArray* vectors = field->GetPointData()->GetVectors();
    const auto points = static_cast<unsigned int>(field->GetNumberOfPoints());
    vectors->SetTuple3(
      static_cast<vtkIdType>(random() % points), uniform(random), uniform(random), uniform(random));
    vectors->Modified();
    if (step % 4 == 1)
    {
      active->SetValue(
        static_cast<vtkIdType>(random() % static_cast<unsigned int>(volume->GetNumberOfCells())),
        static_cast<unsigned char>(random() % 31));
      active->Modified();
    }
    if (step == 4)
    {
      distance = 5.0;
      subject.Filter->SetFadeDistance(distance);
    }
    subject.Filter->Update();
    EXPECT_EQ(subject.TakeErrors(), 0);
    parts += GetReported(subject.Filter, "Bricks resampled") <
      GetReported(subject.Filter, "Bricks of the volume");
    Kept fresh(volume, field, distance);
    fresh.Filter->SetOutputBoundsModeToVolumeBounds();
    fresh.Filter->Update();
    EXPECT_EQ(fresh.TakeErrors(), 0);
    EXPECT_TRUE(AreEqual(subject.Filter->GetOutput(), fresh.Filter->GetOutput()));
  }
  EXPECT_GT(parts, 1);
}

// Pieces are equal to parts of the whole output.
TEST(DeformKeepField, PiecesOfInverseFields)
{
  const auto volume = MakeTissueVolume(false);
  Kept subject(volume, MakeField(volume, 1.0, true), 6.0);
  subject.Filter->FieldIsInverseOn();
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(subject.Expect(""));
  VerifyPieces(subject, 4, whole);
}

// From a source that makes parts, only voxels that may be in the requested piece are requested.
TEST(DeformKeepField, Parts)
{
  vtkNew<vtkRTAnalyticSource> source;
  source->SetWholeExtent(-20, 25, -15, 22, -11, 30);
  const auto field = MakeImage({ { 0, 4, 0, 3, 0, 5 } }, glm::dvec3(3.3), glm::dvec3(-6.0));
  // The displacement is larger than the thickness of a piece. Thus kept tissue and the faces of the
  // field are in different pieces.
  SetDisplacements(field, Shift(1.0, -0.5, 8.0));
  Kept subject(nullptr, field, 17.0);
  subject.Filter->SetInputConnection(source->GetOutputPort());
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(subject.Expect(""));
  source->GetOutput()->ReleaseData();
  Kept pieces(nullptr, field, 17.0);
  pieces.Filter->SetInputConnection(source->GetOutputPort());
  vtkIdType fewest = std::numeric_limits<vtkIdType>::max();
  for (int piece = 0; piece < 12; ++piece)
  {
    source->Modified();
    source->GetOutput()->ReleaseData();
    pieces.Filter->UpdatePiece(piece, 12, 0);
    EXPECT_EQ(pieces.TakeErrors(), 0);
    fewest = std::min(fewest, source->GetOutput()->GetNumberOfPoints());
    vtkImageData* part = pieces.Filter->GetOutput();
    EXPECT_TRUE(IsPartOf(part, whole));
  }
  EXPECT_LT(fewest, whole->GetNumberOfPoints() / 3);
}

// A cut through tissue that is kept.
TEST(DeformKeepField, Cut)
{
  const auto volume = MakeTissueVolume(false);
  const auto field = MakeField(volume, 1.5, true);
  const auto voxels = MakeVoxelField(volume, field, 7.0);
  vtkNew<vtkPlaneSource> sheet;
  sheet->SetOrigin(16.3, -9.0, -5.1);
  sheet->SetPoint1(46.8, 59.0, -7.2);
  sheet->SetPoint2(20.7, -4.0, 75.3);
  const auto count = [&](vtkDataObject* deformation, bool keep)
  {
    vtkNew<vtkCutVolume> filter;
    filter->SetInputData(volume);
    filter->SetSheetConnection(sheet->GetOutputPort());
    filter->SetDeformationData(deformation);
    if (keep)
    {
      filter->SetOutsideModeToKeep();
      filter->SetFadeDistance(7.0);
    }
    filter->Update();
    auto active = vtkSmartPointer<vtkUnsignedCharArray>::New();
    active->DeepCopy(filter->GetOutput()->GetCellData()->GetArray("ActiveTetrahedra"));
    return active;
  };
  const auto found = count(field, true);
  const auto expected = count(voxels, false);
  vtkIdType cut = 0;
  vtkIdType others = 0;
  for (vtkIdType cell = 0; cell < found->GetNumberOfValues(); ++cell)
  {
    cut += found->GetValue(cell) != 31;
    others += found->GetValue(cell) != expected->GetValue(cell);
  }
  EXPECT_GT(cut, 1000);
  EXPECT_LT(others * 500, cut); // vertices near the sheet, since displacements are floats
}

// Tissue beyond FadeDistance does not need the undefined displacement of a corner of the field.
TEST(DeformKeepField, Undefined)
{
  const auto volume = MakeTissueVolume(false);
  const auto field = MakeField(volume, 1.0, false);
  const auto ghosts = MakeArray<vtkUnsignedCharArray>(
    vtkDataSetAttributes::GhostArrayName(), field->GetNumberOfPoints());
  ghosts->SetValue(0, vtkDataSetAttributes::HIDDENPOINT);
  field->GetPointData()->AddArray(ghosts);
  for (const bool isInverse : { false, true })
  {
    Kept subject(volume, field, 4.0);
    subject.Filter->SetFieldIsInverse(isInverse);
    subject.Filter->SetOutputBoundsModeToVolumeBounds();
    vtkImageData* output = subject.Expect("");
    EXPECT_TRUE(subject.IsCovered(0));
    int last[3] = { 45, 42, 35 };
    EXPECT_TRUE(subject.IsCovered(output->ComputePointId(last)));
    double corner[3];
    field->GetPoint(0, corner);
    EXPECT_FALSE(subject.IsCovered(output->FindPoint(corner)));
    EXPECT_GT(subject.Filter->GetNumberOfCoveredVoxels(), volume->GetNumberOfPoints() * 9 / 10);
  }
}

// Folded tissue is reported by one warning for each change.
TEST(DeformKeepField, Warnings)
{
  const auto volume = MakeTissueVolume(false);
  const auto field = MakeField(volume, 1.0, false);
  const auto move = [&](double distance) { SetDisplacements(field, Shift(distance, 0.0, 0.0)); };
  for (const bool isInverse : { false, true })
  {
    move(3.0);
    Kept subject(volume, field, 4.6);
    subject.Filter->SetFieldIsInverse(isInverse);
    subject.Filter->SetOutputBoundsModeToVolumeBounds();
    subject.Expect("");
    move(3.25);
    subject.Expect("moves by up to 3.25");
    subject.Filter->SetPadding(1);
    subject.Expect("");
    subject.Filter->SetFadeDistance(5.0);
    subject.Expect("");
    subject.Filter->SetFadeDistance(0.0);
    subject.Expect("as the fade distance is 0");
    move(1.5);
    subject.Expect("");
  }
  // No warning if the volume is inside the field.
  const auto large = MakeImage({ { 0, 1, 0, 1, 0, 1 } }, glm::dvec3(500.0), glm::dvec3(-200.0));
  SetDisplacements(large, Shift(30.0, 0.0, 0.0));
  Kept covered(volume, large, 1.0);
  covered.Expect("");
}

} // namespace
