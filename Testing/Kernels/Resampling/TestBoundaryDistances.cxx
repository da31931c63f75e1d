// SPDX-License-Identifier: BSD-3-Clause
// Boundaries between voxels: samples with a negative interpolated boundary distance are not
// covered. Distances are multiples of 1/16: the kernels and the reference add them without
// rounding.
#include "DeformerCase.h"
#include "DeviceNeeds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

using namespace deformvolume;

namespace
{

const Extent Volume{ { -3, 17, 0, 9, 1, 8 } };

float MakeDistance(std::mt19937& random)
{
  return (static_cast<float>(random() % 65) - 32.0F) / 16.0F;
}

// Random distances at all voxels, or at one voxel in 60. In the second case most cells are
// resampled by lanes.
std::vector<float> MakeDistances(std::size_t size, unsigned int seed, bool ofAll)
{
  std::mt19937 random(seed);
  std::vector<float> distances(size, 1.5F);
  for (float& distance : distances)
  {
    if (ofAll || random() % 60 == 0)
    {
      distance = MakeDistance(random);
    }
  }
  return distances;
}

// Distances from the plane x = place of the undeformed volume, negative on its low side.
std::vector<float> MakePlane(const Extent& extent, double place)
{
  std::vector<float> distances;
  for (std::int64_t i = 0; i < GetNumberOfPoints(extent); ++i)
  {
    distances.push_back(
      static_cast<float>(static_cast<double>(extent[0] + i % GetSize(extent, 0)) - place));
  }
  return distances;
}

Deformed RunWith(VolumeDeformer& deformer, const DeformerCase& deformerCase,
  const std::vector<VolumeArray>& arrays, const std::vector<float>& distances)
{
  deformer.SetBoundaryDistances(distances.empty() ? nullptr : distances.data());
  return RunDeformer(deformer, deformerCase, arrays);
}

} // namespace

TEST(BoundaryDistances, MisuseIsAnError)
{
  VolumeDeformer deformer;
  deformer.SetDevice("");
  const std::vector<float> distances(GetNumberOfPoints(Volume), -1.0F);
  EXPECT_THROW(deformer.SetBoundaryDistances(distances.data()), Error);
  DeformerCase still = MakeCase(Volume, NoScale, [](const glm::dvec3& index) { return index; });
  const UsualArrays usual(distances.size());
  const std::vector<VolumeArray> arrays = usual.Get();
  still.Distances = distances;
  Load(deformer, still, arrays, Route::Field);
  EXPECT_EQ(RunDeformer(deformer, still, arrays).Report.NumberOfCoveredVoxels, 0);
  deformer.SetBoundaryDistances(nullptr);
  EXPECT_EQ(
    RunDeformer(deformer, still, arrays).Report.NumberOfCoveredVoxels, GetNumberOfPoints(Volume));
}

TEST(BoundaryDistances, NonNegativeSamplesStay)
{
  const DeformerCase moved =
    MakeCase(Volume, NoScale, [](const glm::dvec3& index) { return index * 1.25; });
  const UsualArrays usual(moved.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  VolumeDeformer deformer;
  Load(deformer, moved, arrays, Route::Field);
  const Deformed all = RunDeformer(deformer, moved, arrays);
  for (const float distance :
    { 0.0F, -0.0F, 1e-30F, 3.0F, std::numeric_limits<float>::infinity(), std::nanf("") })
  {
    SCOPED_TRACE(distance);
    const Deformed kept =
      RunWith(deformer, moved, arrays, std::vector<float>(moved.GetNumberOfVoxels(), distance));
    EXPECT_EQ(kept.Outputs, all.Outputs);
    EXPECT_EQ(kept.Coverage, all.Coverage);
  }
}

TEST(BoundaryDistances, PlaneLiesBetweenVoxels)
{
  // Along x the output has sixteen samples per voxel of the volume.
  const Extent extent{ { -1, 6, 0, 4, 0, 3 } };
  DeformerCase fine = MakeCase(
    extent, { { 16, 2, 2 } }, [](const glm::dvec3& index) { return index * glm::dvec3(16, 2, 2); });
  const UsualArrays usual(fine.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  for (const double place : { 2.0, 2.3125, 3.5, 4.96875 })
  {
    SCOPED_TRACE(place);
    fine.Distances = MakePlane(extent, place);
    const Deformed deformed = LoadAndRun(fine, arrays);
    std::size_t voxel = 0;
    for (int z = fine.Output[4]; z <= fine.Output[5]; ++z)
    {
      for (int y = fine.Output[2]; y <= fine.Output[3]; ++y)
      {
        for (int x = fine.Output[0]; x <= fine.Output[1]; ++x, ++voxel)
        {
          const bool covered = x >= 16.0 * place && x <= 96 && y >= 0 && y <= 8 && z >= 0 && z <= 6;
          ASSERT_EQ(deformed.Coverage[voxel] != 0, covered)
            << "voxel " << x << " " << y << " " << z;
        }
      }
    }
  }
}

TEST(BoundaryDistances, ChunksAndPartsEqualTheWhole)
{
  const glm::dmat3 matrix(0.9, 0.2, 0.1, -0.1, 1.1, 0.2, 0.1, -0.2, 1.0);
  DeformerCase clipped =
    MakeCase(Volume, NoScale, [&](const glm::dvec3& index) { return matrix * index; });
  clipped.Distances = MakeDistances(clipped.GetNumberOfVoxels(), 2, true);
  const UsualArrays usual(clipped.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  const Deformed whole = LoadAndRun(clipped, arrays);
  VolumeDeformer chunked;
  chunked.SetDevice("");
  chunked.SetAllocationLimit(16384);
  Load(chunked, clipped, arrays, Route::Mesh);
  const Deformed inChunks = RunDeformer(chunked, clipped, arrays);
  EXPECT_EQ(inChunks.Coverage, whole.Coverage);
  EXPECT_EQ(inChunks.Outputs, whole.Outputs);
}

TEST(BoundaryDistances, MeshRasterizationAgrees)
{
  // One tetrahedron contains the volume and is shifted by whole voxels: rest coordinates are exact.
  DeformerCase moved =
    MakeCase(Volume, { { 4, 4, 4 } }, [](const glm::dvec3& index) { return 4.0 * index + 8.0; });
  const std::size_t size = moved.GetNumberOfVoxels();
  moved.Distances = MakeDistances(size, 8, true);
  const UsualArrays usual(size);
  const std::vector<VolumeArray> arrays = usual.Get();
  const Deformed exact = LoadAndRun(moved, arrays);
  const std::vector<double> nodes{ -100, -100, -100, 400, -100, -100, -100, 400, -100, -100, -100,
    400 };
  const std::vector<float> displacements(12, 8.0F);
  const Tetrahedron tetrahedron{ { 0, 1, 2, 3 } };
  VolumeDeformer deformer;
  Load(deformer, moved, arrays, Route::Field);
  deformer.SetRestMesh(&tetrahedron, 1, 4, nodes.data());
  deformer.SetNodeDisplacements(displacements.data());
  const Deformed rasterized = RunDeformer(deformer, moved, arrays, Resampling::MeshRasterization);
  EXPECT_EQ(rasterized.Coverage, exact.Coverage);
  EXPECT_GT(exact.Report.NumberOfCoveredVoxels, 1000);
}
