// SPDX-License-Identifier: BSD-3-Clause
// Large displacement fields of floats, with a point at each voxel, are read in place. The result
// must be equal, bit by bit, to that of the same field as doubles, which is converted.
#include "ArrayMaking.h"
#include "Device.h"
#include "FilterTesting.h"

#include <vtkArrayChanges.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkUnsignedCharArray.h>

#include <limits>

using namespace filterTesting;

namespace
{

// Fields of this size are read in place. The sizes of its rows and planes are not powers of two.
constexpr Extent Voxels{ { -4, 68, 3, 64, 0, 66 } };

class Fields
{
public:
  explicit Fields(const glm::dvec3& spacing, bool oblique = false, const Extent& extent = Voxels)
    : Volume(MakeImage(Voxels, spacing, glm::dvec3(-20.0, 3.0, 5.0)))
    , Floats(MakeImage(extent, spacing, glm::dvec3(-20.0, 3.0, 5.0)))
    , Doubles(vtkSmartPointer<vtkImageData>::New())
    , Tested(Volume, Floats)
    , Converted(Volume, Doubles)
  {
    if (oblique)
    {
      SetObliqueDirection(this->Volume);
      SetObliqueDirection(this->Floats);
    }
    AddScalars<short>(this->Volume, "value",
      [](const glm::dvec3& p) { return 500.0 * std::sin(0.7 * p.x) + 9.0 * p.y + 35.0 * p.z; });
    this->Doubles->CopyStructure(this->Floats);
    SetDisplacements(this->Floats,
      [](const glm::dvec3& p)
      {
        return p +
          glm::dvec3(3.0 * std::sin(0.1 * p.y), -1.7 * std::cos(0.07 * p.z), 0.03 * p.x - 0.4);
      });
    const auto doubles =
      MakeArray<vtkDoubleArray>("displacement", this->Doubles->GetNumberOfPoints(), 3);
    this->Doubles->GetPointData()->SetVectors(doubles);
    this->ForBoth([](vtkDeformVolumeFilter* filter) { filter->SetResamplerToExact(); });
  }

  float* GetVectors()
  {
    return vtkFloatArray::SafeDownCast(this->Floats->GetPointData()->GetVectors())->GetPointer(0);
  }

  void ForBoth(const std::function<void(vtkDeformVolumeFilter*)>& change)
  {
    change(this->Tested.Filter);
    change(this->Converted.Filter);
  }

  void Compare(const char* what)
  {
    SCOPED_TRACE(what);
    if (!vtkArrayChanges::FindLog(this->Floats->GetPointData()->GetVectors()))
    {
      this->Floats->GetPointData()->GetVectors()->Modified();
    }
    this->Doubles->GetPointData()->GetVectors()->DeepCopy(
      this->Floats->GetPointData()->GetVectors());
    this->Doubles->GetPointData()->GetVectors()->Modified();
    this->CompareOutputs();
  }
  void CompareOutputs()
  {
    EXPECT_TRUE(AreEqual(this->Tested.Update(), this->Converted.Update()));
    EXPECT_EQ(this->Tested.Filter->GetNumberOfInvertedTetrahedra(),
      this->Converted.Filter->GetNumberOfInvertedTetrahedra());
    EXPECT_GT(this->Tested.Filter->GetNumberOfCoveredVoxels(), 1000);
  }

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkImageData> Floats;
  vtkSmartPointer<vtkImageData> Doubles;
  Deformed Tested;
  Deformed Converted;
};

TEST(DeformFieldsInPlace, EqualBits)
{
  for (const glm::dvec3& spacing :
    { glm::dvec3(1.0), glm::dvec3(0.7, 1.3, 0.9), glm::dvec3(-0.7, 1.3, 0.9) })
  {
    for (const bool oblique : { false, true })
    {
      Fields fields(spacing, oblique);
      fields.Compare("a field");
      // On a CPU the filter holds a copy of the converted field, and none of a field that is read
      // in place.
      const vtkIdType bytes = 16 * fields.Floats->GetNumberOfPoints();
      EXPECT_TRUE(fields.Tested.Filter->GetDeviceMemory() + bytes <=
          fields.Converted.Filter->GetDeviceMemory() ||
        fields.Tested.Filter->GetDeviceInUse().find("cpu") == std::string::npos);
      fields.ForBoth([](vtkDeformVolumeFilter* filter) { filter->SetDisplacementScale(-1.3); });
      fields.Compare("a scale");
      fields.ForBoth(
        [](vtkDeformVolumeFilter* filter)
        {
          filter->SetOutputSpacingModeToCustomSpacing();
          filter->SetCustomSpacing(1.1, 0.8, 2.0);
        });
      fields.Compare("another output spacing");
      fields.ForBoth(
        [](vtkDeformVolumeFilter* filter) { filter->SetOutputSpacingModeToVolumeSpacing(); });
      float* vector = fields.GetVectors() + 3 * (73 * (62 * 30 + 31) + 35);
      vector[0] += 25.0F; // folds
      fields.Compare("a fold");
      vector[0] -= 24.0F;
      fields.Compare("a small change");
    }
  }
}

// A field that is larger than the volume, and a smaller one.
TEST(DeformFieldsInPlace, OtherExtents)
{
  Fields larger(glm::dvec3(0.7, 1.3, 0.9), false, { { -9, 70, 0, 64, -3, 70 } });
  larger.Compare("a larger field");
  Fields smaller(glm::dvec3(0.7, 1.3, 0.9), false, { { -4, 68, 4, 64, 0, 66 } });
  smaller.Compare("a smaller field");
  smaller.ForBoth([](vtkDeformVolumeFilter* filter) { filter->SetOutsideModeToExtrapolate(); });
  smaller.Compare("a smaller field that is extrapolated");
}

TEST(DeformFieldsInPlace, Masks)
{
  Fields fields(glm::dvec3(0.7, 1.3, 0.9));
  fields.ForBoth(
    [](vtkDeformVolumeFilter* filter) { filter->SetOutputBoundsModeToVolumeBounds(); });
  fields.Compare("a field");
  const auto active =
    MakeArray<vtkUnsignedCharArray>("ActiveTetrahedra", fields.Volume->GetNumberOfCells());
  active->Fill(31);
  fields.Volume->GetCellData()->AddArray(active);
  fields.Compare("a mask");
  for (const vtkIdType cell : { 100000, 100001, 150000 })
  {
    active->SetValue(cell, 3);
    active->Modified();
    fields.CompareOutputs();
    // The field has not changed: only the part that the mask affects is resampled.
    EXPECT_LT(GetReported(fields.Tested.Filter, "Bricks resampled"),
      GetReported(fields.Tested.Filter, "Bricks of the volume"));
  }
  // Changes of vectors of the field, with a log.
  vtkNew<vtkArrayChanges> log;
  log->SetArray(fields.Floats->GetPointData()->GetVectors());
  fields.Compare("a log");
  int parts = 0;
  for (const vtkIdType point : { 123456, 23456, 230000 })
  {
    fields.GetVectors()[3 * point] += 0.2F;
    log->AddTuples(point, point);
    fields.Compare("a logged vector");
    parts += GetReported(fields.Tested.Filter, "Bricks resampled") <
        GetReported(fields.Tested.Filter, "Bricks of the volume")
      ? 1
      : 0;
  }
  // Without a copy of the field, the first logged change causes a whole update. A device with
  // memory of its own has a copy of the field.
  EXPECT_EQ(parts, deformvolume::GetDeviceAbilities("").OwnMemory ? 3 : 2);
}

TEST(DeformFieldsInPlace, Misuse)
{
  Fields fields(glm::dvec3(0.7, 1.3, 0.9));
  fields.Compare("a field");
  const vtkIdType last = fields.Floats->GetNumberOfPoints() - 1;
  const vtkIdType points[3] = { 0, 123456, last };
  for (const vtkIdType point : points)
  {
    for (const float wrong : { std::numeric_limits<float>::quiet_NaN(),
           std::numeric_limits<float>::infinity(), -1e9F, 3e38F })
    {
      float& value = fields.GetVectors()[3 * point + point % 3];
      const float before = value;
      value = wrong;
      fields.Floats->GetPointData()->GetVectors()->Modified();
      fields.Tested.Filter->Update();
      EXPECT_EQ(fields.Tested.TakeErrors(), 1);
      EXPECT_TRUE(HasPart(fields.Tested.LastError,
        std::isfinite(wrong) ? "16,383"
                             : "Vector " + std::to_string(point) + " of the displacement field"));
      value = before;
    }
  }
  fields.Compare("all vectors valid again");
  // The filter finds the values of another array, and values that were reallocated.
  vtkNew<vtkFloatArray> copy;
  copy->DeepCopy(fields.Floats->GetPointData()->GetVectors());
  fields.Floats->GetPointData()->SetVectors(copy);
  fields.Compare("another array");
  copy->Resize(2 * copy->GetNumberOfTuples()); // reallocates without a new modified time
  fields.GetVectors()[5000] += 1.0F;
  fields.Volume->GetPointData()->GetScalars()->Modified();
  fields.Compare("memory that was reallocated");
}

} // namespace
