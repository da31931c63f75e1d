// SPDX-License-Identifier: BSD-3-Clause
// ChainMail: random drags, releases, cuts, pins and resets. Each step is compared with the slow
// reference.
#include "ChainMailSubject.h"

#include <algorithm>
#include <string>

using namespace chainMailTesting;

namespace
{

// Random drags, releases, cuts, pins and resets of a small volume.
void RunSequence(unsigned int seed, const Extent& extent, int steps)
{
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const std::array<double, 3> spacing{ { 2.0, 1.0, 0.5 } };
  ChainMailReference reference(extent, spacing);
  MakeRandom(reference, random);
  Subject subject(extent, spacing, random() % 2 ? 0 : 8, random() % 3);
  subject.Set(reference);
  std::vector<ChainMailHandle> handles;
  for (int step = 0; step < steps; ++step)
  {
    SCOPED_TRACE(step);
    switch (random() % 8)
    {
      case 0: // cuts; some tetrahedra become active again
        for (int i = 0; i < 20; ++i)
        {
          reference.Active[random() % reference.Active.size()] =
            static_cast<unsigned char>(random() % 3 ? random() % 32 : 31);
        }
        reference.FindLinks();
        if (reference.IsViolated())
        {
          reference.Reset();
        }
        subject.Model.SetActiveTetrahedra(reference.Active.data());
        break;
      case 1:
        reference.Pinned[random() % reference.Pinned.size()] ^= 1;
        subject.Model.SetPinned(reference.Pinned.data());
        break;
      case 2:
        if (random() % 4 == 0)
        {
          reference.Reset();
          subject.Model.Reset();
        }
        break;
      case 3:
        handles.clear();
        break;
      default:
        handles.resize(std::min<std::size_t>(handles.size() + 1, random() % 4));
        for (ChainMailHandle& handle : handles)
        {
          handle = random() % 2 ? handle : MakeRandomHandle(extent, random, 3.0);
        }
    }
    for (ChainMailHandle& handle : handles)
    {
      const ChainMailHandle other = MakeRandomHandle(extent, random, 2.0);
      handle = handle.RestPosition[2] < extent[4] ? other : handle;
      handle.Displacement = other.Displacement;
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        handle.RestPosition[axis] = std::clamp(handle.RestPosition[axis],
          static_cast<double>(extent[2 * axis]), static_cast<double>(extent[2 * axis + 1]));
      }
    }
    const auto before = reference.Displacements;
    const std::vector<float> last = subject.Output;
    const ChainMailReport report = subject.Step(handles);
    ExpectSame(report.Handles, reference.Step(handles));
    subject.ExpectEqual(reference);
    EXPECT_EQ(report.LargestViolation, 0.0);
    std::int64_t moved = 0;
    for (std::size_t i = 0; i < before.size(); ++i)
    {
      moved += before[i] != reference.Displacements[i];
    }
    EXPECT_EQ(report.NumberOfMovedVoxels, moved);
    ASSERT_FALSE(reference.IsViolated());
    ASSERT_FALSE(testing::Test::HasFailure());
  }
}

} // namespace

TEST(ChainMailSequences, RandomEqualsReference)
{
  for (unsigned int seed = 0; seed < 60; ++seed)
  {
    RunSequence(seed, { { 0, 10, -5, 4, 3, 11 } }, 30);
    ASSERT_FALSE(testing::Test::HasFailure());
  }
}

// Small enough for Oclgrind, an interpreter of kernels.
TEST(ChainMailSequences, TinyEqualsReference)
{
  RunSequence(3, { { 0, 9, 0, 8, 0, 4 } }, 10);
}
