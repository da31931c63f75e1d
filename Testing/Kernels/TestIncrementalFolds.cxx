// SPDX-License-Identifier: BSD-3-Clause
// Incremental updates of a volume that is folded over: whoever wins a voxel, outputs equal those
// that are made wholly, bit by bit.
#include "EditedVolume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

using namespace deformvolume;

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

  // So large that a node moves a part of it.
  EditedVolume Edited{ Extent{ { -5, 140, 0, 74, 3, 78 } } };
  Twins Both;
};

} // namespace

TEST_P(IncrementalFolds, EqualWholeUpdates)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  EditedVolume& edited = this->Edited;
  edited.Blanked.resize(GetNumberOfPoints(edited.Shape.VertexExtent));
  edited.Active.resize(GetNumberOfCells(edited.Shape.VertexExtent), 31);
  this->Both.SendAll(edited, GetRoute());
  std::mt19937 random(19); // of some seeds, one at which the most of what could be wrong shows
  int parts = 0;
  int foldedParts = 0;
  int overlapping = 0;
  const int edits = GetNumberOf(90);
  for (int i = 0; i < edits; ++i)
  {
    SCOPED_TRACE("edit " + std::to_string(i));
    // Where something folds, it stays so for some edits.
    const bool unfolds = i % 30 == 29;
    const bool folds = i % 30 == 3;
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
      case 7: // whole voxels, so that samples lie on creases
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

// What is folded and stays as it is costs an edit elsewhere nothing.
TEST_P(IncrementalFolds, AnEditElsewhereRunsFewBricks)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
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
  // The fold goes, and with it all winners: a whole output, and parts again afterwards.
  edited.Displacements[3 * edited.GetNode({ { 4, 5, 5 } })] = 0.0F;
  ASSERT_NO_FATAL_FAILURE(this->Deform());
  EXPECT_FALSE(this->IsFolded());
  EXPECT_FALSE(this->Both.IsPart());
  far = 0.25F;
  ASSERT_NO_FATAL_FAILURE(this->Deform());
  EXPECT_TRUE(this->Both.IsPart());
}

INSTANTIATE_TEST_SUITE_P(Ways, IncrementalFolds, GetWays(), GetWayName);
