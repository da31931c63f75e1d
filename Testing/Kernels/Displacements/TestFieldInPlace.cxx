// SPDX-License-Identifier: BSD-3-Clause
// Fields that are read in place, compared with copied fields of the same displacements. Results
// must be the same bit for bit with all kernels.
#include "Device.h"
#include "DeviceNeeds.h"
#include "EditedVolume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

using namespace deformvolume;

namespace
{

// Vectors at the voxels of a volume, with a border around them.
struct Vectors
{
  explicit Vectors(const EditedVolume& volume, int border)
    : Values(std::make_shared<std::vector<float>>())
  {
    const Extent& extent = volume.Shape.VertexExtent;
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Field.Dimensions[axis] = static_cast<int>(GetSize(extent, axis)) + 2 * border;
      this->Field.IndexToField[4 * axis + 3] = border - extent[2 * axis];
    }
    for (std::int64_t point = 0; point < GetNumberOfPoints(this->Field); ++point)
    {
      const auto x = static_cast<double>(point % this->Field.Dimensions[0]);
      const auto y = static_cast<double>(point / this->Field.Dimensions[0]);
      this->Values->push_back(static_cast<float>(2.0 * std::sin(0.1 * y)));
      this->Values->push_back(static_cast<float>(std::cos(0.13 * x) + 0.37));
      this->Values->push_back(static_cast<float>(1.5 * std::sin(0.07 * x + 0.011 * y)));
    }
    this->Field.Vectors = this->Values->data();
  }

  DisplacementField GetInPlace() const
  {
    DisplacementField field = this->Field;
    field.Owner = this->Values;
    return field;
  }

  std::shared_ptr<std::vector<float>> Values;
  DisplacementField Field;
};

std::int64_t Deform(const EditedVolume& volume, const DisplacementField& field, Resampling method,
  EditedOutputs& outputs)
{
  VolumeDeformer deformer;
  deformer.SetDevice("");
  deformer.SetVoxelGrid(volume.Shape);
  deformer.SetArrays(volume.GetArrays());
  volume.SendMasks(deformer);
  deformer.SetDisplacementField(field);
  DeformRequest request = outputs.MakeRequest(volume);
  request.Method = method;
  return deformer.Deform(request).NumberOfCoveredVoxels;
}

} // namespace

TEST(FieldInPlace, EqualsACopy)
{
  EditedVolume volume;
  for (const int border : { 0, 3 })
  {
    Vectors vectors(volume, border);
    const std::array<double, 9> matrices[] = { { { 1, 0, 0, 0, 1, 0, 0, 0, 1 } },
      { { -0.7, 0, 0, 0, 1.0 / 3.0, 0, 0, 0, 1.9 } },
      { { 0.8, -0.6, 0.1, 0.6, 0.8, -0.3, 0.01, 1.0 / 7.0, 1.1 } } };
    for (const std::array<double, 9>& matrix : matrices)
    {
      vectors.Field.ToDisplacement = matrix;
      for (const Resampling method : { Resampling::Exact, Resampling::ExactByCell,
             Resampling::ExactByColumns, Resampling::ExactByLanes })
      {
        SCOPED_TRACE("method " + std::to_string(static_cast<int>(method)));
        EditedOutputs expected(volume);
        EditedOutputs found(volume);
        std::int64_t covered = 0;
        try
        {
          covered = Deform(volume, vectors.Field, method, expected);
        }
        catch (const Error& error)
        {
          EXPECT_EQ(method, Resampling::ExactByLanes) << error.what();
          continue; // the device has too little local memory
        }
        EXPECT_GT(covered, 1000);
        EXPECT_EQ(Deform(volume, vectors.GetInPlace(), method, found), covered);
        EXPECT_TRUE(found == expected);
      }
    }
    volume.Blanked.assign(
      static_cast<std::size_t>(GetNumberOfPoints(volume.Shape.VertexExtent)), 0);
    volume.Blanked[12345] = 1;
  }
}

// Changes may be reported in any order, also twice, for fields in place and for copied fields.
TEST(FieldInPlace, ChangesInAnyOrder)
{
  const EditedVolume volume;
  for (const bool isInPlace : { true, false })
  {
    SCOPED_TRACE(isInPlace ? "in place" : "copied");
    Vectors vectors(volume, 0);
    const DisplacementField field = isInPlace ? vectors.GetInPlace() : vectors.Field;
    VolumeDeformer deformer;
    deformer.SetDevice("");
    deformer.SetVoxelGrid(volume.Shape);
    deformer.SetArrays(volume.GetArrays());
    volume.SendMasks(deformer);
    deformer.SetDisplacementField(field);
    EditedOutputs found(volume);
    const DeformRequest request = found.MakeRequest(volume);
    deformer.Deform(request);
    const std::size_t points = vectors.Values->size() / 3;
    const PointRanges changes{ { { points - 700, points - 300 } },
      { { points / 2, points / 2 + 90 } }, { { 40, 900 } }, { { 60, 70 } } };
    for (const auto& range : changes)
    {
      for (std::size_t i = range[0]; i < range[1]; ++i)
      {
        (*vectors.Values)[3 * i] += 0.75F;
      }
    }
    deformer.SetDisplacementField(field, &changes);
    const std::int64_t covered = deformer.Deform(request).NumberOfCoveredVoxels;
    EditedOutputs expected(volume);
    EXPECT_EQ(Deform(volume, vectors.Field, request.Method, expected), covered);
    EXPECT_TRUE(found == expected);
  }
}

// The matrix applies to copied fields, too.
TEST(FieldInPlace, MatrixEqualsScaledVectors)
{
  const EditedVolume volume;
  Vectors vectors(volume, 1);
  EditedOutputs expected(volume);
  EditedOutputs found(volume);
  vectors.Field.ToDisplacement = { { 2, 0, 0, 0, 2, 0, 0, 0, 2 } };
  Deform(volume, vectors.GetInPlace(), Resampling::Exact, found);
  for (float& value : *vectors.Values)
  {
    value *= 2.0F;
  }
  vectors.Field.ToDisplacement = DisplacementField().ToDisplacement;
  Deform(volume, vectors.Field, Resampling::Exact, expected);
  EXPECT_TRUE(found == expected);
}

// Vectors that are read in place may have any values. Voxels with invalid vectors are discarded.
TEST(FieldInPlace, InvalidVectorsDiscardVoxels)
{
  const EditedVolume volume;
  Vectors vectors(volume, 0);
  EditedOutputs outputs(volume);
  const std::int64_t before = Deform(volume, vectors.GetInPlace(), Resampling::Exact, outputs);
  for (const float wrong :
    { std::numeric_limits<float>::quiet_NaN(), 3e38F, -std::numeric_limits<float>::infinity() })
  {
    for (std::size_t i = 30001; i < 30100; ++i)
    {
      (*vectors.Values)[i] = wrong;
    }
    for (const Resampling method : { Resampling::Exact, Resampling::ExactByCell })
    {
      if (GetDeviceAbilities("").OwnMemory)
      {
        // Vectors that are sent to the device are copied, and checked.
        EXPECT_THROW(Deform(volume, vectors.GetInPlace(), method, outputs), Error);
        continue;
      }
      const std::int64_t covered = Deform(volume, vectors.GetInPlace(), method, outputs);
      EXPECT_LT(covered, before);
      EXPECT_GT(covered, before - 10000);
    }
    // A copied field is checked on the host, unless the kernels check it.
    EXPECT_THROW(Deform(volume, vectors.Field, Resampling::Exact, outputs), Error);
  }
}

// The owner is kept as long as the vectors are used, and not longer.
TEST(FieldInPlace, KeepsItsOwner)
{
  const EditedVolume volume;
  VolumeDeformer deformer;
  volume.SendAll(deformer, Route::Mesh);
  Vectors vectors(volume, 0);
  const long alone = vectors.Values.use_count();
  deformer.SetDisplacementField(vectors.GetInPlace());
  const long held = vectors.Values.use_count();
  EXPECT_TRUE(held == alone + 1 || held == alone); // a device with its own memory has a copy
  deformer.SetDisplacementField(vectors.Field);
  EXPECT_EQ(vectors.Values.use_count(), alone);
  deformer.SetDisplacementField(vectors.GetInPlace());
  volume.SendAll(deformer, Route::Runs);
  EXPECT_EQ(vectors.Values.use_count(), alone);
  deformer.SetDisplacementField(vectors.GetInPlace());
  deformer.ReleaseMemory();
  EXPECT_EQ(vectors.Values.use_count(), alone);
}
