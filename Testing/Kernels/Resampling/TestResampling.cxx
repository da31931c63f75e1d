// SPDX-License-Identifier: BSD-3-Clause
// Compares each combination of a deformation, a mask and a smooth cut with the reference, for all
// kernels of the exact resampling, linear and cubic. Links, runs and fields take turns. Run one
// combination with --gtest_filter='*/Bent_Blanked_Opened'. TestElementTypes covers all element
// types. TestPiecewise, TestFolded, TestLargeCells, TestBoundaryDistances and TestSmoothCuts cover
// special cases.
#include "CubicReference.h"
#include "DeformerCase.h"
#include "DeviceNeeds.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <string>
#include <tuple>
#include <vector>

using namespace deformvolume;

namespace
{

const Extent Usual{ { -4, 7, 1, 8, 0, 9 } };

struct Pose
{
  const char* Name;
  /// Whether each output voxel has at most one tetrahedron over it.
  bool IsEmbedding;
  Extent Volume;
  std::function<glm::dvec3(const glm::dvec3&)> (*Make)(unsigned int seed);
};

const std::vector<Pose> Poses{
  { "Resting", true, Usual,
    [](unsigned int) { return std::function([](const glm::dvec3& index) { return index; }); } },
  { "Enlarged", true, Usual,
    [](unsigned int)
    { return std::function([](const glm::dvec3& index) { return 1.5 * index; }); } },
  { "Shrunk", true, Usual,
    [](unsigned int)
    { return std::function([](const glm::dvec3& index) { return 0.5 * index; }); } },
  { "Jittered", true, Usual, [](unsigned int seed) { return MakeJitter(seed, 0.15); } },
  // Some tissue is at rest, the tissue beside it moves.
  { "RestingInPart", true, Usual,
    [](unsigned int seed)
    {
      return std::function([jitter = MakeJitter(seed, 0.15)](const glm::dvec3& index) mutable
        { return index.x < 2.0 ? index : jitter(index); });
    } },
  // All samples lie on faces of cells.
  { "MovedAlongX", true, Usual,
    [](unsigned int seed)
    {
      return std::function([jitter = MakeJitter(seed, 0.17)](const glm::dvec3& index)
        { return glm::dvec3(jitter(index).x, index.y - 2.0, index.z + 5.0); });
    } },
  // Faces of all tetrahedra lie on samples.
  { "Sheared", true, Usual,
    [](unsigned int)
    {
      return std::function([](const glm::dvec3& index)
        { return glm::dvec3(2.0 * index.x + index.y, index.y, index.z); });
    } },
  { "TurnedAndJittered", true, Usual,
    [](unsigned int seed)
    {
      std::mt19937 random(seed);
      return std::function(
        [matrix = MakeRandomMatrix(random, 0.15), jitter = MakeJitter(seed, 0.1)](
          const glm::dvec3& index) { return matrix * jitter(index); });
    } },
  { "Bent", true, Usual,
    [](unsigned int)
    {
      return std::function(
        [](const glm::dvec3& index)
        {
          const double angle = 0.05 * index.x;
          const double radius = 20.0 - index.y;
          return glm::dvec3(
            radius * std::sin(angle), 20.0 - radius * std::cos(angle), 1.25 * index.z);
        });
    } },
  { "CellsOfFiveVoxels", true, { { -1, 3, 0, 3, 2, 4 } },
    [](unsigned int seed)
    {
      return std::function([jitter = MakeJitter(seed, 0.1)](const glm::dvec3& index)
        { return 5.0 * jitter(index) + glm::dvec3(index.y, 0.25 * index.z, index.x); });
    } },
  { "CellsOfFortyVoxels", true, { { 0, 1, 0, 1, 0, 2 } },
    [](unsigned int)
    {
      return std::function([](const glm::dvec3& index)
        { return 40.0 * index + glm::dvec3(index.y, index.z, index.x); });
    } },
  { "Mirrored", false, Usual,
    [](unsigned int)
    {
      return std::function([](const glm::dvec3& index)
        { return glm::dvec3(-1.25 * index.x, index.y + 0.125 * index.x, index.z); });
    } },
  { "FoldedLikeAPage", false, Usual,
    [](unsigned int seed)
    {
      return std::function([crease = 0.25 * (seed % 8)](const glm::dvec3& index)
        { return glm::dvec3(std::abs(index.x - crease), index.y, index.z); });
    } },
  { "InsideOut", false, Usual, [](unsigned int seed) { return MakeJitter(seed, 0.8); } },
  { "Scrambled", false, Usual, [](unsigned int seed) { return MakeJitter(seed, 1.6); } },
};

using Random = std::mt19937;

void Blank(DeformerCase& made, Random& random, unsigned int every)
{
  made.Blanked.resize(made.GetNumberOfVoxels());
  for (unsigned char& voxel : made.Blanked)
  {
    voxel = random() % every == 0 ? 8 : 0;
  }
}

void Unlink(DeformerCase& made, Random& random, unsigned int every)
{
  for (std::int64_t voxel = 0; voxel < made.GetNumberOfVoxels(); ++voxel)
  {
    made.Unlinked.push_back(random() % every == 0);
  }
}

void SwitchOff(DeformerCase& made, Random& random, unsigned int every)
{
  made.Active.resize(GetNumberOfCells(made.VoxelGrid.VertexExtent));
  for (unsigned char& cell : made.Active)
  {
    cell = random() % every == 0 ? static_cast<unsigned char>(random()) : 31;
  }
}

// Distances are multiples of 1/16: the kernels and the reference add them without rounding.
void Clip(DeformerCase& made, Random& random, unsigned int every)
{
  made.Distances.assign(made.GetNumberOfVoxels(), 1.5F);
  for (float& distance : made.Distances)
  {
    if (random() % every == 0)
    {
      distance = (static_cast<float>(random() % 65) - 32.0F) / 16.0F;
    }
  }
}

struct Mask
{
  const char* Name;
  void (*Set)(DeformerCase& made, Random& random);
};

const std::vector<Mask> Masks{
  { "Whole", [](DeformerCase&, Random&) {} },
  // Most cells have all of their tetrahedra. Some of their neighbors do not.
  { "FewTetrahedraOff", [](DeformerCase& made, Random& random) { SwitchOff(made, random, 12); } },
  { "ManyTetrahedraOff", [](DeformerCase& made, Random& random) { SwitchOff(made, random, 2); } },
  { "Blanked", [](DeformerCase& made, Random& random) { Blank(made, random, 10); } },
  { "Unlinked", [](DeformerCase& made, Random& random) { Unlink(made, random, 10); } },
  // Most cells are not clipped. They are resampled by lanes.
  { "ClippedHereAndThere", [](DeformerCase& made, Random& random) { Clip(made, random, 60); } },
  { "Clipped", [](DeformerCase& made, Random& random) { Clip(made, random, 1); } },
  { "AllMasks",
    [](DeformerCase& made, Random& random)
    {
      Blank(made, random, 20);
      Unlink(made, random, 20);
      SwitchOff(made, random, 4);
      Clip(made, random, 8);
    } },
};

// Distance from a sheet across the middle of the volume, bent in steps, in multiples of 1/16.
double GetSheetDistance(const Extent& volume, const glm::dvec3& index)
{
  return index.x - 0.5 * (volume[0] + volume[1]) + 0.25 + 0.25 * std::floor(0.75 * index.y) -
    0.125 * index.z;
}

// Moves the sides of the sheet apart, or into each other, and cuts along the sheet. The cut may end
// inside the volume.
void CutAndMove(DeformerCase& made, Random& random, double apart)
{
  const Extent& volume = made.VoxelGrid.VertexExtent;
  const int end = random() % 2 ? volume[3] : (volume[2] + volume[3] + 1) / 2;
  const auto distance = [&volume](const glm::dvec3& index)
  { return GetSheetDistance(volume, index); };
  CutAlong(made, distance, [end](const glm::dvec3& cell) { return cell.y < end; });
  const reference::Position step{ { std::llround(256.0 * apart), 192, -128 } };
  for (std::size_t voxel = 0; voxel < made.Displacements.size(); ++voxel)
  {
    const int sign = made.CutDistances[voxel] < 0.0F ? -1 : 1;
    for (int axis = 0; axis < 3; ++axis)
    {
      made.Displacements[voxel][axis] += sign * step[axis];
    }
  }
}

struct Cut
{
  const char* Name;
  void (*Make)(DeformerCase& made, Random& random);
};

const std::vector<Cut> Cuts{
  { "Uncut", [](DeformerCase&, Random&) {} },
  { "CutAtRandom",
    [](DeformerCase& made, Random& random)
    {
      const unsigned int every = 1 + random() % 4;
      CutAtRandom(made, random(), every);
    } },
  { "Opened", [](DeformerCase& made, Random& random) { CutAndMove(made, random, 1.25); } },
  { "Overlapping", [](DeformerCase& made, Random& random) { CutAndMove(made, random, -1.5); } },
};

using Row = std::tuple<Pose, Mask, Cut>;

std::string GetName(const Row& row)
{
  const auto& [pose, mask, cut] = row;
  return std::string(pose.Name) + "_" + mask.Name + "_" + cut.Name;
}

class ExactResampling : public testing::TestWithParam<Row>
{
};

} // namespace

TEST_P(ExactResampling, EqualsTheReference)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const auto& [pose, mask, cut] = GetParam();
  const std::string name = GetName(GetParam());
  Random random(std::accumulate(name.begin(), name.end(), 0U,
    [](unsigned int sum, char c) { return 31 * sum + static_cast<unsigned char>(c); }));
  DeformerCase made = MakeCase(pose.Volume, { { 1, 1, 1 } }, pose.Make(random()));
  mask.Set(made, random);
  cut.Make(made, random);
  const reference::Result reference = ResampleByReference(made);
  EXPECT_GT(reference.NumberOfCoveredVoxels, 0);
  if (pose.IsEmbedding && made.Crossed.empty())
  {
    ExpectEmbedding(reference);
  }
  const UsualArrays usual(made.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  const Route route = !made.Unlinked.empty()
    ? (random() % 2 ? Route::Mesh : Route::Runs)
    : std::array<Route, 3>{ { Route::Field, Route::Mesh, Route::Runs } }[random() % 3];
  ExpectEqualsReference(made, reference, arrays, LoadAndRun(made, arrays, route));
  SCOPED_TRACE("cubic interpolation");
  VolumeDeformer deformer;
  Load(deformer, made, arrays, route);
  const std::int64_t cubic = ExpectEqualsCubicReference(made, reference, arrays,
    RunDeformer(deformer, made, arrays, Resampling::Exact, Interpolation::Cubic));
  if (pose.Volume == Usual && name == std::string(pose.Name) + "_Whole_Uncut")
  {
    EXPECT_GT(cubic, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Table, ExactResampling,
  testing::Combine(testing::ValuesIn(Poses), testing::ValuesIn(Masks), testing::ValuesIn(Cuts)),
  [](const testing::TestParamInfo<Row>& row) { return GetName(row.param); });
