// SPDX-License-Identifier: BSD-3-Clause
// Differences of graphics cards, tested on any device: own memory, no double precision, and
// work-groups of several items.
#include "DeformerCase.h"
#include "DeviceNeeds.h"
#include "DeviceVectors.h"
#include "FakeDriver.h"

#include <gtest/gtest.h>

using namespace deformvolume;

namespace
{

class GraphicsDevice : public testing::Test
{
protected:
  void SetUp() override { SKIP_UNLESS_GRAPHICS(); }

  DeformerCase Case = MakeCase({ { 0, 21, 0, 18, -1, 17 } }, { { 1, 1, 1 } }, MakeJitter(5, 0.15));
  std::vector<std::int16_t> Values =
    MakeRandomValues<std::int16_t>(static_cast<std::size_t>(this->Case.GetNumberOfVoxels()), 3);
  std::vector<VolumeArray> Arrays{ MakeArray(this->Values) };
  VolumeDeformer Deformer;

  std::string GetError(const std::vector<VolumeArray>& arrays)
  {
    Load(this->Deformer, this->Case, arrays, Route::Mesh);
    try
    {
      RunDeformer(this->Deformer, this->Case, arrays);
    }
    catch (const Error& error)
    {
      return error.what();
    }
    return "";
  }
};

} // namespace

TEST_F(GraphicsDevice, EqualsReference)
{
  const reference::Result reference = ResampleByReference(this->Case);
  for (const Route route : { Route::Field, Route::Mesh })
  {
    Load(this->Deformer, this->Case, this->Arrays, route);
    ExpectEqualsReference(
      this->Case, reference, this->Arrays, RunDeformer(this->Deformer, this->Case, this->Arrays));
  }
}

// Without a given size, drivers choose work-groups of one item if the number of items is prime.
TEST_F(GraphicsDevice, WorkGroupSizesAreGiven)
{
  FakeDriver::Get().LaunchesWithoutGroup = 0;
  // Large enough for several work-items, and folded.
  const DeformerCase folded =
    MakeCase({ { 0, 30, 0, 30, 0, 30 } }, { { 1, 1, 1 } }, MakeJitter(3, 1.0));
  const auto values =
    MakeRandomValues<std::int16_t>(static_cast<std::size_t>(folded.GetNumberOfVoxels()), 3);
  const std::vector<VolumeArray> arrays{ MakeArray(values) };
  Load(this->Deformer, folded, arrays, Route::Mesh);
  const DeformReport report = RunDeformer(this->Deformer, folded, arrays).Report;
  EXPECT_TRUE(report.Overlapping);
  EXPECT_EQ(report.NumberOfCoveredVoxels, ResampleByReference(folded).NumberOfCoveredVoxels);
  EXPECT_EQ(FakeDriver::Get().LaunchesWithoutGroup, 0);
}

// Allocated memory counts as a part of the memory of the device, not in addition to it.
TEST_F(GraphicsDevice, MemoryIsCountedOnce)
{
  Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
  RunDeformer(this->Deformer, this->Case, this->Arrays);
  const std::uint64_t held = this->Deformer.GetDeviceMemory();
  // The next output fits neither beside the allocated memory nor into the whole memory.
  FakeDriver::Get().GlobalMemory = held + held / 4;
  DeformerCase larger = this->Case;
  larger.Output[5] += 60;
  EXPECT_THROW(RunDeformer(this->Deformer, larger, this->Arrays), Error);
  FakeDriver::Get().GlobalMemory = 0;
  EXPECT_NO_THROW(RunDeformer(this->Deformer, larger, this->Arrays));
}

// One call for each changed position would take longer than copying the values in between.
TEST_F(GraphicsDevice, ChangedMasksAreUploadedInOneCall)
{
  Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
  this->Case.Blanked.assign(static_cast<std::size_t>(this->Case.GetNumberOfVoxels()), 0);
  this->Case.Blanked[1000] = 1;
  this->Deformer.SetBlanked(this->Case.Blanked.data());
  for (std::size_t i = 3; i + 400 < this->Case.Blanked.size(); i += 397)
  {
    this->Case.Blanked[i] = 1;
  }
  FakeDriver::Get().Writes = 0;
  this->Deformer.SetBlanked(this->Case.Blanked.data());
  EXPECT_EQ(FakeDriver::Get().Writes, 1);
  ExpectEqualsReference(this->Case, ResampleByReference(this->Case), this->Arrays,
    RunDeformer(this->Deformer, this->Case, this->Arrays));
}

// Single precision is exact for integers up to 2^24.
TEST_F(GraphicsDevice, IntegersBeyondSinglePrecision)
{
  const auto size = static_cast<std::size_t>(this->Case.GetNumberOfVoxels());
  const auto ints = MakeRandomValues<std::int32_t>(size, 3);
  const auto longs = MakeRandomValues<std::uint64_t>(size, 3);
  EXPECT_NE(this->GetError({ MakeArray(ints) }).find("double precision"), std::string::npos);
  EXPECT_NE(this->GetError({ MakeArray(longs) }).find("double precision"), std::string::npos);
  EXPECT_EQ(this->GetError({ MakeArray(ints, 1, true), MakeArray(longs, 1, true) }), "");
  EXPECT_EQ(this->GetError({ MakeArray(this->Values) }), "");
}

// A matrix is applied in double precision. If the device has none, it is applied on the host.
TEST_F(GraphicsDevice, MatricesApplyToDeviceVectors)
{
  const auto vectors =
    std::make_shared<DeviceVectors>("", static_cast<std::size_t>(this->Case.GetNumberOfVoxels()));
  std::vector<float> displacements = this->Case.GetDisplacements();
  vectors->Write(displacements.data());
  Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
  const Deformed expected = RunDeformer(this->Deformer, this->Case, this->Arrays);
  FakeDriver::Get().BytesRead = 0;
  this->Deformer.SetNodeDisplacements(vectors);
  EXPECT_LT(FakeDriver::Get().BytesRead, 256U) << "without a matrix no vectors must be read";
  EXPECT_EQ(RunDeformer(this->Deformer, this->Case, this->Arrays).Outputs, expected.Outputs);
  for (float& component : displacements)
  {
    component *= 4.0F; // exact
  }
  vectors->Write(displacements.data());
  this->Deformer.SetNodeDisplacements(vectors, { { 0.25, 0, 0, 0, 0.25, 0, 0, 0, 0.25 } });
  EXPECT_EQ(RunDeformer(this->Deformer, this->Case, this->Arrays).Outputs, expected.Outputs);
}
