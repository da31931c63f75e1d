// SPDX-License-Identifier: BSD-3-Clause
// Incremental updates after certain edits equal whole outputs, and resample few bricks.
// TestEdits.cxx has random edits.
#include "EditedVolume.h"
#include "KernelParameters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <random>

using namespace deformvolume;

namespace
{

class Incremental : public WayTest
{
};

} // namespace

// Edits of the volume's sides, of a hole, and of masks. They change which voxels are covered, but
// not the number of covered voxels: counters alone cannot detect the change.
class IncrementalBorders : public Incremental
{
protected:
  IncrementalBorders()
    : Edited(MakeVolume(Extent{ { 0, 64, 0, 64, 0, 128 } }, false))
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Edited.Output[2 * axis] -= 4;
      this->Edited.Output[2 * axis + 1] += 4;
    }
  }

  // The displacement of a node that lies on a voxel.
  float* At(int x, int y, int z)
  {
    return &this->Edited.Displacements[3 * this->Edited.GetNode({ { x, y, z } })];
  }
  unsigned char& BlankedAt(int x, int y, int z)
  {
    this->Edited.Blanked.resize(GetNumberOfPoints(this->Edited.Shape.VertexExtent));
    return this->Edited.Blanked[(z * 65 + y) * 65 + x];
  }

  void Start()
  {
    this->Both.SendAll(this->Edited, GetRoute());
    this->Both.Deform(this->Edited, GetRoute());
  }

  // Updates both deformers. Returns whether the number of covered voxels is unchanged.
  bool Update()
  {
    const std::int64_t before = this->Both.WholeReport.NumberOfCoveredVoxels;
    this->Edited.SendMasks(this->Both.Whole);
    this->Edited.SendMasks(this->Both.Updated);
    this->Both.Deform(this->Edited, GetRoute());
    this->Parts += this->Both.IsPart();
    return this->Both.WholeReport.NumberOfCoveredVoxels == before;
  }

  EditedVolume Edited;
  Twins Both;
  int Parts = 0; // number of partial updates
};

TEST_P(IncrementalBorders, OneSideMovesOutTheOtherIn)
{
  this->Start();
  for (int y = 0; y < this->Edited.Nodes[1]; ++y)
  {
    for (int x = 0; x < this->Edited.Nodes[0]; ++x)
    {
      this->At(x, y, 0)[2] = -1.0F;
      this->At(x, y, 16)[2] = -1.0F;
    }
  }
  EXPECT_TRUE(this->Update())
    << "the number of covered voxels must not change: one plane is added, another one is removed";
  EXPECT_EQ(this->Parts, 1);
}

TEST_P(IncrementalBorders, MovingHole)
{
  this->BlankedAt(32, 32, 64) = 1;
  this->Start();
  int same = 0;
  for (const float shift : { 1.0F, 2.0F, -1.0F, 0.0F })
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      this->At(4, 4, 8)[axis] = shift;
      same += this->Update();
    }
  }
  EXPECT_GT(same, 0) << "no edit kept the number of covered voxels";
  EXPECT_EQ(this->Parts, 12);
}

TEST_P(IncrementalBorders, MaskChangesWhileTheInsideMoves)
{
  this->BlankedAt(32, 32, 64) = 1;
  this->Start();
  int same = 0;
  for (int step = 1; step <= 3; ++step)
  {
    // The hole moves, and a node far away moves, too.
    this->BlankedAt(32, 32, 63 + step) = 0;
    this->BlankedAt(32, 32, 64 + step) = 1;
    *this->At(4, 4, 4) = 0.25F * static_cast<float>(step);
    same += this->Update();
  }
  EXPECT_GT(same, 0) << "no edit kept the number of covered voxels";
  EXPECT_EQ(this->Parts, 3);
}

TEST_P(Incremental, LocalEditsRunFewBricks)
{
  EditedVolume volume = MakeVolume(Extent{ { -5, 140, 0, 100, 3, 80 } });
  VolumeDeformer deformer;
  volume.SendAll(deformer, GetRoute());
  EditedOutputs outputs(volume);
  DeformRequest request = outputs.MakeRequest(volume);
  request.Incremental = true;
  const DeformReport first = deformer.Deform(request);
  EXPECT_EQ(first.NumberOfResampledBricks, first.NumberOfBricks);
  EXPECT_EQ(first.NumberOfBricks, 1 * 7 * 5);
  outputs.SetLast(request);
  // A node inside the volume moves. Only the bricks around it change.
  const std::int32_t node = volume.GetNode({ { 12, 6, 5 } });
  volume.Displacements[3 * node] = 0.5F;
  volume.SendDisplacements(deformer, GetRoute());
  const DeformReport second = deformer.Deform(request);
  EXPECT_GE(second.NumberOfResampledBricks, 1);
  EXPECT_LE(second.NumberOfResampledBricks, 1 * 2 * 2);
  // The node is at (91, 48, 43), and moves vertices that are less than 8 voxels away. Sub-bricks
  // add a few voxels.
  const Extent near{ { 91 - 8 - 16, 91 + 8 + 16, 48 - 8 - 8, 48 + 8 + 8, 43 - 8 - 8, 43 + 8 + 8 } };
  for (int end = 0; end < 6; ++end)
  {
    const int beyond = second.ChangedExtent[end] - near[end];
    EXPECT_GE(end % 2 ? -beyond : beyond, 0) << "extent bound " << end;
  }
  EXPECT_GE(GetNumberOfPoints(second.ChangedExtent), 8 * 8 * 8);
  EXPECT_EQ(second.NumberOfCoveredVoxels, first.NumberOfCoveredVoxels);
  // A node on the boundary of the mesh changes what is covered. Neighboring cells may own the
  // samples that become free.
  volume.Displacements[3 * volume.GetNode({ { 12, 6, 0 } }) + 2] = 1.5F;
  volume.SendDisplacements(deformer, GetRoute());
  const DeformReport third = deformer.Deform(request);
  EXPECT_LE(third.NumberOfResampledBricks, 1 * 4 * 3);
  EXPECT_LT(third.NumberOfCoveredVoxels, first.NumberOfCoveredVoxels);
  // Nothing changed.
  volume.SendDisplacements(deformer, GetRoute());
  const DeformReport same = deformer.Deform(request);
  EXPECT_EQ(same.NumberOfResampledBricks, 0);
  EXPECT_EQ(GetNumberOfPoints(same.ChangedExtent), 0);
  // Without the last output in the request, everything is resampled.
  request.LastOutputs.clear();
  const DeformReport last = deformer.Deform(request);
  EXPECT_EQ(last.NumberOfResampledBricks, last.NumberOfBricks);
  EXPECT_EQ(last.ChangedExtent, request.OutputExtent);
}

namespace
{

// Changes a mask at single voxels or cells near a corner where eight sub-bricks meet, one after the
// other.
class IncrementalMasks : public testing::Test
{
protected:
  void SetUp() override
  {
    this->Case.Output[0] = 0;
    this->Arrays = { MakeArray(this->Values) };
    this->Wanted = std::make_unique<VolumeDeformer>();
    Load(*this->Wanted, this->Case, this->Arrays, Route::Field);
    Load(this->Updated, this->Case, this->Arrays, Route::Field);
  }

  DeformReport Deform(
    VolumeDeformer& deformer, std::vector<float>& output, std::vector<signed char>& coverage) const
  {
    DeformRequest request;
    request.Interpolation = this->Interpolation;
    request.OutputExtent = this->Case.Output;
    request.Outputs = { output.data() };
    request.Coverage = coverage.data();
    request.Incremental = true;
    if (&deformer == &this->Updated)
    {
      request.LastOutputs = { output.data() };
      request.LastCoverage = coverage.data();
    }
    return deformer.Deform(request);
  }

  // Sends the masks to both deformers, and compares their outputs.
  void Update(const std::vector<unsigned char>& blanked, const std::vector<unsigned char>& active)
  {
    const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(this->Case.Output));
    this->Values1.resize(voxels);
    this->Coverage1.resize(voxels);
    std::vector<float> values(voxels);
    std::vector<signed char> coverage(voxels);
    for (VolumeDeformer* deformer : { this->Wanted.get(), &this->Updated })
    {
      deformer->SetBlanked(blanked.data());
      deformer->SetActiveTetrahedra(active.data());
    }
    this->Deform(*this->Wanted, values, coverage);
    const DeformReport report = this->Deform(this->Updated, this->Values1, this->Coverage1);
    this->Parts += report.NumberOfResampledBricks < report.NumberOfBricks;
    ASSERT_EQ(coverage, this->Coverage1);
    ASSERT_EQ(std::memcmp(values.data(), this->Values1.data(), voxels * sizeof(float)), 0);
  }

  // The output is twice as fine as the volume, so that cells are aligned. Samples lie on the border
  // of the volume, but not on the plane that separates sub-bricks on x. Patches of the output end
  // at that plane: an update of a sub-brick writes no voxel of the next sub-brick.
  DeformerCase Case = MakeCase(
    { { 0, 48, 0, 48, 0, 48 } }, { { 2, 2, 2 } },
    [](const glm::dvec3& index) { return 2.0 * index - glm::dvec3(0.5, 0.0, 0.0); }, 0);
  std::vector<float> Values =
    MakeRandomValues<float>(static_cast<std::size_t>(this->Case.GetNumberOfVoxels()), 3);
  std::vector<VolumeArray> Arrays;
  std::unique_ptr<VolumeDeformer> Wanted;
  VolumeDeformer Updated;
  std::vector<float> Values1;
  std::vector<signed char> Coverage1;
  deformvolume::Interpolation Interpolation = deformvolume::Interpolation::Linear;
  int Parts = 0;
};

} // namespace

TEST_F(IncrementalMasks, MaskChangesBesideASubBrick)
{
  std::vector<unsigned char> blanked(static_cast<std::size_t>(this->Case.GetNumberOfVoxels()));
  std::vector<unsigned char> active(
    static_cast<std::size_t>(GetNumberOfCells(this->Case.VoxelGrid.VertexExtent)), 31);
  int changes = 0;
  for (const auto interpolation :
    { deformvolume::Interpolation::Linear, deformvolume::Interpolation::Cubic })
  {
    SCOPED_TRACE(interpolation == deformvolume::Interpolation::Cubic ? "cubic interpolation"
                                                                     : "linear interpolation");
    this->Interpolation = interpolation;
    ASSERT_NO_FATAL_FAILURE(this->Update(blanked, active));
    EXPECT_EQ(this->Parts, changes)
      << "an update with another interpolation must resample everything";
    for (const int y : { 0, 20 })
    {
      // Sub-bricks meet at x = 32.
      for (int x = 28; x <= 36; ++x)
      {
        for (const bool ofCells : { false, true })
        {
          SCOPED_TRACE(testing::Message() << "x " << x << " y " << y << " of cells " << ofCells);
          unsigned char& value =
            ofCells ? active[(20 * 48 + y) * 48 + x] : blanked[(20 * 49 + y) * 49 + x];
          value = ofCells ? 0 : 1;
          ASSERT_NO_FATAL_FAILURE(this->Update(blanked, active));
          value = ofCells ? 31 : 0;
          ASSERT_NO_FATAL_FAILURE(this->Update(blanked, active));
          changes += 2;
        }
      }
    }
  }
  EXPECT_EQ(this->Parts, changes);
}

// Sums of products do not reproduce special values: cells with such a value are interpolated in
// double precision. Their neighbors are not, no matter which cells an update resamples.
TEST_F(IncrementalMasks, SpecialValuesBesideASubBrick)
{
  const auto voxelAt = [](int x, int y)
  { return static_cast<std::size_t>((20 * 49 + y) * 49 + x); };
  const float specials[] = { std::numeric_limits<float>::max(),
    std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(), -0.0F };
  int y = 4;
  for (const float special : specials)
  {
    this->Values[voxelAt(36, y)] = special; // sub-bricks meet at x = 32
    y += 12;
  }
  this->Wanted->SetArrays(this->Arrays);
  this->Updated.SetArrays(this->Arrays);
  std::vector<unsigned char> blanked(this->Values.size());
  const std::vector<unsigned char> active(
    static_cast<std::size_t>(GetNumberOfCells(this->Case.VoxelGrid.VertexExtent)), 31);
  this->Update(blanked, active);
  y = 4;
  for (const float special : specials)
  {
    SCOPED_TRACE(testing::Message() << special);
    blanked[voxelAt(10, y)] = 1;
    ASSERT_NO_FATAL_FAILURE(this->Update(blanked, active));
    y += 12;
  }
  EXPECT_EQ(this->Parts, 4);
}

namespace
{

class IncrementalFolds : public WayTest
{
protected:
  IncrementalFolds() { this->Edited.Method = GetMethod(); }

  void Deform()
  {
    for (VolumeDeformer* deformer : { &this->Both.Whole, &this->Both.Updated })
    {
      this->Edited.SendMasks(*deformer);
    }
    this->Both.Deform(this->Edited, GetRoute());
  }
  bool IsFolded() const { return this->Both.WholeReport.NumberOfInvertedTetrahedra > 0; }

  // Large enough that moving one node affects only a part.
  EditedVolume Edited{ Extent{ { -5, 140, 0, 74, 3, 78 } } };
  Twins Both;
};

} // namespace

// Random edits of a folded volume. With this seed edit 28 detects the mutation contested-twice:
// cells that are resampled again must keep the voxels that they have won from other cells. The
// edits of TestEdits.cxx hardly ever detect it.
TEST_P(IncrementalFolds, EqualWholeUpdates)
{
  constexpr int edits = 30;
  if (GetNumberOf(edits) < edits)
  {
    GTEST_SKIP() << "30 edits take too long on this device with this resampling method";
  }
  EditedVolume& edited = this->Edited;
  edited.Blanked.resize(GetNumberOfPoints(edited.Shape.VertexExtent));
  edited.Active.resize(GetNumberOfCells(edited.Shape.VertexExtent), 31);
  this->Both.SendAll(edited, GetRoute());
  std::mt19937 random(19);
  int parts = 0;
  int foldedParts = 0;
  int overlapping = 0;
  for (int i = 0; i < edits; ++i)
  {
    SCOPED_TRACE("edit " + std::to_string(i));
    // The volume stays folded until the last edit.
    const bool unfolds = i == edits - 1;
    const bool folds = i == 3;
    switch (unfolds ? 0 : folds ? 1 : 2 + random() % 8)
    {
      case 0:
        std::fill(edited.Displacements.begin(), edited.Displacements.end(), 0.25F);
        break;
      case 1:
      case 2:
        edited.MoveInside(random, 14.0F);
        break;
      case 3:
        edited.Move(random, 0, 14.0F);
        break;
      case 4:
        edited.Move(random, 1, 1.5F);
        break;
      case 5:
        edited.Blanked[random() % edited.Blanked.size()] ^= 1;
        break;
      case 6:
        edited.Active[random() % edited.Active.size()] = random() % 32;
        break;
      case 7: // whole voxels put samples on creases
        std::transform(edited.Displacements.begin(), edited.Displacements.end(),
          edited.Displacements.begin(), [](float v) { return v > 7.0F ? 8.0F : v; });
        break;
      case 8:
        break; // nothing
      default:
        edited.Move(random, 0, 1.5F);
    }
    ASSERT_NO_FATAL_FAILURE(this->Deform());
    parts += this->Both.IsPart();
    foldedParts += this->Both.IsPart() && this->IsFolded();
    overlapping += this->Both.IsPart() && this->Both.UpdatedReport.Overlapping;
  }
  EXPECT_GT(parts, foldedParts);
  EXPECT_GT(foldedParts, edits / 3);
  EXPECT_GT(overlapping, edits / 5);
}

// An edit far from an unchanged fold resamples only bricks near the edit.
TEST_P(IncrementalFolds, EditsOutsideTheFoldRunFewBricks)
{
  EditedVolume& edited = this->Edited;
  this->Both.SendAll(edited, GetRoute());
  edited.Displacements[3 * edited.GetNode({ { 4, 5, 5 } })] = 14.0F;
  ASSERT_NO_FATAL_FAILURE(this->Deform());
  EXPECT_TRUE(this->Both.WholeReport.Overlapping);
  float& far = edited.Displacements[3 * edited.GetNode({ { 14, 3, 3 } })];
  for (int i = 1; i <= 3; ++i)
  {
    far = 0.5F * static_cast<float>(i);
    ASSERT_NO_FATAL_FAILURE(this->Deform());
    EXPECT_TRUE(this->Both.UpdatedReport.Overlapping);
    EXPECT_LE(this->Both.UpdatedReport.NumberOfResampledBricks, 3 * 3);
  }
  EXPECT_TRUE(this->Both.IsPart());
  // Unfolding removes all winners: the next output is a whole one. Later updates are partial again.
  edited.Displacements[3 * edited.GetNode({ { 4, 5, 5 } })] = 0.0F;
  ASSERT_NO_FATAL_FAILURE(this->Deform());
  EXPECT_FALSE(this->IsFolded());
  EXPECT_FALSE(this->Both.IsPart());
  far = 0.25F;
  ASSERT_NO_FATAL_FAILURE(this->Deform());
  EXPECT_TRUE(this->Both.IsPart());
}

// Inverted tetrahedra are counted per span of cells. An update counts only those spans again that
// it resamples. Here the second span of a cuboid is folded. An edit of the next span resamples the
// folded span, but not the first one.
TEST_P(IncrementalFolds, InvertedTetrahedraAreCountedOnce)
{
  static_assert(DEFORMVOLUME_CUBOID_X == 2 * DEFORMVOLUME_SPAN, "spans of a cuboid");
  EditedVolume& edited = this->Edited;
  edited = MakeVolume(Extent{ { -5, 140, 0, 74, 3, 40 } });
  const auto getInSpan = [&](int span) -> float&
  {
    const int node = (2 * span + 1) * DEFORMVOLUME_SPAN / 2 / EditedVolume::Step;
    return edited.Displacements[3 * edited.GetNode({ { node, 3, 3 } }) + 1];
  };
  this->Both.SendAll(edited, GetRoute());
  getInSpan(1) = 14.0F;
  ASSERT_NO_FATAL_FAILURE(this->Deform());
  EXPECT_TRUE(this->IsFolded());
  getInSpan(2) = 0.5F;
  ASSERT_NO_FATAL_FAILURE(this->Deform());
  EXPECT_TRUE(this->Both.IsPart());
}

INSTANTIATE_TEST_SUITE_P(Ways, Incremental, GetWays(), GetWayName);
INSTANTIATE_TEST_SUITE_P(Ways, IncrementalBorders, GetWays(), GetWayName);
INSTANTIATE_TEST_SUITE_P(Ways, IncrementalFolds, GetWays(), GetWayName);
