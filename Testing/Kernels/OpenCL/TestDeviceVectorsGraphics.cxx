// SPDX-License-Identifier: BSD-3-Clause
// Copies between the host and vectors on a device with its own memory.
#include "DeformerCase.h"
#include "DeviceNeeds.h"
#include "DeviceVectors.h"
#include "EditedVolume.h"
#include "FakeDriver.h"
#include "VectorConverter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

using namespace deformvolume;

namespace
{

// The bytes of a few numbers that the host and the device exchange.
constexpr std::uint64_t Few = 256;

class Transfers : public testing::Test
{
protected:
  void SetUp() override { SKIP_UNLESS_GRAPHICS(); }

  void Reset()
  {
    FakeDriver::Get().BytesRead = 0;
    FakeDriver::Get().BytesWritten = 0;
  }

  DeformerCase Case = MakeCase({ { 0, 21, 0, 18, -1, 17 } }, { { 1, 1, 1 } }, MakeJitter(5, 0.15));
  std::size_t Points = static_cast<std::size_t>(this->Case.GetNumberOfVoxels());
  std::uint64_t Bytes = 12 * this->Points;
  std::vector<float> Displacements = this->Case.GetDisplacements();
  std::vector<std::int16_t> Values = MakeRandomValues<std::int16_t>(this->Points, 3);
  std::vector<VolumeArray> Arrays{ MakeArray(this->Values) };
};

} // namespace

TEST_F(Transfers, WrittenVectorsAreCopiedOnce)
{
  const auto vectors = std::make_shared<DeviceVectors>("", this->Points);
  ASSERT_FALSE(vectors->AreInHostMemory());
  this->Reset();
  vectors->Write(this->Displacements.data());
  EXPECT_EQ(FakeDriver::Get().BytesWritten, this->Bytes);
  vectors->Write(this->Displacements.data(), { { { 100, 150 } } });
  EXPECT_EQ(FakeDriver::Get().BytesWritten, this->Bytes + 50 * 12);
  EXPECT_EQ(FakeDriver::Get().BytesRead, 0U) << "read before Read() was called";
  vectors->Read();
  vectors->Read();
  EXPECT_EQ(FakeDriver::Get().BytesRead, this->Bytes);
  vectors->Write(this->Displacements.data(), { { { 200, 205 } }, { { 208, 210 } } });
  vectors->Read();
  EXPECT_EQ(FakeDriver::Get().BytesRead, this->Bytes + 10 * 12)
    << "only the changed vectors must be read";
  this->Reset();
  vectors->Write(this->Displacements.data(), { { { 7000, 7005 } }, { { 208, 210 } } });
  vectors->Read();
  EXPECT_EQ(FakeDriver::Get().BytesRead, 7U * 12U) << "only the two ranges must be read";
  EXPECT_EQ(std::memcmp(vectors->Read(), this->Displacements.data(), this->Bytes), 0);
}

// Points with reported changes cause a partial update of the output. The box of the changes is
// found on the device.
TEST_F(Transfers, PartsOfAFieldUpdatePartsOfTheOutput)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  EditedVolume edited(Extent{ { -5, 140, 0, 100, 3, 80 } });
  const DisplacementField field = edited.GetField();
  const auto vectors = std::make_shared<DeviceVectors>("", edited.GetNumberOfNodes());
  vectors->Write(edited.Displacements.data());
  VolumeDeformer deformer;
  edited.SendAll(deformer, Route::Field);
  EditedOutputs outputs(edited);
  DeformRequest request = outputs.MakeRequest(edited);
  request.Incremental = true;
  deformer.SetDisplacementField(field, vectors);
  deformer.Deform(request);
  outputs.SetLast(request);
  std::mt19937 random(7);
  int parts = 0;
  for (int edit = 0; edit < 10; ++edit)
  {
    const std::vector<float> last = edited.Displacements;
    edited.Move(random, edit % 3, 0.4F);
    PointRanges changes;
    for (std::size_t point = 0; point < edited.GetNumberOfNodes(); ++point)
    {
      if (!std::equal(last.begin() + 3 * point, last.begin() + 3 * point + 3,
            edited.Displacements.begin() + 3 * point))
      {
        changes.push_back({ { point, point + 1 } });
      }
    }
    vectors->Write(edited.Displacements.data(), changes);
    this->Reset();
    deformer.SetDisplacementField(field, vectors);
    // Six numbers for each sub-brick of 16 x 8 x 8 cells, and the indices of the sub-bricks.
    EXPECT_LE(FakeDriver::Get().BytesRead, 24U * 12 * 14 * 10 + Few);
    EXPECT_LE(FakeDriver::Get().BytesWritten, 24U * 12 * 14 * 10 + Few);
    const DeformReport report = deformer.Deform(request);
    VolumeDeformer fresh;
    edited.SendAll(fresh, Route::Field);
    EditedOutputs expected(edited);
    ExpectSame(report, fresh.Deform(expected.MakeRequest(edited)));
    ASSERT_TRUE(outputs == expected) << "edit " << edit;
    parts += report.NumberOfResampledBricks < report.NumberOfBricks ? 1 : 0;
  }
  EXPECT_GE(parts, 7);
  // Without reported changes, the output is computed again.
  edited.Displacements[30] += 0.25F;
  vectors->Write(edited.Displacements.data());
  deformer.SetDisplacementField(field, vectors);
  deformer.Deform(request);
  VolumeDeformer fresh;
  edited.SendAll(fresh, Route::Field);
  EditedOutputs expected(edited);
  fresh.Deform(expected.MakeRequest(edited));
  EXPECT_TRUE(outputs == expected);
  // A partial change of vectors after displacements from the host.
  edited.Displacements[33] += 0.25F;
  edited.SendDisplacements(deformer, Route::Field);
  deformer.Deform(request);
  edited.Displacements[33] -= 0.25F;
  edited.Displacements[36] += 0.25F;
  vectors->Write(edited.Displacements.data(), { { { 12, 13 } } });
  deformer.SetDisplacementField(field, vectors);
  deformer.Deform(request);
  edited.SendAll(fresh, Route::Field);
  fresh.Deform(expected.MakeRequest(edited));
  EXPECT_TRUE(outputs == expected);
}

namespace
{

// A large field, whose vectors a kernel converts in two portions, and a volume where they meet.
class LargeField : public testing::Test
{
protected:
  void SetUp() override
  {
    SKIP_UNLESS_GRAPHICS();
    SKIP_WITHOUT_DOUBLE_PRECISION();
    this->Field.Dimensions = { { Size, Size, Size } };
    this->Field.Vectors = this->Vectors.data();
    this->Field.ToDisplacement = { { 0.5, 0.1, 0, -0.1, 0.25, 0, 0, 0.2, 0.5 } };
    std::mt19937 random(11);
    std::uniform_real_distribution<float> vector(-0.3F, 0.3F);
    std::generate(this->Vectors.begin(), this->Vectors.end(), [&] { return vector(random); });
    this->Grid.VertexExtent = { { 0, Size - 1, 0, Size - 1, 108, Size - 1 } };
    this->Load(this->Deformer);
    this->Request.OutputExtent = this->Grid.VertexExtent;
    this->Request.Outputs = { this->Output.data() };
    this->Request.Coverage = this->Coverage.data();
  }

  void Load(VolumeDeformer& deformer) const
  {
    deformer.SetVoxelGrid(this->Grid);
    deformer.SetArrays({ MakeArray(this->Values) });
  }

  // Deforms the volume, and expects the output of vectors that are on the device.
  DeformReport Deform()
  {
    const DeformReport report = this->Deformer.Deform(this->Request);
    const auto vectors = std::make_shared<DeviceVectors>("", Points);
    vectors->Write(this->Vectors.data());
    VolumeDeformer other;
    this->Load(other);
    other.SetDisplacementField(this->Field, vectors);
    std::vector<std::int16_t> output(Voxels);
    std::vector<signed char> coverage(Voxels);
    DeformRequest request = this->Request;
    request.Incremental = false;
    request.Outputs = { output.data() };
    request.Coverage = coverage.data();
    other.Deform(request);
    EXPECT_TRUE(this->Output == output);
    EXPECT_TRUE(this->Coverage == coverage);
    EXPECT_GT(std::count(coverage.begin(), coverage.end(), 1), static_cast<int>(Voxels) / 2);
    return report;
  }

  static constexpr int Size = 130;
  static constexpr std::size_t Points = std::size_t{ Size } * Size * Size;
  static constexpr std::size_t Voxels = std::size_t{ Size } * Size * 22;
  VoxelGrid Grid;
  std::vector<std::int16_t> Values = MakeRandomValues<std::int16_t>(Voxels, 5);
  std::vector<float> Vectors = std::vector<float>(3 * Points);
  DisplacementField Field;
  VolumeDeformer Deformer;
  DeformRequest Request;
  std::vector<std::int16_t> Output = std::vector<std::int16_t>(Voxels);
  std::vector<signed char> Coverage = std::vector<signed char>(Voxels);
};

} // namespace

TEST_F(LargeField, IsConvertedOnTheDevice)
{
  ASSERT_GT(Points, VectorConverter::PointsOfPortion);
  FakeDriver::Get().BytesWritten = 0;
  this->Deformer.SetDisplacementField(this->Field);
  EXPECT_LE(FakeDriver::Get().BytesWritten, 12 * Points + Few);
  this->Deform();
  // Another matrix. The caller states that no vector has changed.
  this->Field.ToDisplacement[0] = 0.25;
  const PointRanges none;
  this->Deformer.SetDisplacementField(this->Field, &none);
  this->Deform();
}

TEST_F(LargeField, OnlyStatedChangesAreSent)
{
  this->Deformer.SetDisplacementField(this->Field);
  this->Request.Incremental = true;
  this->Deform();
  this->Request.LastOutputs = { this->Output.data() };
  this->Request.LastCoverage = this->Coverage.data();
  // On both sides of the border between portions, and in the next row.
  const std::size_t first = VectorConverter::PointsOfPortion - 20;
  const PointRanges changes{ { { first + Size + 5, first + Size + 10 } },
    { { first, first + 25 } } };
  DeformReport report;
  for (int edit = 0; edit < 2; ++edit) // the first one finds which points move which bricks
  {
    for (const auto& range : changes)
    {
      for (std::size_t i = 3 * range[0]; i < 3 * range[1]; ++i)
      {
        this->Vectors[i] += 0.25F;
      }
    }
    FakeDriver::Get().BytesWritten = 0;
    this->Deformer.SetDisplacementField(this->Field, &changes);
    EXPECT_LE(FakeDriver::Get().BytesWritten, 100000U);
    report = this->Deform();
  }
  EXPECT_LT(report.NumberOfResampledBricks, report.NumberOfBricks / 2);
}

// Vectors on the device whose changes are known, after a field from the host.
TEST_F(LargeField, VectorsOnTheDeviceFollow)
{
  const auto vectors = std::make_shared<DeviceVectors>("", Points);
  vectors->Write(this->Vectors.data());
  this->Request.Incremental = true;
  this->Request.LastOutputs = { this->Output.data() };
  this->Request.LastCoverage = this->Coverage.data();
  const auto moveLast = [&]
  {
    this->Vectors[3 * Points - 3] += 0.25F;
    vectors->Write(this->Vectors.data(), { { { Points - 1, Points } } });
    this->Deformer.SetDisplacementField(this->Field, vectors);
    return this->Deform();
  };
  moveLast();
  moveLast();
  const DeformReport report = moveLast();
  EXPECT_LT(report.NumberOfResampledBricks, report.NumberOfBricks);
  const std::vector<float> before = this->Vectors;
  std::reverse(this->Vectors.begin(), this->Vectors.end());
  this->Deformer.SetDisplacementField(this->Field);
  this->Deform();
  const PointRanges first{ { { 0, 1 } } };
  for (int edit = 0; edit < 2; ++edit)
  {
    this->Vectors[0] += 0.25F;
    this->Deformer.SetDisplacementField(this->Field, &first);
    this->Deform();
  }
  this->Vectors = before;
  moveLast();
}

TEST_F(LargeField, UnusableVectorsAreErrors)
{
  this->Deformer.SetDisplacementField(this->Field);
  float& last = this->Vectors.back();
  const float was = last;
  for (const float bad : { 40000.0F, std::numeric_limits<float>::quiet_NaN() })
  {
    last = bad;
    const PointRanges changes{ { { Points - 1, Points } } };
    try
    {
      this->Deformer.SetDisplacementField(this->Field, &changes);
      ADD_FAILURE() << "no error for " << bad;
    }
    catch (const Error& error)
    {
      EXPECT_NE(std::string(error.what()).find("point " + std::to_string(Points - 1) + " "),
        std::string::npos)
        << error.what();
    }
    EXPECT_THROW(this->Deformer.Deform(this->Request), Error);
    // All vectors are sent again.
    last = was;
    this->Deformer.SetDisplacementField(this->Field, &changes);
    this->Deform();
  }
}
