// SPDX-License-Identifier: BSD-3-Clause
// ChainMail: misuse, closed-form solutions, and comparisons with a slow reference.
#include "CaughtError.h"
#include "ChainMailSubject.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace chainMailTesting;

TEST(ChainMail, MisuseIsAnError)
{
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const Extent extent{ { 0, 8, 0, 8, 0, 8 } };
  ChainMailModel empty;
  EXPECT_THROW(empty.SetMaterials(Tissues), Error) << "without a volume";
  EXPECT_THROW(empty.SetOutput(nullptr), Error);
  EXPECT_THROW(empty.SetPinned(nullptr), Error);
  EXPECT_THROW(empty.SetActiveTetrahedra(nullptr), Error);
  EXPECT_THROW(empty.Reset(), Error);
  EXPECT_THROW(empty.Step({}), Error);
  EXPECT_THROW(empty.SetVoxelGrid({ { 0, 8, 0, 8, 3, 3 } }), Error) << "one voxel on z";
  EXPECT_THROW(empty.SetVoxelGrid(extent, { { 1, 0, 0, 0, 0, 0, 0, 0, 1 } }), Error);
  empty.SetMemoryLimit(1000);
  EXPECT_NE(GetError([&] { empty.SetVoxelGrid(extent); })
              .find("and 1000 are available. Use a smaller volume, raise the memory limit"),
    std::string::npos);
  empty.SetMemoryLimit(0);
  empty.SetVoxelGrid(extent);
  EXPECT_THROW(empty.Step({}), Error) << "without an output";

  Subject subject(extent);
  const ChainMailHandle good = MakeHandle({ { 4, 4, 4 } }, { { 2, 0, 0 } });
  subject.Step({ good });
  const std::vector<float> before = subject.Output;
  for (const ChainMailMaterial& bad : std::vector<ChainMailMaterial>{ { 1.1, 1.5, 0.5 },
         { -0.1, 1.5, 0.5 }, { 0.5, 0.9, 0.5 }, { 0.5, 1e4, 0.5 }, { 0.5, 1.5, -1.0 },
         { nan, 1.5, 0.5 }, { 0.5, nan, 0.5 }, { 0.5, 1.5, nan } })
  {
    EXPECT_THROW(subject.Model.SetMaterials({ bad }), Error);
  }
  EXPECT_THROW(subject.Model.SetMaterials({}), Error);
  EXPECT_THROW(subject.Model.SetMaterials(std::vector<ChainMailMaterial>(257)), Error);
  std::vector<unsigned char> materials(729);
  materials[700] = 1;
  EXPECT_THROW(subject.Model.SetMaterials({ ChainMailMaterial() }, materials.data()), Error);
  EXPECT_THROW(subject.Step({ MakeHandle({ { 9, 4, 4 } }, { { 1, 0, 0 } }) }), Error)
    << "a handle outside the volume";
  EXPECT_THROW(subject.Step({ good, MakeHandle({ { 4, -1, 4 } }, { { 1, 0, 0 } }) }), Error);
  EXPECT_THROW(subject.Step({ MakeHandle({ { 4, nan, 4 } }, { { 1, 0, 0 } }) }), Error);
  EXPECT_THROW(subject.Step({ MakeHandle({ { 4, 4, 4 } }, { { 1, nan, 0 } }) }), Error);
  EXPECT_THROW(subject.Step({ MakeHandle({ { 4, 4, 4 } }, { { 1, 4096, 0 } }) }), Error);
  EXPECT_THROW(subject.Step({ MakeHandle({ { 4, 4, 4 } }, { { 1, 0, 0 } }, -1.0) }), Error);
  ChainMailRequest request;
  request.Elasticity = 1.5;
  EXPECT_THROW(subject.Model.Step(request), Error);
  request.Elasticity = 1.0;
  request.PlasticityThreshold = -1.0;
  EXPECT_THROW(subject.Model.Step(request), Error);
  EXPECT_EQ(subject.Output, before);
  // A drag that continues after errors equals a drag without errors.
  Subject other(extent);
  other.Step({ good });
  const ChainMailHandle further = MakeHandle({ { 4, 4, 4 } }, { { -1, 3, 0 } });
  subject.Step({ further });
  other.Step({ further });
  EXPECT_EQ(subject.Output, other.Output);
}

TEST(ChainMail, ClosedFormOfAChain)
{
  const Extent extent{ { 3, 60, 0, 1, -1, 0 } };
  const std::vector<ChainMailMaterial> table{ { 0.75, 1.125, 0.5 } };
  for (const double drag : { -5.5, 5.5 })
  {
    Subject subject(extent);
    subject.Model.SetMaterials(table);
    const ChainMailReport report =
      subject.Step({ MakeHandle({ { 3, 0.5, -0.5 } }, { { drag, 0, 0 } }, 0.75) });
    EXPECT_EQ(report.Handles.front().NumberOfVoxels, 4);
    EXPECT_EQ(report.LargestViolation, 0.0);
    std::int64_t moved = 0;
    for (std::size_t i = 0; i < 58; ++i)
    {
      const double n = static_cast<double>(i);
      // Pulled links get at most an eighth longer, pushed links at most a quarter shorter.
      const double expected =
        drag < 0 ? -std::max(0.0, 5.5 - n * 0.125) : std::max(0.0, 5.5 - n * 0.25);
      for (std::size_t row = 0; row < 4; ++row)
      {
        EXPECT_EQ(subject.Get(i + 58 * row, 0), expected) << "voxel " << i << " of row " << row;
        EXPECT_EQ(subject.Get(i + 58 * row, 1), 0.0);
        EXPECT_EQ(subject.Get(i + 58 * row, 2), 0.0);
        moved += expected != 0.0;
      }
    }
    EXPECT_EQ(report.NumberOfMovedVoxels, moved);
  }
}

TEST(ChainMail, ClosedFormOfASoftCube)
{
  const int n = 48;
  const Extent extent{ { 0, n - 1, 0, n - 1, 0, n - 1 } };
  Subject subject(extent);
  subject.Model.SetMaterials({ { 0.5, 1.5, 0.5 } });
  const std::array<double, 3> drag{ { 6, 2, -3.25 } };
  const ChainMailReport report = subject.Step({ MakeHandle({ { 24, 24, 24 } }, drag) });
  std::int64_t moved = 0;
  std::size_t voxel = 0;
  for (int k = 0; k < n; ++k)
  {
    for (int j = 0; j < n; ++j)
    {
      for (int i = 0; i < n; ++i, ++voxel)
      {
        const double distance = std::abs(i - 24) + std::abs(j - 24) + std::abs(k - 24);
        bool isMoved = false;
        for (std::size_t c = 0; c < 3; ++c)
        {
          const double length = std::max(0.0, std::abs(drag[c]) - 0.5 * distance);
          ASSERT_EQ(subject.Get(voxel, c), drag[c] < 0 ? -length : length);
          isMoved = isMoved || length > 0.0;
        }
        moved += isMoved;
      }
    }
  }
  EXPECT_EQ(report.NumberOfMovedVoxels, moved);
  EXPECT_EQ(report.LargestViolation, 0.0);
  // Voxels less than 12 links away have moved. Changes are reported as whole blocks of 8 voxels.
  EXPECT_EQ(report.ChangedExtent, (Extent{ { 8, 39, 8, 39, 8, 39 } }));
}

TEST(ChainMail, EqualsTheReferenceInAnyOrder)
{
  std::mt19937 random(5);
  for (int round = 0; round < 12; ++round)
  {
    SCOPED_TRACE(round);
    const Extent extent{ { -3, 15 + round, 1, 20, 0, 9 + round } };
    const std::array<double, 3> spacing{ { 1.0, 0.5, 2.0 } };
    ChainMailReference reference(extent, spacing);
    MakeRandom(reference, random, round % 2 == 0);
    const std::vector<ChainMailHandle> handles{ MakeRandomHandle(extent, random, 9.0) };
    reference.Step(handles);
    std::vector<float> first;
    for (unsigned int run = 0; run < 4; ++run)
    {
      Subject subject(extent, spacing, run < 2 ? 0 : run == 2 ? 1 : 16, run % 2 ? 7 + run : 0);
      subject.Set(reference);
      const ChainMailReport report = subject.Step(handles);
      subject.ExpectEqual(reference);
      EXPECT_EQ(report.LargestViolation, 0.0);
      first = run == 0 ? subject.Output : first;
      EXPECT_EQ(subject.Output, first);
    }
    EXPECT_FALSE(reference.IsViolated());
  }
}

TEST(ChainMail, SeparatedBodiesNeverInteract)
{
  std::mt19937 random(11);
  const Extent extent{ { 1, 24, 0, 18, 0, 17 } };
  ChainMailReference reference(extent, { { 1, 1, 1 } });
  // Switch off all tetrahedra of the cells between two planes of voxels.
  std::size_t cell = 0;
  for (int k = 0; k < 17; ++k)
  {
    for (int j = 0; j < 18; ++j)
    {
      for (int i = 0; i < 23; ++i, ++cell)
      {
        reference.Active[cell] = i + j == 20 || i + j == 21 ? 0 : 31;
      }
    }
  }
  reference.FindLinks();
  Subject subject(extent);
  subject.Set(reference);
  const std::vector<ChainMailHandle> handles{ MakeHandle({ { 3, 2, 5 } }, { { 40, -30, 20 } }) };
  subject.Step(handles);
  reference.Step(handles);
  subject.ExpectEqual(reference);
  std::size_t still = 0;
  std::size_t voxel = 0;
  for (int k = 0; k < 18; ++k)
  {
    for (int j = 0; j < 19; ++j)
    {
      for (int i = 0; i < 24; ++i, ++voxel)
      {
        const bool isMoved = subject.Get(voxel, 0) != 0.0;
        // The cells with i + j = 19 are the last cells on this side.
        EXPECT_EQ(isMoved, i + j <= 20 || (i + j == 21 && j > 0)) << i << ' ' << j << ' ' << k;
        still += !isMoved;
      }
    }
  }
  EXPECT_GT(still, 1000U);
}

// A path that turns at each voxel. A sweep over a block advances along the path by one voxel only.
// If the path is rigid, all of it moves, and if it is soft, nothing but the handle does.
TEST(ChainMail, LongPathsWithinABlock)
{
  const Extent extent{ { 0, 8, 0, 8, 0, 8 } };
  ChainMailReference reference(extent, { { 1, 1, 1 } });
  reference.Table = { { 0.0, 1000.0, 1000.0 }, { 1.0, 1.0, 0.0 } };
  std::size_t length = 0;
  const auto add = [&](int i, int j, int k)
  {
    unsigned char& material = reference.Materials[reference.GetVoxel(i, j, k)];
    length += material == 0;
    material = 1;
  };
  for (int i = 0; i < 8; i += 2)
  {
    for (int step = 0; step < 8; ++step)
    {
      add(i, step, 7 - step);
      if (step < 7)
      {
        add(i, step + 1, 7 - step);
      }
    }
    add(i + 1, i % 4 == 0 ? 7 : 0, i % 4 == 0 ? 0 : 7);
  }
  const std::vector<ChainMailHandle> handles{ MakeHandle({ { 0, 0, 7 } }, { { 0.25, 0, 0 } }) };
  for (const bool isRigid : { true, false })
  {
    if (!isRigid)
    {
      reference.Table[1] = { 0.5, 1.5, 0.5 };
      reference.Reset();
    }
    reference.Step(handles);
    for (const std::size_t workGroupSize : { 0, 16 })
    {
      Subject subject(extent, { { 1, 1, 1 } }, workGroupSize);
      subject.Set(reference);
      // Voxels that are not rigid yield by half a voxel or more, so only the path moves.
      EXPECT_EQ(
        subject.Step(handles).NumberOfMovedVoxels, isRigid ? static_cast<std::int64_t>(length) : 1);
      subject.ExpectEqual(reference);
    }
  }
}

TEST(ChainMail, PinsStay)
{
  const Extent extent{ { 0, 29, 0, 8, 0, 8 } };
  ChainMailReference reference(extent, { { 1, 1, 1 } });
  for (int k = 0; k < 9; ++k)
  {
    for (int j = 0; j < 9; ++j)
    {
      reference.Pinned[reference.GetVoxel(20, j, k)] = 1;
    }
  }
  Subject subject(extent);
  subject.Set(reference);
  const std::vector<ChainMailHandle> handles{ MakeHandle({ { 10, 4, 4 } }, { { 9, 1, -20 } }) };
  const ChainMailReport report = subject.Step(handles);
  // The ten links to the nearest pinned voxel yield by half a voxel each.
  EXPECT_EQ(report.Handles.front().Reduction, (std::array<double, 3>{ { 4, 0, -15 } }));
  EXPECT_TRUE(report.Handles.front().IsHeld);
  EXPECT_EQ(subject.Get(reference.GetVoxel(10, 4, 4), 0), 5.0);
  EXPECT_EQ(subject.Get(reference.GetVoxel(20, 4, 4), 0), 0.0);
  ExpectSame(report.Handles, reference.Step(handles));
  subject.ExpectEqual(reference);
  EXPECT_EQ(report.LargestViolation, 0.0);
}

TEST(ChainMail, HandlesThatContradictEachOther)
{
  const Extent extent{ { 0, 29, 0, 8, 0, 8 } };
  ChainMailReference reference(extent, { { 1, 1, 1 } });
  Subject subject(extent);
  // The handles are six links apart, and their displacements differ by 8 voxels: the second one is
  // reduced by 5.
  const std::vector<ChainMailHandle> handles{ MakeHandle({ { 10, 4, 4 } }, { { 4, 0, 0 } }),
    MakeHandle({ { 16, 4, 4 } }, { { -4, 1, 0 } }) };
  const ChainMailReport report = subject.Step(handles);
  EXPECT_EQ(report.Handles[0].Reduction, (std::array<double, 3>{ { 0, 0, 0 } }));
  EXPECT_EQ(report.Handles[1].Reduction, (std::array<double, 3>{ { -5, 0, 0 } }));
  ExpectSame(report.Handles, reference.Step(handles));
  subject.ExpectEqual(reference);
  // Handles with the same displacement do not restrict each other.
  const std::vector<ChainMailHandle> together{ MakeHandle({ { 10, 4, 4 } }, { { 40, 0, 0 } }),
    MakeHandle({ { 16, 4, 4 } }, { { 40, 0, 0 } }) };
  ExpectSame(subject.Step(together).Handles, reference.Step(together));
  subject.ExpectEqual(reference);
  EXPECT_EQ(subject.Get(reference.GetVoxel(16, 4, 4), 0), 40.0);
}

// Handles whose voxels are all held by earlier handles take no time: the first handle has priority.
TEST(ChainMail, ManyHandlesOnTheSameVoxels)
{
  const Extent extent{ { 0, 29, 0, 8, 0, 8 } };
  const std::vector<ChainMailHandle> few{ MakeHandle({ { 10, 4, 4 } }, { { 4, 0, 0 } }),
    MakeHandle({ { 16, 4, 4 } }, { { -4, 1, 0 } }),
    MakeHandle({ { 22, 4, 4 } }, { { 0, -6, 0 } }) };
  std::vector<ChainMailHandle> many = few;
  for (int i = 0; i < 300; ++i)
  {
    many.push_back(few[static_cast<std::size_t>(i % 3)]);
    many.back().Displacement = { { 1.0 * (i % 7), -3.0, 2.0 } };
  }
  ChainMailReference reference(extent, { { 1, 1, 1 } });
  Subject subject(extent);
  Subject other(extent);
  const ChainMailReport report = subject.Step(many);
  EXPECT_EQ(report.NumberOfSweeps, other.Step(few).NumberOfSweeps);
  ExpectSame(report.Handles, reference.Step(many));
  subject.ExpectEqual(reference);
  EXPECT_FALSE(report.Handles.back().IsHeld);
  EXPECT_EQ(report.Handles.back().NumberOfVoxels, 0);
}

TEST(ChainMail, ImpossibleHandlesAreReleased)
{
  const Extent extent{ { 0, 20, 0, 4, 0, 4 } };
  ChainMailReference reference(extent, { { 1, 1, 1 } });
  Subject subject(extent);
  const std::vector<ChainMailHandle> apart{ MakeHandle({ { 5, 2, 2 } }, { { -3, 0, 0 } }),
    MakeHandle({ { 15, 2, 2 } }, { { 2, 0, 0 } }) };
  subject.Step(apart);
  reference.Step(apart);
  // Both ends are pinned, and the ten links between them have their largest length.
  reference.Pinned[reference.GetVoxel(5, 2, 2)] = 1;
  reference.Pinned[reference.GetVoxel(15, 2, 2)] = 1;
  subject.Model.SetPinned(reference.Pinned.data());
  const std::vector<ChainMailHandle> rigid{ MakeHandle({ { 10, 2, 2 } }, { { 1, 0, 0 } }, 3.0) };
  const std::vector<float> before = subject.Output;
  const ChainMailReport report = subject.Step(rigid);
  EXPECT_FALSE(report.Handles.front().IsHeld);
  EXPECT_EQ(subject.Output, before);
  EXPECT_EQ(report.NumberOfMovedVoxels, 0);
  ExpectSame(report.Handles, reference.Step(rigid));
  subject.ExpectEqual(reference);
}

// After a snapshot is restored, a model behaves as if the later steps had not happened.
TEST(ChainMail, SavedStatesAreRestored)
{
  const Extent extent{ { -3, 30, 2, 21, 0, 18 } };
  std::mt19937 random(11);
  ChainMailReference reference(extent, { { 1, 1, 1 } });
  MakeRandom(reference, random, false);
  Subject subject(extent);
  subject.Set(reference);
  const std::vector<float> rest = subject.Output;
  const auto atRest = subject.Model.TakeSnapshot();
  EXPECT_TRUE(atRest->Numbers.empty());
  std::vector<std::shared_ptr<const ChainMailSnapshot>> snapshots{ atRest };
  std::vector<std::vector<float>> outputs{ rest };
  for (int step = 0; step < 6; ++step)
  {
    // Drag the two ends of the volume in turn, so that not all blocks move in a step.
    ChainMailHandle handle = MakeRandomHandle(extent, random, 1.5);
    handle.RestPosition[0] = step % 2 ? -3.0 : 30.0;
    subject.Step({ handle }, 3);
    snapshots.push_back(subject.Model.TakeSnapshot(snapshots.back()));
    outputs.push_back(subject.Output);
    ASSERT_NE(outputs[outputs.size() - 2], outputs.back());
    for (std::size_t i = 0; i < snapshots.back()->Blocks.size(); ++i)
    {
      EXPECT_TRUE(std::any_of(snapshots.back()->Blocks[i]->begin(),
        snapshots.back()->Blocks[i]->end(), [](std::int32_t value) { return value != 0; }));
    }
  }
  for (const std::size_t number : { 3U, 6U, 0U, 2U, 5U, 1U, 4U })
  {
    subject.Model.Restore(*snapshots[number]);
    EXPECT_EQ(subject.Output, outputs[number]);
    const ChainMailReport report = subject.Step({});
    EXPECT_EQ(report.NumberOfMovedVoxels, 0U);
    EXPECT_FALSE(report.WasReset);
    EXPECT_LE(report.ChangedExtent[0], report.ChangedExtent[1]); // the changes of Restore
    EXPECT_EQ(subject.Output, outputs[number]);
  }
  // The next step gives the result of the first time.
  Subject fresh(extent);
  fresh.Set(reference);
  subject.Model.Restore(*atRest);
  const ChainMailHandle handle = MakeHandle({ { 10, 10, 10 } }, { { 2.5, -1, 1 } });
  subject.Step({ handle }, 4);
  fresh.Step({ handle }, 4);
  EXPECT_EQ(subject.Output, fresh.Output);

  // Unchanged blocks are shared with the last snapshot.
  const auto one = subject.Model.TakeSnapshot();
  const auto same = subject.Model.TakeSnapshot(one);
  EXPECT_EQ(one->Blocks, same->Blocks);
  subject.Step({ MakeHandle({ { -3, 10, 10 } }, { { 0.5, 0, 0 } }) });
  const auto other = subject.Model.TakeSnapshot(one);
  std::size_t shared = 0;
  for (std::size_t i = 0; i < other->Numbers.size(); ++i)
  {
    const auto found = std::find(one->Blocks.begin(), one->Blocks.end(), other->Blocks[i]);
    shared += found != one->Blocks.end() ? 1U : 0U;
  }
  EXPECT_GT(shared, 0U);
  EXPECT_LT(shared, other->Numbers.size());

  Subject smaller(Extent{ { 0, 30, 0, 21, 0, 18 } });
  EXPECT_THROW(smaller.Model.Restore(*one), Error);
  EXPECT_THROW(ChainMailModel().TakeSnapshot(), Error);
}

// Cut links have no limits. Displacements in a snapshot with cut links may violate the limits of
// these links when the links are active again.
TEST(ChainMail, SavedStatesThatViolateLinks)
{
  const Extent extent{ { 0, 20, 0, 9, 0, 9 } };
  Subject subject(extent);
  std::vector<unsigned char> cut(std::size_t{ 20 } * 9 * 9, 31);
  for (std::size_t cell = 10; cell < cut.size(); cell += 20)
  {
    cut[cell] = 0;
  }
  subject.Model.SetActiveTetrahedra(cut.data());
  subject.Step({ MakeHandle({ { 20, 4, 4 } }, { { 9, 0, 0 } }) });
  const auto apart = subject.Model.TakeSnapshot();
  const std::vector<float> before = subject.Output;
  subject.Model.Reset();
  subject.Step({});
  subject.Model.Restore(*apart);
  EXPECT_FALSE(subject.Step({}).WasReset);
  EXPECT_EQ(subject.Output, before);
  // Restores the snapshot and then the links, or the links first. In both orders all displacements
  // are set to 0.
  for (const bool linksFirst : { false, true })
  {
    subject.Model.SetActiveTetrahedra(cut.data());
    subject.Model.Reset();
    subject.Step({});
    if (linksFirst)
    {
      subject.Model.SetActiveTetrahedra(nullptr);
    }
    subject.Model.Restore(*apart);
    EXPECT_EQ(subject.Output, before);
    subject.Model.SetActiveTetrahedra(nullptr);
    EXPECT_TRUE(subject.Step({}).WasReset);
    EXPECT_EQ(subject.Output, std::vector<float>(before.size(), 0.0F));
  }
}
