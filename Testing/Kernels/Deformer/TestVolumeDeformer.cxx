// SPDX-License-Identifier: BSD-3-Clause
// Each kernel, on a volume small enough for Oclgrind, which checks every memory access.
#include "DeformerCase.h"
#include "DeviceNeeds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

using namespace deformvolume;

namespace
{

void Check(const DeformerCase& tiny, Route route, bool embedding = true)
{
  const UsualArrays usual(tiny.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  const reference::Result reference = ResampleByReference(tiny);
  if (embedding)
  {
    ExpectEmbedding(reference);
  }
  ExpectEqualsReference(tiny, reference, arrays, LoadAndRun(tiny, arrays, route));
}

// Two voxels move by `move`, one after the other. The second update resamples a part of the output
// by cell, in memory of the device: the memory of the caller is not aligned.
void CheckUpdate(double move)
{
  DeformerCase tiny = MakeCase({ { 0, 7, 0, 15, 0, 3 } }, NoScale, MakeJitter(8, 0.1), 3);
  const auto values = MakeRandomValues<std::int16_t>(tiny.GetNumberOfVoxels(), 2);
  const std::vector<VolumeArray> arrays{ MakeArray(values) };
  const auto size = static_cast<std::size_t>(GetNumberOfPoints(tiny.Output));
  std::vector<char> output(2 * size + 1);
  std::vector<signed char> coverage(size);
  DeformRequest request;
  request.Method = Resampling::ExactByCell;
  request.OutputExtent = tiny.Output;
  request.Outputs = { output.data() + 1 };
  request.Coverage = coverage.data();
  request.Incremental = true;
  VolumeDeformer deformer;
  tiny.Displacements[(16 + 2) * 8 + 3][0] += static_cast<std::int64_t>(256.0 * move);
  Load(deformer, tiny, arrays, Route::Field);
  deformer.Deform(request);
  tiny.Displacements.back()[0] += static_cast<std::int64_t>(256.0 * move);
  MoveByField(deformer, tiny);
  request.LastOutputs = { output.data() + 1 };
  request.LastCoverage = coverage.data();
  const DeformReport report = deformer.Deform(request);
  // Some sections of the only brick were resampled: the changed extent is only a part of the
  // output.
  EXPECT_LT(GetNumberOfPoints(report.ChangedExtent), GetNumberOfPoints(tiny.Output));
  VolumeDeformer fresh;
  Load(fresh, tiny, arrays, Route::Field);
  const Deformed wanted = RunDeformer(fresh, tiny, arrays, Resampling::ExactByCell);
  EXPECT_EQ(report.NumberOfCoveredVoxels, wanted.Report.NumberOfCoveredVoxels);
  EXPECT_EQ(report.Overlapping, move > 1.0);
  EXPECT_EQ(report.Overlapping, wanted.Report.Overlapping);
  EXPECT_EQ(report.NumberOfInvertedTetrahedra, wanted.Report.NumberOfInvertedTetrahedra);
  EXPECT_TRUE(std::equal(coverage.begin(), coverage.end(), wanted.Coverage.begin()));
  EXPECT_EQ(std::memcmp(output.data() + 1, wanted.GetOutput<char>(0), 2 * size), 0);
}

} // namespace

TEST(VolumeDeformer, TinyUndeformed)
{
  Check(MakeCase({ { 0, 4, -1, 2, 0, 3 } }, NoScale, [](const glm::dvec3& index) { return index; }),
    Route::Mesh);
}

TEST(VolumeDeformer, TinyByMesh)
{
  Check(MakeCase({ { -1, 3, 0, 3, 0, 4 } }, NoScale, MakeJitter(1, 0.15)), Route::Mesh);
}

TEST(VolumeDeformer, TinyByRuns)
{
  auto jitter = MakeJitter(7, 0.15);
  DeformerCase tiny = MakeCase({ { -1, 4, 0, 3, 0, 4 } }, NoScale,
    [&jitter](const glm::dvec3& index) { return index.y < 2 ? index : jitter(index); });
  tiny.Unlinked.assign(tiny.GetNumberOfVoxels(), false);
  tiny.Unlinked[40] = true;
  tiny.Blanked.assign(tiny.GetNumberOfVoxels(), 0);
  tiny.Blanked[75] = 1;
  Check(tiny, Route::Runs);
}

TEST(VolumeDeformer, TinyByField)
{
  Check(MakeCase({ { 0, 3, 0, 4, 1, 5 } }, NoScale, MakeJitter(2, 0.15)), Route::Field);
}

TEST(VolumeDeformer, TinyFolded)
{
  Check(MakeCase({ { 0, 3, 0, 3, 0, 3 } }, NoScale, MakeJitter(3, 1.0)), Route::Field, false);
}

TEST(VolumeDeformer, TinyUpdate)
{
  CheckUpdate(0.5);
}

TEST(VolumeDeformer, TinyFoldedUpdate)
{
  CheckUpdate(2.5);
}

TEST(VolumeDeformer, TinyMasks)
{
  DeformerCase tiny = MakeCase({ { 0, 3, 0, 3, 0, 3 } }, NoScale, MakeJitter(4, 0.15));
  tiny.Blanked.assign(64, 0);
  tiny.Blanked[21] = 1;
  tiny.Active.assign(27, 31);
  tiny.Active[26] = 0x13;
  tiny.Unlinked.assign(64, false);
  tiny.Unlinked[63] = true;
  Check(tiny, Route::Mesh);
}

TEST(VolumeDeformer, TinyClipped)
{
  DeformerCase tiny = MakeCase({ { 0, 3, 0, 3, 0, 3 } }, NoScale, MakeJitter(4, 0.15));
  tiny.Distances.assign(64, 1.0F);
  tiny.Distances[21] = -0.5F;
  tiny.Distances[22] = -1.5F;
  Check(tiny, Route::Field);
}

namespace
{

void CheckTiny(Resampling method, const DeformerCase& tiny)
{
  const UsualArrays usual(tiny.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  VolumeDeformer deformer;
  Load(deformer, tiny, arrays, Route::Field);
  const reference::Result reference = ResampleByReference(tiny);
  ExpectEmbedding(reference);
  ExpectEqualsReference(tiny, reference, arrays, RunDeformer(deformer, tiny, arrays, method));
}

} // namespace

TEST(VolumeDeformer, TinyByLanes)
{
  SKIP_WITHOUT_VECTORS()
  CheckTiny(
    Resampling::ExactByLanes, MakeCase({ { 0, 5, 0, 3, -1, 2 } }, NoScale, MakeJitter(6, 0.15)));
}

// A volume of several sections, with deferred cells on its border and inside.
TEST(VolumeDeformer, TinyByColumns)
{
  for (const double amplitude : { 0.0, 0.15 })
  {
    SCOPED_TRACE(amplitude);
    DeformerCase tiny = MakeCase({ { 0, 5, 0, 3, -1, 2 } }, NoScale, MakeJitter(6, amplitude));
    CheckTiny(Resampling::ExactByColumns, tiny);
    tiny.Active.assign(75, 31);
    tiny.Active[37] = 0x13;
    CheckTiny(Resampling::ExactByColumns, tiny);
  }
}
