// SPDX-License-Identifier: BSD-3-Clause
// Incremental updates against whole ones of another deformer, bit by bit, after random edits of the
// deformation, the masks and the request.
#include "EditedVolume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <memory>
#include <random>

using namespace deformvolume;

namespace
{

enum class Edit
{
  None,
  Node,
  Inside,
  FoldInside,
  Region,
  Half,
  All,
  Fold,
  Unfold,
  Blanked,
  Active,
  Distances,
  NoMasks,
  Extent,
  Background,
  Values,
  Abort,
  Count
};

void Change(EditedVolume& volume, Edit edit, std::mt19937& random)
{
  switch (edit)
  {
    case Edit::Node:
      volume.Move(random, 0, 1.5F);
      break;
    case Edit::Inside:
      volume.MoveInside(random, 2.0F);
      break;
    case Edit::FoldInside:
      volume.MoveInside(random, 14.0F);
      break;
    case Edit::Region:
      volume.Move(random, 1, 1.5F);
      break;
    case Edit::Half:
      volume.Move(random, 5, 1.0F);
      break;
    case Edit::All:
      volume.Move(random, 100, 1.5F);
      break;
    case Edit::Fold:
      volume.Move(random, 0, 14.0F);
      break;
    case Edit::Unfold:
      std::fill(volume.Displacements.begin(), volume.Displacements.end(), 0.25F);
      break;
    case Edit::Blanked:
      volume.Blanked.resize(GetNumberOfPoints(volume.Shape.VertexExtent));
      volume.Blanked[random() % volume.Blanked.size()] ^= 1;
      break;
    case Edit::Active:
      volume.Active.resize(GetNumberOfCells(volume.Shape.VertexExtent), 31);
      volume.Active[random() % volume.Active.size()] = random() % 32;
      break;
    case Edit::Distances:
      volume.Distances.resize(GetNumberOfPoints(volume.Shape.VertexExtent), 1.0F);
      volume.Distances[random() % volume.Distances.size()] =
        static_cast<float>(random() % 64) / 16.0F - 2.0F;
      break;
    case Edit::NoMasks:
      volume.Blanked.clear();
      volume.Active.clear();
      volume.Distances.clear();
      break;
    case Edit::Extent:
      for (int axis = 0; axis < 3; ++axis)
      {
        volume.Output[2 * axis] =
          volume.Shape.VertexExtent[2 * axis] - static_cast<int>(random() % 8) + 4;
        volume.Output[2 * axis + 1] =
          volume.Shape.VertexExtent[2 * axis + 1] + static_cast<int>(random() % 8) - 4;
      }
      break;
    case Edit::Background:
      volume.Background += 1.0;
      break;
    case Edit::Values:
      volume.First[random() % volume.First.size()] ^= 1;
      break;
    default:
      break;
  }
}

// Whether two outputs are the same outside an extent.
bool AreSameOutside(const EditedOutputs& first, const EditedOutputs& second, const Extent& output,
  const Extent& extent)
{
  std::size_t i = 0;
  for (int z = output[4]; z <= output[5]; ++z)
  {
    for (int y = output[2]; y <= output[3]; ++y)
    {
      for (int x = output[0]; x <= output[1]; ++x, ++i)
      {
        const bool isInside = x >= extent[0] && x <= extent[1] && y >= extent[2] &&
          y <= extent[3] && z >= extent[4] && z <= extent[5];
        const bool isSame = first.First[i] == second.First[i] &&
          std::memcmp(&first.Second[2 * i], &second.Second[2 * i], 2 * sizeof(double)) == 0 &&
          first.Coverage[i] == second.Coverage[i];
        if (!isInside && !isSame)
        {
          return false;
        }
      }
    }
  }
  return true;
}

class Incremental : public WayTest
{
};

} // namespace

TEST_P(Incremental, EqualsWholeUpdates)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const Route route = GetRoute();
  EditedVolume volume = MakeVolume();
  VolumeDeformer whole;
  VolumeDeformer incremental;
  volume.SendAll(whole, route);
  volume.SendAll(incremental, route);
  std::mt19937 random(17);
  auto last = std::make_unique<EditedOutputs>(volume);
  bool hasLast = false;
  int parts = 0;
  std::int64_t fewest = 1000000;
  const int edits = GetNumberOf(150);
  for (int i = 0; i < edits; ++i)
  {
    // Small edits come more often: only they are worked on in part.
    static const Edit small[] = { Edit::Node, Edit::Inside, Edit::Region, Edit::Blanked,
      Edit::Active };
    const Edit edit = i < 3 ? Edit::None
      : random() % 3        ? small[random() % std::size(small)]
                            : static_cast<Edit>(random() % static_cast<int>(Edit::Count));
    SCOPED_TRACE("edit " + std::to_string(i) + " of kind " + std::to_string(int(edit)));
    const std::vector<float> sent = volume.Displacements;
    Change(volume, edit, random);
    const PointRanges changes = volume.FindChanges(sent, random);
    for (VolumeDeformer* deformer : { &whole, &incremental })
    {
      if (edit == Edit::Values)
      {
        deformer->SetArrays(volume.GetArrays());
      }
      deformer->SetArrayOptions(volume.GetArrays());
      if (edit == Edit::Blanked || edit == Edit::Active || edit == Edit::NoMasks)
      {
        volume.SendMasks(*deformer);
      }
      volume.SendDisplacements(
        *deformer, route, deformer == &incremental && i % 2 ? &changes : nullptr);
    }
    EditedOutputs expected(volume);
    const DeformReport wanted = whole.Deform(expected.MakeRequest(volume));

    // In place, or from the last output, which has to stay as it is.
    auto next = std::make_unique<EditedOutputs>(volume);
    const bool inPlace = edit != Edit::Extent && random() % 2 == 0;
    const EditedOutputs before = *last;
    DeformRequest request = (inPlace ? *last : *next).MakeRequest(volume);
    request.Incremental = true;
    if (hasLast)
    {
      last->SetLast(request);
    }
    if (edit == Edit::Abort)
    {
      request.Progress = [](double) { return false; };
      volume.Move(random, 0, 1.5F);
      volume.SendDisplacements(incremental, route);
      EXPECT_THROW(incremental.Deform(request), Aborted);
      volume.SendDisplacements(whole, route);
      whole.Deform(expected.MakeRequest(volume));
      request.Progress = nullptr;
      if (random() % 2)
      {
        request.LastOutputs.clear();
      }
    }
    const DeformReport report = incremental.Deform(request);
    if (edit != Edit::Abort)
    {
      ExpectSame(report, wanted);
    }
    if (!inPlace)
    {
      EXPECT_TRUE(*last == before) << "the last output was written to";
      last = std::move(next);
    }
    ASSERT_TRUE(*last == expected);
    EXPECT_EQ(wanted.NumberOfResampledBricks, wanted.NumberOfBricks);
    EXPECT_EQ(wanted.ChangedExtent, volume.Output);
    if (!hasLast || edit == Edit::Extent || edit == Edit::Abort)
    {
      EXPECT_EQ(report.ChangedExtent, volume.Output);
    }
    else
    {
      EXPECT_TRUE(AreSameOutside(before, *last, volume.Output, report.ChangedExtent));
    }
    hasLast = true;
    if (report.NumberOfResampledBricks < report.NumberOfBricks)
    {
      ++parts;
      fewest = std::min(fewest, report.NumberOfResampledBricks);
    }
  }
  EXPECT_GT(parts, edits / 5);
  EXPECT_EQ(fewest, 0) << "an edit of nothing";
}

// Where only vertices inside the mesh move nothing is cleared, as long as nothing folds.
TEST_P(Incremental, EditsInsideEqualWholeUpdates)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const Route route = GetRoute();
  // So deep that these parts reach no border.
  EditedVolume volume = MakeVolume(Extent{ { -5, 140, 0, 74, 3, 78 } });
  Twins twins;
  twins.SendAll(volume, route);
  std::mt19937 random(29);
  int parts = 0;
  int folds = 0;
  const int edits = GetNumberOf(50);
  for (int i = 0; i < edits; ++i)
  {
    SCOPED_TRACE("edit " + std::to_string(i));
    const bool folding = i % 5 == 3;
    const bool unfolding = i % 5 == 4;
    Change(volume, folding ? Edit::FoldInside : unfolding ? Edit::Unfold : Edit::Inside, random);
    ASSERT_NO_FATAL_FAILURE(twins.Deform(volume, route));
    folds += twins.WholeReport.NumberOfInvertedTetrahedra > 0;
    if (twins.IsPart())
    {
      EXPECT_EQ(twins.WholeReport.NumberOfInvertedTetrahedra, 0);
      // What a node moves lies in three bricks on an axis at most.
      EXPECT_LE(twins.UpdatedReport.NumberOfResampledBricks, 3 * 3);
      ++parts;
    }
  }
  EXPECT_GT(folds, edits / 15);
  EXPECT_GT(parts, edits / 10);
}

// Edits that change what is covered, but not how much of it, so that counts do not tell: of two
// sides, of a hole, and of masks.
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

  // A node that lies on a voxel.
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

  // Whether as much is covered as before.
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
  int Parts = 0; // updates that were not whole
};

TEST_P(IncrementalBorders, OneSideGoesOutAndTheOtherIn)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  this->Start();
  for (int y = 0; y < this->Edited.Nodes[1]; ++y)
  {
    for (int x = 0; x < this->Edited.Nodes[0]; ++x)
    {
      this->At(x, y, 0)[2] = -1.0F;
      this->At(x, y, 16)[2] = -1.0F;
    }
  }
  EXPECT_TRUE(this->Update()) << "a plane comes, and one goes";
  EXPECT_EQ(this->Parts, 1);
}

TEST_P(IncrementalBorders, AHoleMoves)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
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
  EXPECT_GT(same, 0) << "the hole never covers as much";
  EXPECT_EQ(this->Parts, 12);
}

TEST_P(IncrementalBorders, AMaskChangesAndWhatIsInsideMoves)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  this->BlankedAt(32, 32, 64) = 1;
  this->Start();
  int same = 0;
  for (int step = 1; step <= 3; ++step)
  {
    // The hole goes elsewhere, and something far away moves.
    this->BlankedAt(32, 32, 63 + step) = 0;
    this->BlankedAt(32, 32, 64 + step) = 1;
    *this->At(4, 4, 4) = 0.25F * static_cast<float>(step);
    same += this->Update();
  }
  EXPECT_GT(same, 0) << "the hole never covers as much";
  EXPECT_EQ(this->Parts, 3);
}

TEST_P(Incremental, LocalEditsRunFewBricks)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
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
  // A node inside moves the bricks that it lies between, and what others own stays as it is.
  const std::int32_t node = volume.GetNode({ { 12, 6, 5 } });
  volume.Displacements[3 * node] = 0.5F;
  volume.SendDisplacements(deformer, GetRoute());
  const DeformReport second = deformer.Deform(request);
  EXPECT_GE(second.NumberOfResampledBricks, 1);
  EXPECT_LE(second.NumberOfResampledBricks, 1 * 2 * 2);
  // It lies at (91, 48, 43), and moves what is less than 8 voxels away; parts of bricks are a few
  // voxels more.
  const Extent near{ { 91 - 8 - 16, 91 + 8 + 16, 48 - 8 - 8, 48 + 8 + 8, 43 - 8 - 8, 43 + 8 + 8 } };
  for (int end = 0; end < 6; ++end)
  {
    const int beyond = second.ChangedExtent[end] - near[end];
    EXPECT_GE(end % 2 ? -beyond : beyond, 0) << end;
  }
  EXPECT_GE(GetNumberOfPoints(second.ChangedExtent), 8 * 8 * 8);
  EXPECT_EQ(second.NumberOfCoveredVoxels, first.NumberOfCoveredVoxels);
  // One on the border of the mesh changes what is covered: neighbours may own what it leaves.
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
  // Without being told where the last output is, all is made.
  request.LastOutputs.clear();
  const DeformReport last = deformer.Deform(request);
  EXPECT_EQ(last.NumberOfResampledBricks, last.NumberOfBricks);
  EXPECT_EQ(last.ChangedExtent, request.OutputExtent);
}

namespace
{

// A mask changes at one place near a corner between eight parts of bricks, each place in turn.
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

  // Sends masks and compares.
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

  // Twice as fine as the volume, so that cells are boxes. Samples lie on the border of the volume,
  // but none on the plane that divides parts on x, and patches of the output end there: then a part
  // beside one that is made anew touches nothing of it.
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
  int Parts = 0;
};

} // namespace

TEST_F(IncrementalMasks, AMaskChangesBesideAPart)
{
  std::vector<unsigned char> blanked(static_cast<std::size_t>(this->Case.GetNumberOfVoxels()));
  std::vector<unsigned char> active(
    static_cast<std::size_t>(GetNumberOfCells(this->Case.VoxelGrid.VertexExtent)), 31);
  this->Update(blanked, active);
  int changes = 0;
  for (const int y : { 0, 20 })
  {
    // Parts meet at 32.
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
  EXPECT_EQ(this->Parts, changes);
}

INSTANTIATE_TEST_SUITE_P(Ways, Incremental, GetWays(), GetWayName);
INSTANTIATE_TEST_SUITE_P(Ways, IncrementalBorders, GetWays(), GetWayName);
