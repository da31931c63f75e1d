// SPDX-License-Identifier: BSD-3-Clause
// Tetrahedra that are replaced by others, removed and added, while the voxels of untouched tiles
// stay in theirs: each time as with a deformer that is given all anew.
#include "DeviceNeeds.h"
#include "EditedVolume.h"
#include "RefinedMesh.h"
#include "StaticMapping.h"
#include "StaticMappingUpdater.h"
#include "TimeAllowance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <tuple>

using namespace deformvolume;

namespace
{

const Extent SmallExtent{ { -5, 90, 0, 50, 3, 40 } };
const glm::dvec3 Spacing(1.0, 1.5, 0.75);

StaticMappingForm GetForm(Route route)
{
  return route == Route::Runs ? StaticMappingForm::Runs : StaticMappingForm::Links;
}

// Gives a volume the links or runs of the whole mapping.
MappingSurvey MapAnew(EditedVolume& volume, const RefinedMesh& mesh, Route route)
{
  const StaticMappingBuilder builder(
    volume.Shape.VertexExtent, Spacing, mesh.GetPoints(), volume.Tetrahedra, false, GetForm(route));
  StaticMapping mapping = builder.Build();
  volume.Links = std::move(mapping.Links);
  volume.Runs = std::move(mapping.Runs);
  return builder.GetSurvey();
}

void ExpectSameSurvey(const MappingSurvey& found, const MappingSurvey& wanted)
{
  EXPECT_EQ(found.NumberOfTetrahedra, wanted.NumberOfTetrahedra);
  EXPECT_EQ(found.NumberOfFlatTetrahedra, wanted.NumberOfFlatTetrahedra);
  EXPECT_EQ(found.NumberOfEntries, wanted.NumberOfEntries);
  ASSERT_EQ(found.Samples.size(), wanted.Samples.size());
  for (std::size_t i = 0; i < found.Samples.size(); ++i)
  {
    EXPECT_EQ(found.Samples[i].Tile, wanted.Samples[i].Tile);
    EXPECT_EQ(found.Samples[i].Rows, wanted.Samples[i].Rows);
    EXPECT_EQ(found.Samples[i].Runs, wanted.Samples[i].Runs);
    EXPECT_EQ(found.Samples[i].RunsOfSlivers, wanted.Samples[i].RunsOfSlivers);
  }
}

void SendReplacement(
  VolumeDeformer& deformer, const EditedVolume& volume, const MappingUpdate& update)
{
  deformer.ReplaceTetrahedra(
    volume.Tetrahedra.data(), volume.Tetrahedra.size(), volume.GetNumberOfNodes(), update);
}

struct Case
{
  Route Way;
  double Jitter;
  bool OpensSplits;
  std::uint64_t AllocationLimit; // 0: none
};

std::string GetCaseName(const testing::TestParamInfo<Case>& info)
{
  return std::string(info.param.Way == Route::Runs ? "Runs" : "Links") +
    (info.param.Jitter > 0.0 ? "" : "OfGrid") + (info.param.OpensSplits ? "WithGaps" : "") +
    (info.param.AllocationLimit ? "InChunks" : "");
}

// Which nodes have one place.
std::vector<std::int32_t> FindPlaces(const std::vector<glm::dvec3>& points)
{
  std::vector<std::int32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto place = [&](std::int32_t node)
  { return std::make_tuple(points[node].x, points[node].y, points[node].z); };
  std::sort(order.begin(), order.end(),
    [&](std::int32_t a, std::int32_t b)
    { return std::make_pair(place(a), a) < std::make_pair(place(b), b); });
  std::vector<std::int32_t> places(points.size());
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    const bool isShared = i > 0 && place(order[i]) == place(order[i - 1]);
    places[order[i]] = isShared ? places[order[i - 1]] : order[i];
  }
  return places;
}

class Replacement : public testing::TestWithParam<Case>
{
protected:
  Replacement()
    : Volume(SmallExtent)
    , Mesh(Volume, GetParam().Jitter, 5)
  {
  }

  void SendAll(VolumeDeformer& deformer)
  {
    if (GetParam().AllocationLimit)
    {
      deformer.SetAllocationLimit(GetParam().AllocationLimit);
    }
    this->Volume.SendAll(deformer, GetParam().Way);
    this->SendPlaces(deformer);
  }

  void SendPlaces(VolumeDeformer& deformer) const
  {
    if (GetParam().OpensSplits)
    {
      deformer.SetNodePlaces(FindPlaces(this->Mesh.GetPoints()).data());
    }
  }

  // After edits. Brings one deformer up to date, in part where that is worthwhile.
  void Update(VolumeDeformer& deformer)
  {
    const TetrahedronReplacement replacement = this->Mesh.TakeReplacement();
    const StaticMappingUpdater updater(this->Volume.Shape.VertexExtent, this->Survey,
      this->Mesh.GetPoints(), this->Volume.Tetrahedra, replacement);
    this->Survey = MapAnew(this->Volume, this->Mesh, GetParam().Way);
    if (!updater.IsWorthwhile())
    {
      this->SendAll(deformer);
      return;
    }
    ExpectSameSurvey(updater.GetSurvey(), this->Survey);
    EXPECT_EQ(updater.GetRunBytes() > 0, GetParam().Way == Route::Runs);
    SendReplacement(deformer, this->Volume, updater.Build());
    ++this->Updates;
    this->SendPlaces(deformer);
    this->Volume.SendDisplacements(deformer, GetParam().Way);
  }

  // Expects the output of a deformer that follows to be that of a fresh one.
  void Compare(VolumeDeformer& deformer)
  {
    VolumeDeformer fresh;
    this->SendAll(fresh);
    EditedOutputs expected(this->Volume);
    const DeformReport wanted = fresh.Deform(expected.MakeRequest(this->Volume));
    const bool isFirst = !this->Last;
    if (isFirst)
    {
      this->Last = std::make_unique<EditedOutputs>(this->Volume);
    }
    DeformRequest request = this->Last->MakeRequest(this->Volume);
    request.Incremental = true;
    if (!isFirst)
    {
      this->Last->SetLast(request);
    }
    const DeformReport report = deformer.Deform(request);
    ExpectSame(report, wanted);
    ASSERT_TRUE(*this->Last == expected);
    this->Parts += report.NumberOfResampledBricks < report.NumberOfBricks ? 1 : 0;
  }

  EditedVolume Volume;
  RefinedMesh Mesh;
  MappingSurvey Survey;
  std::unique_ptr<EditedOutputs> Last;
  int Updates = 0;
  int Parts = 0;
};

} // namespace

TEST_P(Replacement, EqualsWhatIsSentAnew)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  this->Survey = MapAnew(this->Volume, this->Mesh, GetParam().Way);
  VolumeDeformer changed;
  this->SendAll(changed);
  ASSERT_NO_FATAL_FAILURE(this->Compare(changed));
  std::mt19937 random(17);
  const int edits = GetNumberOfCases(GetParam().AllocationLimit ? 20 : 60);
  for (int edit = 0; edit < edits; ++edit)
  {
    std::string what = this->Mesh.Edit();
    if (edit % 4 == 1)
    {
      this->Volume.Move(random, 0, 0.5F);
      what += ", a node that moves";
    }
    if (edit % 5 == 2)
    {
      this->Volume.Active.resize(GetNumberOfCells(SmallExtent), 31);
      this->Volume.Active[random() % this->Volume.Active.size()] = random() % 32;
      this->Volume.Blanked.resize(GetNumberOfPoints(SmallExtent));
      this->Volume.Blanked[random() % this->Volume.Blanked.size()] ^= 1;
      this->Volume.SendMasks(changed);
      what += ", masks";
    }
    SCOPED_TRACE("edit " + std::to_string(edit) + ": " + what);
    this->Update(changed);
    ASSERT_NO_FATAL_FAILURE(this->Compare(changed));
  }
  std::cout << this->Updates << " of " << edits << " mappings and " << this->Parts
            << " outputs were made in part\n";
  EXPECT_GT(this->Updates, edits / 2);
  if (this->Parts > 0) // else the device is no processor, or has several chunks
  {
    EXPECT_GT(this->Parts, edits / 3);
  }
}

// Links and runs name tetrahedra by numbers of the device: changes of the connectivity find them
// after others were replaced.
TEST_P(Replacement, GoesTogetherWithSplits)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  this->Survey = MapAnew(this->Volume, this->Mesh, GetParam().Way);
  VolumeDeformer changed;
  this->SendAll(changed);
  ASSERT_NO_FATAL_FAILURE(this->Compare(changed));
  for (int edit = 0; edit < 12; ++edit)
  {
    SCOPED_TRACE("edit " + std::to_string(edit));
    if (edit % 3 == 0)
    {
      this->Mesh.Refine();
    }
    else if (edit % 3 == 1)
    {
      this->Mesh.Remove();
    }
    else
    {
      const std::vector<TetrahedronChange> changes = this->Mesh.Split(8);
      changed.ChangeConnectivity(this->Volume.Tetrahedra.data(), this->Volume.Tetrahedra.size(),
        this->Volume.GetNumberOfNodes(), edit % 2 ? &changes : nullptr);
      this->Mesh.TakeReplacement();
      this->SendPlaces(changed);
      this->Volume.SendDisplacements(changed, GetParam().Way);
      ASSERT_NO_FATAL_FAILURE(this->Compare(changed));
      continue;
    }
    this->Update(changed);
    ASSERT_NO_FATAL_FAILURE(this->Compare(changed));
  }
  EXPECT_GT(this->Updates, 4);
}

TEST_P(Replacement, RefusesWhatIsNoUpdateOfTheMesh)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  this->Survey = MapAnew(this->Volume, this->Mesh, GetParam().Way);
  const EditedVolume before = this->Volume;
  VolumeDeformer deformer;
  EXPECT_THROW(SendReplacement(deformer, this->Volume, {}), Error) << "no volume";
  deformer.SetVoxelGrid(this->Volume.Shape);
  EXPECT_THROW(SendReplacement(deformer, this->Volume, {}), Error) << "no mesh";
  this->SendAll(deformer);
  this->Mesh.Refine();
  const StaticMappingUpdater updater(SmallExtent, this->Survey, this->Mesh.GetPoints(),
    this->Volume.Tetrahedra, this->Mesh.TakeReplacement());
  ASSERT_TRUE(updater.IsWorthwhile());
  const MappingUpdate good = updater.Build();
  const auto refuse = [&](const char* what, const std::function<void(MappingUpdate&)>& spoil)
  {
    MappingUpdate bad = good;
    spoil(bad);
    EXPECT_THROW(SendReplacement(deformer, this->Volume, bad), Error) << what;
  };
  const auto last = static_cast<std::int32_t>(this->Volume.Tetrahedra.size());
  refuse("more than there were", [&](MappingUpdate& bad) { bad.Kept.push_back({ last, 0, 1 }); });
  refuse("one twice", [](MappingUpdate& bad) { bad.Kept.push_back(bad.Kept.front()); });
  refuse("fewer than none", [](MappingUpdate& bad) { bad.Kept.front().Count = -1; });
  refuse("a box beyond the volume", [](MappingUpdate& bad) { --bad.Boxes.front()[2]; });
  refuse("half rows", [](MappingUpdate& bad) { ++bad.Boxes.front()[0]; });
  refuse("a box that is missing", [](MappingUpdate& bad) { bad.Boxes.pop_back(); });
  if (GetParam().Way == Route::Runs)
  {
    refuse("links", [](MappingUpdate& bad) { bad.Runs = VertexRuns(); });
    refuse("a record that is none",
      [](MappingUpdate& bad)
      { bad.Runs.Runs.front().Tetrahedron = static_cast<std::int32_t>(1 << 20); });
    refuse("a tetrahedron that is none",
      [&](MappingUpdate& bad) { bad.Runs.Tetrahedra.front().Tetrahedron = last; });
  }
  else
  {
    refuse("no links", [](MappingUpdate& bad) { bad.Links.clear(); });
    refuse("a tetrahedron that is none",
      [&](MappingUpdate& bad) { bad.Links.back().Tetrahedron = last; });
  }
  const auto nodes = static_cast<std::int32_t>(this->Volume.GetNumberOfNodes());
  this->Volume.Tetrahedra.back()[2] = nodes;
  EXPECT_THROW(SendReplacement(deformer, this->Volume, good), Error) << "a node that is none";
  // All is as it was.
  EditedOutputs found(before);
  deformer.Deform(found.MakeRequest(before));
  VolumeDeformer other;
  this->Volume = before;
  before.SendAll(other, GetParam().Way);
  EditedOutputs expected(before);
  other.Deform(expected.MakeRequest(before));
  EXPECT_TRUE(found == expected || GetParam().OpensSplits);
}

INSTANTIATE_TEST_SUITE_P(Cases, Replacement,
  testing::Values(Case{ Route::Mesh, 1.5, false, 0 }, Case{ Route::Runs, 1.5, false, 0 },
    Case{ Route::Mesh, 0.0, false, 0 }, Case{ Route::Runs, 0.0, false, 0 },
    Case{ Route::Mesh, 0.0, true, 0 }, Case{ Route::Runs, 0.0, true, 0 },
    Case{ Route::Mesh, 1.5, false, 1 << 20 }, Case{ Route::Runs, 1.5, false, 1 << 20 }),
  GetCaseName);

// Where the whole mapping is better made anew.
TEST(StaticMappingUpdater, KnowsWhenItIsNotWorthwhile)
{
  EditedVolume volume(SmallExtent);
  RefinedMesh mesh(volume, 1.0, 3);
  // So large that runs are worthwhile.
  constexpr double scale = 1.5;
  std::vector<glm::dvec3> points;
  TetrahedronReplacement replacement;
  const auto update = [&]
  {
    points = mesh.GetPoints();
    replacement = mesh.TakeReplacement();
    std::for_each(points.begin(), points.end(), [](glm::dvec3& point) { point *= scale; });
    for (RemovedTetrahedron& removed : replacement.Removed)
    {
      std::for_each(
        removed.Places.begin(), removed.Places.end(), [](glm::dvec3& place) { place *= scale; });
    }
  };
  update();
  const MappingSurvey survey =
    StaticMappingBuilder(SmallExtent, Spacing, points, volume.Tetrahedra, false).GetSurvey();
  ASSERT_GT(survey.GetRunBytes(SmallExtent), 0U);
  for (int i = 0; i < 3; ++i)
  {
    mesh.Refine();
  }
  update();
  const auto isWorthwhile = [&](const MappingSurvey& before)
  {
    return StaticMappingUpdater(SmallExtent, before, points, volume.Tetrahedra, replacement)
      .IsWorthwhile();
  };
  EXPECT_TRUE(isWorthwhile(survey));
  MappingSurvey extrapolated = survey;
  extrapolated.IsExtrapolated = true;
  EXPECT_FALSE(isWorthwhile(extrapolated));
  // Links were better, for one tile with many runs, which it has no more where it is touched.
  std::size_t touched = 0;
  for (std::size_t i = 0; i < survey.Samples.size(); ++i)
  {
    MappingSurvey crowded = survey;
    crowded.Samples[i].Runs *= 1000;
    EXPECT_EQ(crowded.GetRunBytes(SmallExtent), 0U);
    touched += isWorthwhile(crowded) ? 0 : 1;
  }
  EXPECT_GE(touched, 1U);
  EXPECT_LE(touched, survey.Samples.size() / 2);
  // Tetrahedra all over the volume.
  for (int i = 0; i < 200; ++i)
  {
    mesh.Refine();
  }
  update();
  EXPECT_FALSE(isWorthwhile(survey));
}
