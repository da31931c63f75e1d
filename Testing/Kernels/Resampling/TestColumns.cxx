// SPDX-License-Identifier: BSD-3-Clause
// The kernel by columns: its lists of samples and deferred cells, and that results do not depend on
// work-group sizes and slabs. The other tests of the exact resampling also compare this kernel with
// the kernel by lanes.
#include "DeformerCase.h"
#include "DeviceNeeds.h"

#include <gtest/gtest.h>

using namespace deformvolume;

namespace
{

/// Compares the results for several work-group sizes with the reference, and with each other bit by
/// bit. If asLanes is true, also compares with the kernel by lanes.
void Check(const DeformerCase& deformerCase, bool asLanes = true)
{
  const UsualArrays usual(deformerCase.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  const reference::Result reference = ResampleByReference(deformerCase);
  VolumeDeformer deformer;
  Load(deformer, deformerCase, arrays, Route::Field);
  std::vector<Deformed> all;
  for (const std::size_t group : { 1, 24, 64, 256 })
  {
    SCOPED_TRACE(group);
    deformer.SetWorkGroupSize(group);
    all.push_back(RunDeformer(deformer, deformerCase, arrays, Resampling::ExactByColumns));
    ExpectEqualsReference(deformerCase, reference, arrays, all.back());
    EXPECT_TRUE(all.back().Outputs == all.front().Outputs);
  }
  deformer.SetWorkGroupSize(0);
  if (asLanes && HasVectors())
  {
    const Deformed lanes = RunDeformer(deformer, deformerCase, arrays, Resampling::ExactByLanes);
    EXPECT_TRUE(lanes.Outputs == all.front().Outputs);
  }
  // Slabs of a few planes.
  deformer.SetAllocationLimit(
    4 * GetSize(deformerCase.Output, 0) * GetSize(deformerCase.Output, 1) * 3 * sizeof(float));
  const Deformed slabs = RunDeformer(deformer, deformerCase, arrays, Resampling::ExactByColumns);
  EXPECT_TRUE(slabs.Outputs == all.front().Outputs);
  EXPECT_EQ(slabs.Coverage, all.front().Coverage);
}

DeformerCase MakeSheared(const Extent& extent, double factor, double shear)
{
  return MakeCase(extent, NoScale,
    [=](const glm::dvec3& index)
    { return glm::dvec3(factor * index.x + shear * index.y, factor * index.y, factor * index.z); });
}

} // namespace

TEST(Columns, AtRest)
{
  Check(MakeSheared({ { 0, 40, -3, 17, 1, 19 } }, 1.0, 0.0));
}

TEST(Columns, ManySamplesOnFaces)
{
  // Every vertex lies on a sample. Each of the 256 cells of a layer has more than four samples on
  // its faces.
  Check(MakeSheared({ { 0, 66, 0, 18, 0, 10 } }, 2.0, 1.0));
}

TEST(Columns, MoreCandidatesThanACellTakesAtOnce)
{
  Check(MakeCase({ { 0, 11, 0, 10, 0, 9 } }, NoScale,
    [jitter = MakeJitter(2, 0.12)](const glm::dvec3& index) { return 4.75 * jitter(index); }));
}

TEST(Columns, CellsTooLargeForIntegersOf32Bits)
{
  // The kernels by lanes and by columns interpolate different cells in double precision.
  Check(MakeSheared({ { 0, 11, 0, 10, 0, 9 } }, 4.0, 2.0), false);
}

TEST(Columns, BentCells)
{
  Check(MakeCase({ { 0, 20, 0, 19, 0, 18 } }, NoScale, MakeJitter(7, 0.24)));
}

TEST(Columns, MoreBricksThanALaunchTakes)
{
  const Extent tall{ { 0, 2, 0, 2, 0, 12000 } };
  DeformerCase tallCase = MakeCase(tall, NoScale, MakeJitter(5, 0.15));
  const UsualArrays usual(tallCase.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  VolumeDeformer deformer;
  Load(deformer, tallCase, arrays, Route::Field);
  ExpectEqualsReference(tallCase, ResampleByReference(tallCase), arrays,
    RunDeformer(deformer, tallCase, arrays, Resampling::ExactByColumns));
}

TEST(Columns, UnsupportedOutputs)
{
  DeformerCase far = MakeSheared({ { 0, 4, 0, 4, 0, 4 } }, 1.0, 0.0);
  far.Output[4] += 5000000;
  far.Output[5] += 5000000;
  const UsualArrays usual(far.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  VolumeDeformer deformer;
  Load(deformer, far, arrays, Route::Field);
  try
  {
    RunDeformer(deformer, far, arrays, Resampling::ExactByColumns);
    FAIL() << "expected an error, but none was thrown";
  }
  catch (const Error& error)
  {
    EXPECT_NE(std::string(error.what()).find("columns"), std::string::npos) << error.what();
  }
}
