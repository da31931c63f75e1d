// SPDX-License-Identifier: BSD-3-Clause
// Copies that partial updates make from and to a device with memory of its own, and copies from it
// that fail.
#include "DeviceNeeds.h"
#include "EditedVolume.h"
#include "FakeDriver.h"

#include <gtest/gtest.h>

using namespace deformvolume;

namespace
{

class IncrementalGraphics : public testing::TestWithParam<Route>
{
protected:
  void SetUp() override
  {
    SKIP_UNLESS_GRAPHICS()
    this->Edited.Blanked.resize(GetNumberOfPoints(this->Edited.Shape.VertexExtent));
    this->Edited.SendAll(this->Deformer, GetParam());
    this->Request.Incremental = true;
    this->Deformer.Deform(this->Request);
    this->Outputs.SetLast(this->Request);
  }

  /// Updates the output after displacements and masks have changed.
  DeformReport Update()
  {
    FakeDriver& driver = FakeDriver::Get();
    driver.BytesRead = driver.BytesWritten = 0;
    this->Edited.SendMasks(this->Deformer);
    this->Edited.SendDisplacements(this->Deformer, GetParam());
    return this->Deformer.Deform(this->Request);
  }
  /// Expects a partial update that equals the output of a new deformer. Returns the number of bytes
  /// read, divided by the bytes of the output.
  double UpdatePart()
  {
    const DeformReport report = this->Update();
    EXPECT_LT(report.NumberOfResampledBricks, report.NumberOfBricks);
    const FakeDriver driver = FakeDriver::Get();
    VolumeDeformer fresh;
    this->Edited.SendAll(fresh, GetParam());
    EditedOutputs expected(this->Edited);
    ExpectSame(report, fresh.Deform(expected.MakeRequest(this->Edited)));
    EXPECT_TRUE(this->Outputs == expected);
    const double bytes = 11.0 * static_cast<double>(GetNumberOfPoints(this->Edited.Output));
    EXPECT_LT(static_cast<double>(driver.BytesWritten), 0.02 * bytes);
    return static_cast<double>(driver.BytesRead) / bytes;
  }
  float* At(int x, int y, int z)
  {
    return &this->Edited.Displacements[3 * this->Edited.GetNode({ { x, y, z } })];
  }

  EditedVolume Edited{ Extent{ { -5, 140, 0, 100, 3, 80 } } };
  VolumeDeformer Deformer;
  EditedOutputs Outputs{ this->Edited };
  DeformRequest Request = this->Outputs.MakeRequest(this->Edited);
};

} // namespace

TEST_P(IncrementalGraphics, LocalEditsReadLittle)
{
  this->At(12, 6, 5)[0] = 0.5F;
  this->UpdatePart(); // also reads the static mapping, to find what the nodes move
  this->At(12, 6, 5)[0] = -0.5F;
  EXPECT_LT(this->UpdatePart(), 0.05) << "edit inside the volume";
  EXPECT_EQ(this->Update().NumberOfResampledBricks, 0);
  EXPECT_LT(FakeDriver::Get().BytesRead, 100000U) << "bytes read without an edit";
  this->At(12, 6, 0)[2] = 1.5F;
  EXPECT_LT(this->UpdatePart(), 0.05) << "edit on a side of the volume";
  this->Edited.Blanked[(40 * 101 + 50) * 146 + 70] = 1;
  EXPECT_LT(this->UpdatePart(), 0.05) << "edit of a mask";
  // The first update after a fold is a whole one.
  this->At(4, 5, 5)[0] = 14.0F;
  EXPECT_TRUE(this->Update().Overlapping);
  this->At(14, 3, 3)[0] = 0.5F;
  EXPECT_LT(this->UpdatePart(), 0.05) << "edit beside a fold";
  this->At(4, 5, 5)[1] = 2.0F;
  EXPECT_LT(this->UpdatePart(), 0.05) << "edit in a fold";
}

// Volumes or outputs that must be divided into chunks or slabs get no partial updates.
TEST_P(IncrementalGraphics, VolumesAndOutputsInParts)
{
  // Memory for 40 planes of an array of four bytes per voxel.
  this->Deformer.SetAllocationLimit(4 * 146 * 101 * 40);
  this->Edited.SendAll(this->Deformer, GetParam());
  for (int i = 0; i < 3; ++i)
  {
    this->At(12, 6, 5)[0] += 0.25F;
    const DeformReport report = this->Update();
    EXPECT_EQ(report.NumberOfResampledBricks, report.NumberOfBricks);
  }
  EditedOutputs expected(this->Edited);
  VolumeDeformer fresh;
  this->Edited.SendAll(fresh, GetParam());
  fresh.Deform(expected.MakeRequest(this->Edited));
  EXPECT_TRUE(this->Outputs == expected);
  this->Deformer.SetAllocationLimit(0);
  this->Edited.SendAll(this->Deformer, GetParam());
  this->Update();
  this->At(12, 6, 5)[0] -= 0.25F;
  this->UpdatePart();
}

TEST_P(IncrementalGraphics, CopiesThatFail)
{
  this->At(12, 6, 5)[0] = 0.5F;
  this->UpdatePart();
  this->At(12, 6, 5)[0] = 1.0F;
  FakeDriver::Get().ReadError = -5;
  EXPECT_THROW(this->Update(), Error);
  FakeDriver::Get().ReadError = 0;
  // The data on the device may be incomplete: the deformer has released it.
  EXPECT_EQ(this->Deformer.GetDeviceMemory(), 0U);
  this->Edited.SendAll(this->Deformer, GetParam());
  const DeformReport report = this->Deformer.Deform(this->Request);
  EXPECT_EQ(report.NumberOfResampledBricks, report.NumberOfBricks);
  this->At(12, 6, 5)[0] = 1.5F;
  this->UpdatePart();
}

INSTANTIATE_TEST_SUITE_P(Routes, IncrementalGraphics,
  testing::Values(Route::Mesh, Route::Runs, Route::Field), GetRouteName);
