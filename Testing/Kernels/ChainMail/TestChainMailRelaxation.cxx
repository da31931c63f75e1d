// SPDX-License-Identifier: BSD-3-Clause
// ChainMail: relaxation, aborted steps, and the voxels of the output that are written.
#include "ChainMailModel.h"
#include "ChainMailReference.h"
#include "ChainMailSubject.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

using namespace deformvolume;
using chainMailTesting::MakeHandle;
using chainMailTesting::MakeRandom;

namespace
{

constexpr Extent Cube{ { 0, 47, 0, 47, 0, 47 } };

struct RelaxedSubject
{
  explicit RelaxedSubject(
    const Extent& extent, std::size_t workGroupSize = 0, unsigned int order = 0)
    : Output(static_cast<std::size_t>(3 * GetNumberOfPoints(extent)))
  {
    this->Model.SetWorkGroupSize(workGroupSize);
    this->Model.SetBlockOrder(order);
    this->Model.SetVoxelGrid(extent);
    this->Model.SetOutput(this->Output.data());
  }
  ChainMailReport Step(int sweeps, double elasticity = 1.0, double threshold = 0.0)
  {
    this->Request.RelaxationSweeps = sweeps;
    this->Request.Elasticity = elasticity;
    this->Request.PlasticityThreshold = threshold;
    return this->Model.Step(this->Request);
  }
  double GetLargest() const
  {
    double largest = 0.0;
    for (const float value : this->Output)
    {
      largest = std::max(largest, std::abs(static_cast<double>(value)));
    }
    return largest;
  }

  ChainMailModel Model;
  std::vector<float> Output;
  ChainMailRequest Request;
};

// The sum of the squares of the differences between links and their lengths at rest. Each square is
// weighted by the stiffness of the link.
double GetEnergy(const ChainMailReference& reference, const std::vector<float>& displacements)
{
  double energy = 0.0;
  for (const ReferenceLink& link : reference.GetLinks())
  {
    for (std::size_t c = 0; c < 3; ++c)
    {
      const std::array<std::int64_t, 2> limits = reference.GetLimits(link, static_cast<int>(c));
      const double difference = static_cast<double>(displacements[3 * link.Second + c]) -
        static_cast<double>(displacements[3 * link.First + c]);
      energy += difference * difference / (static_cast<double>(limits[0] + limits[1]) / 65536.0);
    }
  }
  return energy;
}

std::vector<float> ToVoxels(const std::vector<std::array<double, 3>>& units)
{
  std::vector<float> voxels;
  for (const std::array<double, 3>& x : units)
  {
    for (const double value : x)
    {
      voxels.push_back(static_cast<float>(value / 65536.0));
    }
  }
  return voxels;
}

ChainMailHandle GetDrag()
{
  ChainMailHandle handle;
  handle.RestPosition = { { 24, 24, 24 } };
  handle.Displacement = { { 6, 2, 0 } };
  return handle;
}

void MakeStiffer(ChainMailReference& reference)
{
  reference.Table = { { 0.75, 1.5, 0.5 }, { 0.7, 1.125, 0.2 }, { 0.95, 1.05, 0.05 } };
  for (int k = 0; k < 48; ++k)
  {
    for (int j = 0; j < 48; ++j)
    {
      for (int i = 0; i < 48; ++i)
      {
        const int square = (i - 32) * (i - 32) + (j - 24) * (j - 24) + (k - 24) * (k - 24);
        reference.Materials[reference.GetVoxel(i, j, k)] =
          static_cast<unsigned char>(square < 36 ? 2
              : (j / 4) % 3 == 0                 ? 1
                                                 : 0);
      }
    }
  }
}

class Relaxation : public testing::TestWithParam<bool>
{
};

} // namespace

TEST_P(Relaxation, LowersTheEnergy)
{
  ChainMailReference reference(Cube, { { 1, 1, 1 } });
  if (GetParam())
  {
    MakeStiffer(reference);
  }
  double last = 0.0;
  for (const int sweeps : { 0, 1, 5, 20, 100 })
  {
    RelaxedSubject subject(Cube);
    subject.Model.SetMaterials(reference.Table, reference.Materials.data());
    subject.Request.Handles = { GetDrag() };
    const ChainMailReport report = subject.Step(sweeps);
    EXPECT_EQ(report.LargestViolation, 0.0);
    // Floats have 24 bits, and displacements under 8 voxels need 19.
    EXPECT_EQ(reference.GetViolation(subject.Output), 0.0);
    EXPECT_EQ(subject.Output[3 * reference.GetVoxel(24, 24, 24)], 6.0F);
    const double energy = GetEnergy(reference, subject.Output);
    if (sweeps > 0)
    {
      EXPECT_LT(energy, last);
    }
    last = energy;
  }
}

// The values in Documents/chainmail.md. The displacements of the drag alone have a closed form
// there.
TEST(ChainMailRelaxation, EnergyInTheDocumentation)
{
  ChainMailReference reference(Cube, { { 1, 1, 1 } });
  std::size_t voxel = 0;
  for (int k = 0; k < 48; ++k)
  {
    for (int j = 0; j < 48; ++j)
    {
      for (int i = 0; i < 48; ++i, ++voxel)
      {
        const int links = std::abs(i - 24) + std::abs(j - 24) + std::abs(k - 24);
        for (std::size_t c = 0; c < 3; ++c)
        {
          const int drag = static_cast<int>(GetDrag().Displacement[c]);
          reference.Displacements[voxel][c] = std::max(0, 65536 * drag - 32768 * links);
        }
      }
    }
  }
  const double before = GetEnergy(reference, ToVoxels(reference.Relax(0, { GetDrag() })));
  const std::map<int, double> documented{ { 1, 0.84 }, { 5, 0.70 }, { 20, 0.59 } };
  for (const auto& [sweeps, expected] : documented)
  {
    SCOPED_TRACE(sweeps);
    RelaxedSubject subject(Cube);
    subject.Request.Handles = { GetDrag() };
    subject.Step(sweeps);
    // The values have two decimals. The reference relaxes the whole cube, not only the blocks that
    // the drag touched.
    const double relaxed = GetEnergy(reference, ToVoxels(reference.Relax(sweeps, { GetDrag() })));
    EXPECT_NEAR(relaxed / before, expected, 0.005);
    EXPECT_NEAR(GetEnergy(reference, subject.Output) / before, expected, 0.005);
  }
}

// The drag touches all blocks, so that all voxels relax.
TEST(ChainMailRelaxation, EqualsTheReference)
{
  std::mt19937 random(23);
  for (int round = 0; round < 8; ++round)
  {
    SCOPED_TRACE(round);
    const Extent extent{ { 0, 15, 0, 14 - round, 0, 12 } };
    ChainMailReference reference(extent, { { 1, 1, 1 } });
    MakeRandom(reference, random, false);
    for (std::size_t i = 0; i < reference.GetNumberOfVoxels(); ++i)
    {
      reference.Pinned[i] = round > 3 && random() % 100 == 0;
    }
    const std::vector<ChainMailHandle> handles{ MakeHandle(
      { { 7, 6, 7 } }, { { 6, 5.5 - round, -5 } }, round % 2 ? 1.5 : 0.0) };
    reference.Step(handles);
    const std::vector<float> moved = ToVoxels(reference.Relax(0, handles));
    for (const int sweeps : { 1, 2, 8 })
    {
      chainMailTesting::Subject subject(extent);
      subject.Set(reference);
      EXPECT_EQ(subject.Step(handles, sweeps).LargestViolation, 0.0);
      const std::vector<std::array<double, 3>> expected = reference.Relax(sweeps, handles);
      // A move is rounded to a unit, and computed in single precision: the sum of pulls, the
      // reciprocal of the weights and their product, of at most 16 voxels, have an error of 2^-24
      // each. Means and limits do not amplify errors. The second half of a sweep adds the errors of
      // the first half.
      const double bound = 2 * sweeps * (0.5 + 3 * std::ldexp(16.0 * 65536.0, -24) * 1.001);
      double largest = 0.0;
      for (std::size_t i = 0; i < expected.size(); ++i)
      {
        for (std::size_t c = 0; c < 3; ++c)
        {
          largest = std::max(largest, std::abs(subject.Get(i, c) * 65536.0 - expected[i][c]));
        }
      }
      EXPECT_LE(largest, bound);
      EXPECT_NE(subject.Output, moved);
    }
  }
}

TEST_P(Relaxation, IsTheSameInAnyOrder)
{
  ChainMailReference reference(Cube, { { 1, 1, 1 } });
  if (GetParam())
  {
    MakeStiffer(reference);
  }
  std::vector<float> first;
  for (unsigned int run = 0; run < 4; ++run)
  {
    RelaxedSubject subject(Cube, run < 2 ? 0 : run == 2 ? 1 : 16, run);
    subject.Model.SetMaterials(reference.Table, reference.Materials.data());
    subject.Request.Handles = { GetDrag() };
    for (int step = 0; step < 5; ++step)
    {
      subject.Request.Handles.front().Displacement[1] -= 1.25;
      subject.Step(3, 0.8, 0.01);
      EXPECT_EQ(reference.GetViolation(subject.Output), 0.0);
    }
    first = run == 0 ? subject.Output : first;
    EXPECT_EQ(subject.Output, first);
  }
}

INSTANTIATE_TEST_SUITE_P(Tissues, Relaxation, testing::Bool());

TEST(ChainMailRelaxation, PlasticityThreshold)
{
  RelaxedSubject subject(Cube);
  subject.Request.Handles = { GetDrag() };
  subject.Step(0);
  const std::vector<float> before = subject.Output;
  EXPECT_EQ(subject.Step(10, 0.0).NumberOfMovedVoxels, 0) << "with an elasticity of 0";
  EXPECT_EQ(subject.Output, before);
  EXPECT_EQ(subject.Step(10, 1.0, 10.0).NumberOfMovedVoxels, 0)
    << "with a plasticity threshold of 10";
  EXPECT_EQ(subject.Output, before);
  EXPECT_GT(subject.Step(10, 1.0, 0.001).NumberOfMovedVoxels, 0);
  EXPECT_NE(subject.Output, before);
}

TEST(ChainMailRelaxation, ReturnsToRestWherePinned)
{
  const Extent extent{ { 0, 15, 0, 15, 0, 15 } };
  RelaxedSubject subject(extent);
  std::vector<unsigned char> pinned(4096);
  for (std::size_t i = 0; i < pinned.size(); ++i)
  {
    pinned[i] = i / 256 == 0 || i / 256 == 15; // two faces
  }
  subject.Model.SetPinned(pinned.data());
  ChainMailHandle handle;
  handle.RestPosition = { { 8, 8, 8 } };
  handle.Displacement = { { 3, -2, 1 } };
  subject.Request.Handles = { handle };
  subject.Step(2);
  EXPECT_EQ(subject.GetLargest(), 3.0);
  subject.Request.Handles.clear();
  for (int step = 0; step < 8; ++step)
  {
    subject.Step(100);
    for (std::size_t i = 0; i < pinned.size(); ++i)
    {
      EXPECT_TRUE(!pinned[i] || subject.Output[3 * i] == 0.0F);
    }
  }
  // A voxel does not move if the mean of its neighbors is within half a unit. Between two planes
  // that are 15 voxels apart, this allows displacements of at most 6 * 0.5 * 15 * 15 / 8 units.
  EXPECT_LE(subject.GetLargest(), 6.0 * 0.5 * 15.0 * 15.0 / 8.0 / 65536.0);
}

TEST(ChainMailSteps, AbortRestoresTheState)
{
  RelaxedSubject subject(Cube);
  subject.Request.Handles = { GetDrag() };
  subject.Step(1);
  RelaxedSubject other(Cube);
  other.Request.Handles = { GetDrag() };
  other.Step(1);
  const std::vector<float> before = subject.Output;
  int most = 0;
  for (int calls = 0; calls < 1000; ++calls)
  {
    int left = calls;
    subject.Request.Handles.front().Displacement = { { -5, 9, 3 } };
    subject.Request.Progress = [&] { return left-- > 0; };
    try
    {
      subject.Step(5);
      break;
    }
    catch (const Aborted&)
    {
      ASSERT_EQ(subject.Output, before);
      most = calls;
    }
  }
  EXPECT_GT(most, 10);
  EXPECT_NE(subject.Output, before);
  other.Request.Handles.front().Displacement = { { -5, 9, 3 } };
  other.Step(5);
  EXPECT_EQ(subject.Output, other.Output);
}

TEST(ChainMailSteps, OnlyChangedVoxelsAreWritten)
{
  const Extent extent{ { 2, 70, -9, 30, 0, 20 } };
  RelaxedSubject subject(extent);
  std::mt19937 random(2);
  std::vector<float> shadow = subject.Output;
  constexpr float mark = 77.0F;
  for (int step = 0; step < 20; ++step)
  {
    // A step does not write outside the reported changes, even if these values were overwritten.
    ChainMailHandle handle;
    handle.RestPosition = { { 2.0 + random() % 69, -9.0 + random() % 40, 0.0 + random() % 21 } };
    handle.Displacement = { { -2.0 + random() % 5, 1.0, -1.0 } };
    subject.Request.Handles = { handle };
    const std::vector<float> before = subject.Output;
    const ChainMailReport report = subject.Step(step % 3);
    std::vector<char> isChanged(before.size() / 3);
    for (const Extent& box : report.Changes)
    {
      for (int k = box[4]; k <= box[5]; ++k)
      {
        for (int j = box[2]; j <= box[3]; ++j)
        {
          for (int i = box[0]; i <= box[1]; ++i)
          {
            isChanged[static_cast<std::size_t>((k * 40 + j + 9) * 69 + i - 2)] = 1;
          }
        }
      }
      for (int axis = 0; axis < 3; ++axis)
      {
        EXPECT_LE(report.ChangedExtent[2 * axis], box[2 * axis]);
        EXPECT_GE(report.ChangedExtent[2 * axis + 1], box[2 * axis + 1]);
      }
    }
    for (std::size_t i = 0; i < isChanged.size(); ++i)
    {
      for (std::size_t c = 0; c < 3; ++c)
      {
        ASSERT_TRUE(isChanged[i] || subject.Output[3 * i + c] == before[3 * i + c]);
      }
    }
  }
  // Set other memory as the output, then reset.
  std::vector<float> other(subject.Output.size(), mark);
  subject.Model.SetOutput(other.data());
  EXPECT_EQ(other, subject.Output);
  subject.Model.Reset();
  EXPECT_EQ(other, shadow);
  subject.Request.Handles.clear();
  const ChainMailReport report = subject.Step(0);
  EXPECT_TRUE(report.WasReset);
  EXPECT_FALSE(report.Changes.empty());
  EXPECT_EQ(report.NumberOfMovedVoxels, 0);
  EXPECT_FALSE(subject.Step(0).WasReset);
}

TEST(ChainMailSteps, VoxelsAtTheRadiusAreHeld)
{
  ChainMailModel model;
  model.SetVoxelGrid({ { 0, 16, 0, 16, 0, 16 } }, { { 1.1, 0, 0, 0, 100, 0, 0, 0, 100 } });
  std::vector<float> output(3 * 17 * 17 * 17);
  model.SetOutput(output.data());
  ChainMailRequest request;
  request.Handles = { MakeHandle({ { 8, 8, 8 } }, { { 1, 0, 0 } }, 3.3) };
  // Rounded, 3 * 1.1 is more than 3.3.
  EXPECT_EQ(model.Step(request).Handles.front().NumberOfVoxels, 7);
}

TEST(ChainMailSteps, OutputIsInWorldCoordinates)
{
  // A rotation about z: the x axis of the volume points along +y of the world, its y axis along -x.
  const std::array<double, 9> indexToWorld{ { 0, -2, 0, 0.5, 0, 0, 0, 0, 4 } };
  ChainMailModel model;
  const Extent extent{ { 0, 16, 0, 16, 0, 16 } };
  model.SetVoxelGrid(extent, indexToWorld);
  std::vector<float> output(3 * 17 * 17 * 17);
  model.SetOutput(output.data());
  ChainMailHandle handle;
  handle.RestPosition = { { 8, 8, 8 } };
  handle.Displacement = { { 1, 2, -1 } };
  // A radius of 1.25 world units includes two voxels along x, and no neighbors on the other axes.
  handle.Radius = 1.25;
  ChainMailRequest request;
  request.Handles = { handle };
  const ChainMailReport report = model.Step(request);
  EXPECT_EQ(report.Handles.front().NumberOfVoxels, 5);
  const std::size_t voxel = 3 * (8 * 17 * 17 + 8 * 17 + 8);
  EXPECT_EQ(output[voxel], -4.0F);
  EXPECT_EQ(output[voxel + 1], 0.5F);
  EXPECT_EQ(output[voxel + 2], -4.0F);
  // The voxel that is four voxels away on x is two links away from the held voxels. Each of these
  // links has the length 0.5 in the world, and yields by 0.25.
  const std::size_t beside = voxel + 3 * 4;
  EXPECT_EQ(output[beside], -4.0F + 2 * 0.5F * 0.5F);
  EXPECT_EQ(output[beside + 1], 0.5F - 2 * 0.25F);
  EXPECT_EQ(output[beside + 2], -4.0F + 2 * 0.5F * 0.5F);
}
