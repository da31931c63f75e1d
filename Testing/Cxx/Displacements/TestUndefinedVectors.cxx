// SPDX-License-Identifier: BSD-3-Clause
// Displacement fields that are undefined at hidden points. Voxels that need such a point are not
// covered, as if they were blanked. All other voxels are equal to those of a field without hidden
// points.
#include "ArrayMaking.h"
#include "FilterTesting.h"

#include <vtkImageChangeInformation.h>
#include <vtkUnsignedCharArray.h>

#include <glm/common.hpp>

#include <functional>
#include <limits>

using namespace filterTesting;

namespace
{

using Image = vtkSmartPointer<vtkImageData>;
using Choice = std::function<bool(const glm::dvec3& point)>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

vtkSmartPointer<vtkUnsignedCharArray> Hide(vtkImageData* image, const Choice& isHidden)
{
  auto ghosts = vtkSmartPointer<vtkUnsignedCharArray>::New();
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  for (vtkIdType id = 0; id < image->GetNumberOfPoints(); ++id)
  {
    const bool hidden = isHidden(GetPoint(image, id));
    ghosts->InsertNextValue(hidden ? vtkDataSetAttributes::HIDDENPOINT : 0);
  }
  image->GetPointData()->AddArray(ghosts);
  return ghosts;
}

// Sets values that programs write at undefined points.
void Spoil(vtkImageData* field, const Choice& isHidden)
{
  vtkDataArray* vectors = field->GetPointData()->GetVectors();
  const double values[4] = { nan, 0.0, 1e30, -std::numeric_limits<double>::infinity() };
  for (vtkIdType id = 0; id < field->GetNumberOfPoints(); ++id)
  {
    if (isHidden(GetPoint(field, id)))
    {
      vectors->SetTuple3(id, values[id % 4], values[id / 4 % 4], values[id / 16 % 4]);
    }
  }
}

Image CopyVolume(vtkImageData* volume)
{
  Image copy = Image::New();
  copy->DeepCopy(volume);
  return copy;
}

WorldMap Bend()
{
  return [](const glm::dvec3& p)
  { return p + glm::dvec3(0.6 * std::sin(0.4 * p.y), 0.4 * std::cos(0.5 * p.z), 0.05 * p.x); };
}

// Compares with a volume in which the voxels that need an undefined point are blanked.
void CheckForward(vtkImageData* volume, vtkImageData* field, const Choice& isHidden,
  const Choice& isUndefined, bool extrapolate = false, int factor = 1)
{
  const Image blanked = CopyVolume(volume);
  Hide(blanked, isUndefined);
  Deformed expected(blanked, CopyVolume(field));
  const Image gaps = CopyVolume(field);
  Hide(gaps, isHidden);
  Spoil(gaps, isHidden);
  Deformed found(volume, gaps);
  for (Deformed* one : { &expected, &found })
  {
    one->Filter->SetOutputBoundsModeToVolumeBounds();
    one->Filter->SetSamplingFactor(factor);
    one->Filter->SetOutsideMode(
      extrapolate ? vtkDeformVolumeFilter::EXTRAPOLATE : vtkDeformVolumeFilter::DISCARD);
    one->Update();
    EXPECT_GT(one->Filter->GetNumberOfCoveredVoxels(), 100);
  }
  vtkPointData* arrays = expected.Filter->GetOutput()->GetPointData();
  for (const char* name : { "value", "vtkValidPointMask" })
  {
    EXPECT_TRUE(HaveEqualBits(
      arrays->GetArray(name), found.Filter->GetOutput()->GetPointData()->GetArray(name)));
  }
  Deformed whole(volume, field);
  whole.Filter->SetOutputBoundsModeToVolumeBounds();
  whole.Filter->SetSamplingFactor(factor);
  whole.Filter->SetOutsideMode(found.Filter->GetOutsideMode());
  whole.Update();
  EXPECT_LT(found.Filter->GetNumberOfCoveredVoxels(), whole.Filter->GetNumberOfCoveredVoxels());
}

TEST(UndefinedVectors, Forward)
{
  const auto volume = MakeVolume({ { 0, 12, 0, 12, 0, 12 } });
  // A field whose points are at voxels: each voxel needs only its own point.
  const auto same = MakeImage({ { 0, 12, 0, 12, 0, 12 } });
  SetDisplacements(same, Bend());
  const auto isCorner = [](const glm::dvec3& p) { return p.x > 7.0 && p.y > 5.0; };
  CheckForward(volume, same, isCorner, isCorner);
  CheckForward(volume, same, isCorner, isCorner, false, 2);
  // A coarse field: voxels need up to eight points.
  const auto coarse = MakeImage({ { 0, 4, 0, 4, 0, 4 } }, glm::dvec3(3.0));
  SetDisplacements(coarse, Bend());
  const glm::dvec3 middle(6.0);
  const auto isMiddle = [=](const glm::dvec3& p) { return p == middle; };
  const auto isNear = [=](const glm::dvec3& p)
  {
    const glm::dvec3 d = glm::abs(p - middle);
    return d.x < 3.0 && d.y < 3.0 && d.z < 3.0;
  };
  CheckForward(volume, coarse, isMiddle, isNear);
  // With extrapolation, voxels outside need the closest points of the field.
  const auto small = MakeImage({ { 0, 2, 0, 2, 0, 2 } }, glm::dvec3(3.0), glm::dvec3(3.0));
  SetDisplacements(small, Bend());
  const auto isEnd = [](const glm::dvec3& p) { return p == glm::dvec3(9.0); };
  CheckForward(
    volume, small, isEnd, [](const glm::dvec3& p) { return p.x > 6.0 && p.y > 6.0 && p.z > 6.0; },
    true);
  // A field that would be read in place without hidden points.
  const auto large = MakeVolume({ { 0, 65, 0, 63, 0, 63 } });
  const auto floats = MakeImage({ { 0, 65, 0, 63, 0, 63 } });
  SetDisplacements(floats, Shift(1.0, 0.25, 0.0));
  CheckForward(large, floats, isCorner, isCorner);
}

// When another point is hidden, fewer voxels are covered. Vectors of other points must be finite.
TEST(UndefinedVectors, Edits)
{
  const auto volume = MakeVolume({ { 0, 30, 0, 30, 0, 30 } });
  const auto field = MakeImage({ { 0, 30, 0, 30, 0, 30 } });
  SetDisplacements(field, Bend());
  const auto ghosts = Hide(field, [](const glm::dvec3& p) { return p.x < 4.0; });
  Deformed tested(volume, field);
  tested.Filter->SetOutputBoundsModeToVolumeBounds();
  tested.Update();
  const vtkIdType covered = tested.Filter->GetNumberOfCoveredVoxels();
  ghosts->SetValue(15000, vtkDataSetAttributes::HIDDENPOINT);
  ghosts->Modified();
  tested.Update();
  EXPECT_LT(tested.Filter->GetNumberOfCoveredVoxels(), covered);
  // SetArray() replaces the values without changing the modification time.
  std::vector<unsigned char> none(static_cast<std::size_t>(field->GetNumberOfPoints()), 0);
  ghosts->SetArray(none.data(), field->GetNumberOfPoints(), 1);
  tested.Filter->Modified();
  tested.Update();
  EXPECT_GT(tested.Filter->GetNumberOfCoveredVoxels(), covered);
  field->GetPointData()->GetVectors()->SetComponent(16000, 1, nan);
  field->GetPointData()->GetVectors()->Modified();
  tested.VerifyFailure("Vector 16000 of the displacement field");
}

// A field with an unusable mask is an error. The next update with the first field is right.
TEST(UndefinedVectors, FieldsAfterFailures)
{
  const auto volume = MakeVolume({ { 0, 12, 0, 12, 0, 12 } });
  const auto field = MakeImage({ { 0, 5, 0, 5, 0, 5 } }, glm::dvec3(2.0));
  SetDisplacements(field, Bend());
  const auto larger = MakeImage({ { 0, 12, 0, 12, 0, 12 } }, glm::dvec3(0.7));
  SetDisplacements(larger, Bend());
  larger->GetPointData()->AddArray(
    MakeArray<vtkFloatArray>(vtkDataSetAttributes::GhostArrayName(), larger->GetNumberOfPoints()));
  Deformed tested(volume, field);
  tested.Update();
  tested.Filter->SetDeformationData(larger);
  tested.VerifyFailure("\"vtkGhostType\"");
  tested.Filter->SetDeformationData(field);
  Deformed expected(volume, field);
  for (Deformed* one : { &tested, &expected })
  {
    one->Filter->SetOutsideModeToExtrapolate();
    one->Filter->GenerateJacobianOn();
  }
  EXPECT_TRUE(AreEqual(tested.Update(), expected.Update()));
}

// Volume and field in another unit, with the same memory of vectors. Which voxels are undefined
// depends on FadeDistance.
TEST(UndefinedVectors, OtherUnit)
{
  const auto volume = MakeVolume({ { 0, 15, 0, 9, 0, 9 } });
  const auto field = MakeImage({ { 0, 4, 0, 4, 0, 4 } }, glm::dvec3(2.0));
  SetDisplacements(field, Shift(0.3, 0.3, 0.3));
  Hide(field, [](const glm::dvec3& p) { return p == glm::dvec3(8.0, 4.0, 4.0); });
  vtkNew<vtkImageChangeInformation> volumeUnit;
  volumeUnit->SetInputData(volume);
  vtkNew<vtkImageChangeInformation> fieldUnit;
  fieldUnit->SetInputData(field);
  const auto prepare = [&](Deformed& deformed)
  {
    deformed.Filter->SetInputConnection(volumeUnit->GetOutputPort());
    deformed.Filter->SetDeformationConnection(fieldUnit->GetOutputPort());
    deformed.Filter->SetOutsideModeToKeep();
    deformed.Filter->SetFadeDistance(4.0);
    deformed.Filter->SetOutputBoundsModeToVolumeBounds();
  };
  Deformed tested;
  prepare(tested);
  for (const double scale : { 1.0, 2.0, 0.5 })
  {
    volumeUnit->SetOutputSpacing(scale, scale, scale);
    fieldUnit->SetOutputSpacing(2.0 * scale, 2.0 * scale, 2.0 * scale);
    Deformed expected;
    prepare(expected);
    EXPECT_TRUE(AreEqual(tested.Update(), expected.Update())) << scale;
  }
}

// With an inverse field each output voxel has the value of its rest position, or is not covered.
TEST(UndefinedVectors, Inverse)
{
  // The spacing 0.7 is not exact in floats, so positions are rounded.
  for (const double spacing : { 1.0, 0.7 })
  {
    const auto volume = MakeImage(
      { { 0, 12, 0, 12, 0, 12 } }, glm::dvec3(spacing), glm::dvec3(0.1 * spacing, 0.3, 0.7));
    AddScalars<float>(
      volume, "value", [](const glm::dvec3& p) { return p.x + 10.0 * p.y + 100.0 * p.z; });
    for (const int step : { 1, 3 })
    {
      const int last = 12 / step;
      const auto field = MakeImage({ { 0, last, 0, last, 0, last } }, glm::dvec3(step * spacing),
        glm::dvec3(0.1 * spacing, 0.3, 0.7));
      SetDisplacements(field, Shift(2.0 * spacing, 0.0, 0.0));
      // Hidden points: a part of a row along x, and all points beyond voxel 9 on z.
      const auto isHidden = [&](int i, int j, int k) {
        return (j * step == 6 && k * step == 6 && i * step >= 3 && i * step <= 9) || k * step > 9;
      };
      vtkIdType id = 0;
      const auto ghosts = Hide(field, [](const glm::dvec3&) { return false; });
      for (int k = 0; k <= last; ++k)
      {
        for (int j = 0; j <= last; ++j)
        {
          for (int i = 0; i <= last; ++i, ++id)
          {
            if (isHidden(i, j, k))
            {
              ghosts->SetValue(id, vtkDataSetAttributes::HIDDENPOINT);
              field->GetPointData()->GetVectors()->SetTuple3(id, i % 2 ? nan : 0.0, nan, 1e30);
            }
          }
        }
      }
      Deformed deformed(volume, field);
      deformed.Filter->FieldIsInverseOn();
      const Extent extent{ { 0, 10, 0, 12, 0, 9 } };
      EXPECT_EQ(GetExtent(deformed.Update()), extent);
      deformed.Filter->SetOutputBoundsModeToVolumeBounds();
      vtkImageData* output = deformed.Update();
      int wrong = 0;
      id = 0;
      for (int z = 0; z <= 12; ++z)
      {
        for (int y = 0; y <= 12; ++y)
        {
          for (int x = 0; x <= 12; ++x, ++id)
          {
            bool defined = true;
            for (int corner = 0; corner < 8; ++corner)
            {
              const auto at = [&](int index, int axis)
              { return (index + ((corner >> axis & 1) != 0 ? step - 1 : 0)) / step; };
              defined = defined && !isHidden(at(x, 0), at(y, 1), at(z, 2));
            }
            const bool covered = defined && x <= 10;
            const glm::dvec3 rest = GetPoint(output, id) + glm::dvec3(2.0 * spacing, 0.0, 0.0);
            const double value =
              static_cast<float>(covered ? rest.x + 10.0 * rest.y + 100.0 * rest.z : 0.0);
            wrong += deformed.IsCovered(id) != covered ||
                std::abs(deformed.GetValues()->GetComponent(id, 0) - value) > 1e-3
              ? 1
              : 0;
          }
        }
      }
      EXPECT_EQ(wrong, 0);
    }
  }
}

} // namespace
