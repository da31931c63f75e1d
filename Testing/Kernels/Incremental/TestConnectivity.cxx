// SPDX-License-Identifier: BSD-3-Clause
// Changes of the connectivity while links and runs stay, and partial uploads of masks. After each
// change the output equals that of a new deformer.
#include "DeviceNeeds.h"
#include "EditedVolume.h"
#include "MaskChanges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <random>

using namespace deformvolume;

namespace
{

class Connectivity : public testing::TestWithParam<Route>
{
};

void SetConnectivity(VolumeDeformer& deformer, const EditedVolume& volume,
  const std::vector<TetrahedronChange>* changes)
{
  deformer.ChangeConnectivity(
    volume.Tetrahedra.data(), volume.Tetrahedra.size(), volume.GetNumberOfNodes(), changes);
}

} // namespace

TEST_P(Connectivity, MisuseIsAnError)
{
  const EditedVolume volume;
  VolumeDeformer deformer;
  EXPECT_THROW(SetConnectivity(deformer, volume, nullptr), Error) << "without a volume";
  deformer.SetVoxelGrid(volume.Shape);
  EXPECT_THROW(SetConnectivity(deformer, volume, nullptr), Error) << "without a mesh";
  volume.SendAll(deformer, GetParam());
  EXPECT_THROW(deformer.ChangeConnectivity(
                 volume.Tetrahedra.data(), volume.Tetrahedra.size() - 1, volume.GetNumberOfNodes()),
    Error)
    << "fewer tetrahedra";
  EXPECT_THROW(
    deformer.ChangeConnectivity(volume.Tetrahedra.data(), volume.Tetrahedra.size(), 0), Error)
    << "0 nodes";
  TetrahedronChange change{ 3, volume.Tetrahedra[3], volume.Tetrahedra[3] };
  change.After[1] = static_cast<std::int32_t>(volume.GetNumberOfNodes());
  std::vector<TetrahedronChange> changes{ change };
  EXPECT_THROW(SetConnectivity(deformer, volume, &changes), Error) << "a node that does not exist";
  changes.front().After = volume.Tetrahedra[3];
  for (const int number : { -1, static_cast<int>(volume.Tetrahedra.size()) })
  {
    changes.front().Number = number;
    EXPECT_THROW(SetConnectivity(deformer, volume, &changes), Error)
      << "a tetrahedron that does not exist";
  }
  // The errors have changed nothing.
  VolumeDeformer other;
  volume.SendAll(other, GetParam());
  EditedOutputs found(volume);
  EditedOutputs expected(volume);
  deformer.Deform(found.MakeRequest(volume));
  other.Deform(expected.MakeRequest(volume));
  EXPECT_TRUE(found == expected);
}

TEST_P(Connectivity, EqualsANewUpload)
{
  const Route route = GetParam();
  EditedVolume volume;
  const EditedVolume begin = volume;
  VolumeDeformer changed;
  volume.SendAll(changed, route);
  std::mt19937 random(41);
  std::unique_ptr<EditedOutputs> last;
  int parts = 0;
  for (int i = 0; i < 80; ++i)
  {
    SCOPED_TRACE("edit " + std::to_string(i));
    std::vector<TetrahedronChange> changes;
    bool areKnown = i % 3 != 0;
    if (i % 20 == 19)
    {
      volume.Tetrahedra = begin.Tetrahedra; // these need fewer nodes
      volume.Displacements.resize(begin.Displacements.size());
      areKnown = false;
    }
    else
    {
      changes = volume.Split(random, i % 7 == 6 ? 400 : 12);
    }
    if (i % 4 == 1)
    {
      volume.Move(random, 0, 0.5F);
    }
    if (i % 5 == 2)
    {
      volume.Active.resize(GetNumberOfCells(volume.Shape.VertexExtent), 31);
      volume.Active[random() % volume.Active.size()] = random() % 32;
      volume.Blanked.resize(GetNumberOfPoints(volume.Shape.VertexExtent));
      volume.Blanked[random() % volume.Blanked.size()] ^= 1;
    }
    SetConnectivity(changed, volume, areKnown ? &changes : nullptr);
    volume.SendMasks(changed);
    volume.SendDisplacements(changed, route);

    VolumeDeformer fresh;
    volume.SendAll(fresh, route);
    EditedOutputs expected(volume);
    const DeformReport wanted = fresh.Deform(expected.MakeRequest(volume));
    const bool isFirst = !last;
    if (isFirst)
    {
      last = std::make_unique<EditedOutputs>(volume);
    }
    DeformRequest request = last->MakeRequest(volume);
    request.Incremental = true;
    if (!isFirst)
    {
      last->SetLast(request);
    }
    const DeformReport report = changed.Deform(request);
    ExpectSame(report, wanted);
    ASSERT_TRUE(*last == expected);
    parts += report.NumberOfResampledBricks < report.NumberOfBricks;
  }
  EXPECT_GT(parts, 30);
}

// Edits that open gaps, and partial uploads of masks, in a volume that is small enough for
// Oclgrind.
TEST_P(Connectivity, GapsAndMasksOfASmallVolume)
{
  const Route route = GetParam();
  EditedVolume volume(Extent{ { 0, 16, 1, 8, 0, 8 } }, false);
  std::vector<std::int32_t> places(volume.GetNumberOfNodes());
  std::iota(places.begin(), places.end(), 0);
  VolumeDeformer changed;
  volume.SendAll(changed, route);
  std::mt19937 random(7);
  EditedOutputs last(volume);
  bool hasGap = false;
  for (int edit = 0; edit < 2; ++edit)
  {
    SCOPED_TRACE("edit " + std::to_string(edit));
    const std::vector<TetrahedronChange> changes = volume.Split(random, 6);
    places.resize(volume.GetNumberOfNodes());
    for (const TetrahedronChange& change : changes)
    {
      for (int k = 0; k < 4; ++k)
      {
        places[change.After[k]] = places[change.Before[k]];
      }
    }
    volume.Active.resize(GetNumberOfCells(volume.Shape.VertexExtent), 31);
    volume.Active[random() % volume.Active.size()] = random() % 32;
    SetConnectivity(changed, volume, &changes);
    changed.SetCoincidentNodes(places.data());
    volume.SendMasks(changed);
    volume.SendDisplacements(changed, route);
    VolumeDeformer fresh;
    volume.SendAll(fresh, route);
    EditedOutputs whole(volume);
    fresh.Deform(whole.MakeRequest(volume));
    fresh.SetCoincidentNodes(places.data());
    EditedOutputs expected(volume);
    fresh.Deform(expected.MakeRequest(volume));
    hasGap = hasGap || !(whole == expected);
    DeformRequest request = last.MakeRequest(volume);
    request.Incremental = true;
    if (edit > 0)
    {
      last.SetLast(request);
    }
    changed.Deform(request);
    ASSERT_TRUE(last == expected);
    // Closes the gaps again.
    if (edit == 1)
    {
      changed.SetCoincidentNodes(nullptr);
      EditedOutputs closed(volume);
      changed.Deform(closed.MakeRequest(volume));
      EXPECT_TRUE(closed == whole);
    }
  }
  EXPECT_TRUE(hasGap);
}

INSTANTIATE_TEST_SUITE_P(
  Routes, Connectivity, testing::Values(Route::Mesh, Route::Runs), GetRouteName);

TEST(MaskChanges, AreTightAndComplete)
{
  const std::array<int, 3> size{ { 131, 9, 13 } };
  std::mt19937 random(3);
  std::vector<unsigned char> last(131 * 9 * 13);
  std::generate(last.begin(), last.end(), [&] { return static_cast<unsigned char>(random()); });
  const auto find = [&](const std::vector<unsigned char>& next, unsigned char bits) {
    return FindMaskChanges(size, { last.data(), bits, 0 }, { next.data(), bits, 0 });
  };
  EXPECT_TRUE(find(last, 255).empty());
  for (int edit = 0; edit < 200; ++edit)
  {
    std::vector<unsigned char> next = last;
    const unsigned char bits = edit % 2 ? 255 : 6;
    for (int i = 0; i < edit % 40 + 1; ++i)
    {
      next[random() % next.size()] ^= static_cast<unsigned char>(1U << random() % 8);
    }
    std::vector<unsigned char> copied = last;
    std::size_t inBoxes = 0;
    for (const Extent& box : find(next, bits))
    {
      inBoxes += static_cast<std::size_t>(GetNumberOfPoints(box));
      CopyMask(size, box, { next.data(), bits, 0 }, copied.data());
    }
    std::size_t different = 0;
    for (std::size_t i = 0; i < next.size(); ++i)
    {
      different += (next[i] & bits) != (last[i] & bits);
      ASSERT_EQ(copied[i] & bits, next[i] & bits);
    }
    if (different == 1)
    {
      EXPECT_EQ(inBoxes, 1U);
    }
    EXPECT_GE(inBoxes, different);
  }
  // One of the two masks is missing.
  EXPECT_TRUE(FindMaskChanges(size, {}, {}).empty());
  const std::vector<unsigned char> usual(last.size(), 31);
  EXPECT_TRUE(FindMaskChanges(size, { nullptr, 255, 31 }, { usual.data(), 255, 31 }).empty());
  std::vector<unsigned char> one = usual;
  one[131 * 9 * 5 + 131 * 3 + 130] = 7;
  const std::vector<Extent> found =
    FindMaskChanges(size, { one.data(), 255, 31 }, { nullptr, 255, 31 });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front(), (Extent{ { 130, 130, 3, 3, 5, 5 } }));
}
