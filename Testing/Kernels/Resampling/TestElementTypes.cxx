// SPDX-License-Identifier: BSD-3-Clause
// Values of the output: element types, several arrays at once, labels, background values.
#include "AllTypes.h"
#include "ArrayText.h"
#include "DeformerCase.h"
#include "DeviceNeeds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>

using namespace deformvolume;

namespace
{

const Extent TypedVolume{ { -3, 8, 2, 10, -9, -1 } };

glm::dvec3 Stay(const glm::dvec3& index)
{
  return index;
}

DeformerCase Shift(const glm::dvec3& shift)
{
  return MakeCase(
    TypedVolume, { { 1, 1, 1 } }, [&shift](const glm::dvec3& index) { return index + shift; }, 0);
}

/// Expects the input's bits at the output voxels that a shift by whole voxels gives.
void ExpectShifted(const Deformed& deformed, const std::vector<VolumeArray>& arrays)
{
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    SCOPED_TRACE(i);
    const std::size_t bytes =
      GetNumberOfPoints(TypedVolume) * arrays[i].Components * GetElementSize(arrays[i].Type);
    ASSERT_EQ(deformed.Outputs[i].size(), bytes);
    EXPECT_EQ(std::memcmp(deformed.Outputs[i].data(), arrays[i].Data, bytes), 0);
  }
  EXPECT_EQ(deformed.Report.NumberOfCoveredVoxels, GetNumberOfPoints(TypedVolume));
  EXPECT_EQ(deformed.Report.NumberOfInvertedTetrahedra, 0);
  EXPECT_FALSE(deformed.Report.Overlapping);
  for (const signed char mark : deformed.Coverage)
  {
    ASSERT_EQ(mark, 1);
  }
}

} // namespace

// Resamples one array at a time, of the types that the kernel by lanes interpolates.
TEST(ElementTypes, UndeformedVolumeComesOutBitForBit)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const AllTypes types(GetNumberOfPoints(TypedVolume), 0.0, true);
  const DeformerCase still = Shift(glm::dvec3(0.0));
  for (const VolumeArray& array : types.Arrays)
  {
    if (FitsFloat(array) && array.Components == 1)
    {
      SCOPED_TRACE(static_cast<int>(array.Type));
      VolumeDeformer deformer;
      Load(deformer, still, { array }, Route::Field);
      ExpectShifted(RunDeformer(deformer, still, { array }), { array });
    }
  }
}

TEST(ElementTypes, ShiftByWholeVoxelsIsBitExact)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const AllTypes types(GetNumberOfPoints(TypedVolume), 0.0, true);
  for (const glm::dvec3& shift : { glm::dvec3(4.0, -7.0, 1.0), glm::dvec3(-1.0, 2.0, 30.0) })
  {
    ExpectShifted(LoadAndRun(Shift(shift), types.Arrays), types.Arrays);
  }
}

TEST(ElementTypes, DeformedValuesEqualReference)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const DeformerCase jittered =
    MakeCase({ { -2, 5, 0, 6, 3, 9 } }, { { 1, 1, 1 } }, MakeJitter(5, 0.15));
  const reference::Result reference = ResampleByReference(jittered);
  ExpectEmbedding(reference);
  const AllTypes types(jittered.GetNumberOfVoxels(), -5.0, false);
  ExpectEqualsReference(jittered, reference, types.Arrays, LoadAndRun(jittered, types.Arrays));
}

TEST(ElementTypes, NearLargeIntegersOf64BitsAreRoundedToNearest)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  // Values that a double cannot hold, which differ by a few units. Interpolated values must lie
  // between them.
  const DeformerCase shifted = MakeCase({ { 0, 6, 0, 6, 0, 6 } }, { { 1, 1, 1 } },
    [](const glm::dvec3& index) { return index + glm::dvec3(0.25, 0.5, 0.125); });
  AllTypes types(shifted.GetNumberOfVoxels(), 0.0, false);
  std::vector<std::int64_t>& values = types.OneInt64;
  const std::int64_t base = std::numeric_limits<std::int64_t>::max() - 1000;
  for (std::size_t voxel = 0; voxel < values.size(); ++voxel)
  {
    values[voxel] = base + static_cast<std::int64_t>(voxel % 7) * 16;
  }
  const Deformed deformed = LoadAndRun(shifted, types.Arrays);
  const auto* const output = deformed.GetOutput<std::int64_t>(types.Find<std::int64_t>());
  const reference::Result reference = ResampleByReference(shifted);
  for (std::size_t voxel = 0; voxel < reference.Voxels.size(); ++voxel)
  {
    if (!reference.Voxels[voxel].empty())
    {
      // Exact integers: numerators of about 2^26 times differences of at most 96.
      const auto& containing = reference.Voxels[voxel].front();
      std::int64_t sum = 0;
      for (int k = 0; k < 4; ++k)
      {
        sum += containing.Numerators[k] * (values[containing.Vertices[k]] - base);
      }
      const std::int64_t value = output[voxel] - base;
      EXPECT_LE(std::abs(2 * (value * containing.Denominator - sum)), containing.Denominator);
    }
  }
}

// Values are equal within each plane and far apart between planes, and voxels move within their
// planes. So each output voxel has the value of its plane, which may be an end of the type.
TEST(ElementTypes, FarIntegersOf64BitsDoNotMix)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const DeformerCase within = MakeCase({ { 0, 12, 0, 11, 0, 6 } }, { { 1, 1, 1 } },
    [jitter = MakeJitter(3, 0.2)](const glm::dvec3& index)
    { return index + jitter(index) * glm::dvec3(1.0, 1.0, 0.0); });
  AllTypes types(within.GetNumberOfVoxels(), 0.0, false);
  const auto largest = std::numeric_limits<std::int64_t>::max();
  const std::int64_t signedValues[2] = { largest, largest / 2 + 12345 };
  const std::uint64_t unsignedValues[2] = { 0, 1760000000123456789 };
  const auto isOdd = [](std::size_t voxel) { return voxel / (13 * 12) % 2; };
  for (std::size_t voxel = 0; voxel < types.OneInt64.size(); ++voxel)
  {
    types.OneInt64[voxel] = signedValues[isOdd(voxel)];
    types.OneUInt64[voxel] = unsignedValues[isOdd(voxel)];
  }
  const Deformed deformed = LoadAndRun(within, types.Arrays);
  const auto* const signedOutput = deformed.GetOutput<std::int64_t>(types.Find<std::int64_t>());
  const auto* const unsignedOutput = deformed.GetOutput<std::uint64_t>(types.Find<std::uint64_t>());
  const Extent& output = within.Output;
  const auto plane = static_cast<std::size_t>(GetSize(output, 0) * GetSize(output, 1));
  int covered = 0;
  for (std::size_t voxel = 0; voxel < deformed.Coverage.size(); ++voxel)
  {
    if (deformed.Coverage[voxel] != 0)
    {
      const int z = output[4] + static_cast<int>(voxel / plane);
      ASSERT_EQ(signedOutput[voxel], signedValues[z % 2]);
      ASSERT_EQ(unsignedOutput[voxel], unsignedValues[z % 2]);
      ++covered;
    }
  }
  EXPECT_GT(covered, 700);
}

TEST(ElementTypes, IntegersAreRoundedToNearestEvenAndStayInRange)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const DeformerCase half = MakeCase(
    { { 0, 4, 0, 2, 0, 2 } }, { { 1, 1, 1 } },
    [](const glm::dvec3& index) { return index + glm::dvec3(0.5, 0.0, 0.0); }, 0);
  AllTypes types(half.GetNumberOfVoxels(), 9.0, false);
  std::vector<std::uint8_t>& values = types.OneUInt8;
  const std::array<std::uint8_t, 5> row{ { 0, 1, 2, 255, 255 } };
  for (std::size_t voxel = 0; voxel < values.size(); ++voxel)
  {
    values[voxel] = row[voxel % 5];
  }
  const Deformed deformed = LoadAndRun(half, types.Arrays);
  const auto* const output = deformed.GetOutput<std::uint8_t>(types.Find<std::uint8_t>());
  // Samples halfway between two voxels: 0.5 -> 0, 1.5 -> 2, 128.5 -> 128, 255.
  const std::array<std::uint8_t, 6> expected{ { 9, 0, 2, 128, 255, 9 } };
  for (std::int64_t voxel = 0; voxel < GetNumberOfPoints(half.Output); ++voxel)
  {
    EXPECT_EQ(+output[voxel], +expected[voxel % 6]) << "voxel " << voxel;
  }
}

TEST(ElementTypes, BackgroundIsClampedToTheType)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  DeformerCase still = MakeCase({ { 0, 2, 0, 2, 0, 2 } }, { { 1, 1, 1 } }, Stay, 2);
  for (const double background : { 1e30, -1e30, 1.5, -0.75 })
  {
    SCOPED_TRACE(background);
    const AllTypes types(still.GetNumberOfVoxels(), background, false);
    ExpectEqualsReference(
      still, ResampleByReference(still), types.Arrays, LoadAndRun(still, types.Arrays));
  }
}

TEST(ElementTypes, NotANumberStaysWithinItsTetrahedra)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const DeformerCase jittered = MakeCase({ { 0, 7, 0, 7, 0, 7 } }, { { 2, 2, 2 } },
    [](const glm::dvec3& index)
    { return 2.0 * index + glm::dvec3(0.25 * index.y, 0.5, 0.125 * index.x); });
  AllTypes types(jittered.GetNumberOfVoxels(), 0.0, false);
  types.OneFloat32[8 * 8 * 3 + 8 * 4 + 3] = std::numeric_limits<float>::quiet_NaN();
  types.OneFloat64[8 * 8 * 5 + 8 * 2 + 3] = std::numeric_limits<double>::infinity();
  const reference::Result reference = ResampleByReference(jittered);
  const Deformed deformed = LoadAndRun(jittered, types.Arrays);
  ExpectEqualsReference(jittered, reference, types.Arrays, deformed);
  int spoilt = 0;
  for (std::size_t voxel = 0; voxel < reference.Voxels.size(); ++voxel)
  {
    spoilt += std::isnan(deformed.GetOutput<float>(types.Find<float>())[voxel]) ? 1 : 0;
  }
  EXPECT_GT(spoilt, 0);
  EXPECT_LE(spoilt, 64);
}

TEST(ElementTypes, LargeFloatsInLargeCellsStayFinite)
{
  // 9.97e36 is NetCDF's fill value for floats.
  for (const double size : { 1.5, 3.0, 7.0 })
  {
    SCOPED_TRACE(size);
    const DeformerCase sheared = MakeCase({ { 0, 20, 0, 4, 0, 4 } }, { { 1, 1, 1 } },
      [=](const glm::dvec3& index)
      { return size * index + glm::dvec3(0.3 * index.y, 0.1 * index.x, 0.2 * index.y); });
    UsualArrays usual(sheared.GetNumberOfVoxels());
    std::fill(usual.Floats.begin(), usual.Floats.end(), 9.96921e36F);
    const std::vector<VolumeArray> arrays = usual.Get();
    const Deformed deformed = LoadAndRun(sheared, arrays);
    ExpectEqualsReference(sheared, ResampleByReference(sheared), arrays, deformed);
  }
}
