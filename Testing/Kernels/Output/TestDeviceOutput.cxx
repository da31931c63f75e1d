// SPDX-License-Identifier: BSD-3-Clause
// Outputs that stay on the device. The device appears to be a graphics card with memory of its own.
#include "DeviceNeeds.h"
#include "EditedVolume.h"
#include "FakeDriver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

using namespace deformvolume;

namespace
{

using DeviceOutputs = std::vector<std::shared_ptr<DeviceOutput>>;

class OutputOnDevice : public testing::TestWithParam<Route>
{
protected:
  void SetUp() override
  {
    SKIP_UNLESS_GRAPHICS()
    this->Edited.SendAll(*this->Deformer, GetParam());
    this->Request.MayStayOnDevice = true;
    this->Request.Incremental = true;
  }

  DeformReport Update()
  {
    this->Edited.SendDisplacements(*this->Deformer, GetParam());
    return this->Deformer->Deform(this->Request);
  }
  /// The output of a new deformer.
  EditedOutputs MakeExpected() const
  {
    VolumeDeformer fresh;
    this->Edited.SendAll(fresh, GetParam());
    EditedOutputs expected(this->Edited);
    fresh.Deform(expected.MakeRequest(this->Edited));
    return expected;
  }
  static void Read(const DeviceOutputs& outputs)
  {
    for (const std::shared_ptr<DeviceOutput>& output : outputs)
    {
      output->Read();
    }
  }
  std::uint64_t CountRead(const DeviceOutputs& outputs)
  {
    FakeDriver::Get().BytesRead = 0;
    Read(outputs);
    return FakeDriver::Get().BytesRead;
  }
  float* At(int x, int y, int z)
  {
    return &this->Edited.Displacements[3 * this->Edited.GetNode({ { x, y, z } })];
  }
  std::uint64_t GetBytes() const
  {
    return 11 * static_cast<std::uint64_t>(GetNumberOfPoints(this->Edited.Output));
  }

  EditedVolume Edited;
  std::unique_ptr<VolumeDeformer> Deformer = std::make_unique<VolumeDeformer>();
  EditedOutputs Outputs{ this->Edited };
  DeformRequest Request = this->Outputs.MakeRequest(this->Edited);
};

} // namespace

TEST_P(OutputOnDevice, MisuseIsAnError)
{
  this->Request.HeldRevisions = { 1, 2, 3 }; // without one of the coverage
  EXPECT_THROW(this->Deformer->Deform(this->Request), Error);
  this->Request.HeldRevisions = { 1, 2, 3, 4 }; // revisions that no output has
  const DeviceOutputs outputs = this->Update().DeviceOutputs;
  ASSERT_EQ(outputs.size(), 4U);
  Read(outputs);
  EXPECT_TRUE(this->Outputs == this->MakeExpected());
}

TEST_P(OutputOnDevice, IsReadOnce)
{
  this->Update();
  this->Update(); // also reads the static mapping, to find what the nodes move
  EditedOutputs untouched(this->Edited);
  FakeDriver::Get().BytesRead = 0;
  DeviceOutputs outputs = this->Update().DeviceOutputs;
  ASSERT_EQ(outputs.size(), 4U);
  EXPECT_LT(FakeDriver::Get().BytesRead, this->GetBytes() / 50);
  EXPECT_TRUE(this->Outputs == untouched);
  EXPECT_TRUE(outputs[0]->IsOnDevice());
  EXPECT_FALSE(outputs[0]->IsRead());
  EXPECT_EQ(this->CountRead({ outputs[1] }), this->GetBytes() / 11 * 4);
  EXPECT_TRUE(outputs[1]->IsRead());
  EXPECT_FALSE(outputs[1]->IsOnDevice());
  EXPECT_TRUE(outputs[0]->IsOnDevice());
  EXPECT_EQ(this->CountRead(outputs), this->GetBytes() / 11 * 7);
  EXPECT_EQ(this->CountRead(outputs), 0U);
  EXPECT_TRUE(this->Outputs == this->MakeExpected());
  // An output that is never read.
  this->At(5, 3, 2)[0] = 0.75F;
  this->Outputs = untouched;
  outputs = this->Update().DeviceOutputs;
  outputs[0]->Drop();
  EXPECT_FALSE(outputs[0]->IsOnDevice());
  EXPECT_FALSE(outputs[0]->IsRead());
  outputs[0]->Read(); // the dropped output cannot be read
  outputs.clear();
  this->At(5, 3, 2)[0] = 0.5F;
  FakeDriver::Get().BytesRead = 0;
  outputs = this->Update().DeviceOutputs;
  EXPECT_LT(FakeDriver::Get().BytesRead, this->GetBytes() / 50);
  EXPECT_TRUE(this->Outputs == untouched);
  Read(outputs);
  EXPECT_TRUE(this->Outputs == this->MakeExpected());
}

// Outputs on the device when the deformer overwrites or releases its memory, or is deleted.
TEST_P(OutputOnDevice, OutlivesLaterUpdates)
{
  enum
  {
    WholeOutput,
    PartOfTheOutput,
    OtherVolume,
    Release,
    Deletion,
    Failure,
    NumberOfWays
  };
  for (int way = 0; way < NumberOfWays; ++way)
  {
    SCOPED_TRACE("way " + std::to_string(way));
    EditedOutputs next(this->Edited);
    const EditedOutputs expected = this->MakeExpected();
    const DeviceOutputs outputs = this->Update().DeviceOutputs;
    ASSERT_EQ(outputs.size(), 4U);
    const std::uint64_t held = this->Deformer->GetDeviceMemory();
    DeformRequest request = next.MakeRequest(this->Edited);
    request.Incremental = way == PartOfTheOutput;
    this->At(6, 3, 2)[1] += 0.5F;
    switch (way)
    {
      case WholeOutput:
      case PartOfTheOutput:
      {
        request.MayStayOnDevice = true;
        this->Edited.SendDisplacements(*this->Deformer, GetParam());
        const DeformReport report = this->Deformer->Deform(request);
        EXPECT_EQ(report.NumberOfResampledBricks < report.NumberOfBricks, way == PartOfTheOutput);
        EXPECT_FALSE(outputs[0]->IsOnDevice());
        Read(report.DeviceOutputs);
        EXPECT_TRUE(next == this->MakeExpected());
        EXPECT_EQ(this->Deformer->GetDeviceMemory(), held)
          << "the device holds more than one output";
        break;
      }
      case OtherVolume:
        this->Edited.SendAll(*this->Deformer, GetParam());
        break;
      case Release:
        this->Deformer->ReleaseMemory();
        EXPECT_EQ(this->Deformer->GetDeviceMemory(), 0U);
        EXPECT_FALSE(outputs[0]->IsOnDevice());
        break;
      case Deletion:
        this->Deformer = std::make_unique<VolumeDeformer>();
        EXPECT_TRUE(outputs[0]->IsOnDevice());
        break;
      case Failure:
        this->Edited.SendDisplacements(*this->Deformer, GetParam());
        this->Deformer->SetMemoryLimit(1);
        EXPECT_THROW(this->Deformer->Deform(request), Error);
        this->Deformer->SetMemoryLimit(0);
        break;
      default:
        break;
    }
    Read(outputs);
    EXPECT_TRUE(this->Outputs == expected);
    this->Edited.SendAll(*this->Deformer, GetParam());
  }
}

// Random edits, with whole and partial updates. Each output goes to one of three memories, which
// hold earlier outputs, and is read or not.
TEST_P(OutputOnDevice, EqualsWholeOutputs)
{
  std::mt19937 random(static_cast<unsigned>(GetParam()) + 1);
  std::vector<EditedOutputs> memories(3, EditedOutputs(this->Edited));
  std::array<std::array<std::uint64_t, 4>, 3> held{};
  std::array<std::uint64_t, 3> revisions{};
  std::array<DeviceOutputs, 3> outputs;
  std::array<std::optional<EditedOutputs>, 3> expected;
  int parts = 0;
  for (int i = 0; i < GetNumberOfCases(40); ++i)
  {
    SCOPED_TRACE("edit " + std::to_string(i));
    const std::size_t turn = random() % memories.size();
    outputs[turn].clear(); // also outputs that have not been read
    if (i % 9 == 8)
    {
      this->Edited.Move(random, 0, 14.0F); // the volume is folded, and unfolded later
    }
    else if (i % 13 != 5) // sometimes nothing changes
    {
      this->Edited.MoveInside(random, 0.5F);
    }
    this->Request = memories[turn].MakeRequest(this->Edited);
    this->Request.Incremental = i % 17 != 16;
    this->Request.MayStayOnDevice = true;
    this->Request.HeldRevisions.assign(held[turn].begin(), held[turn].end());
    const DeformReport report = this->Update();
    parts += report.NumberOfResampledBricks < report.NumberOfBricks;
    const auto isCovered = [](signed char covered) { return covered != 0; };
    outputs[turn] = report.DeviceOutputs;
    ASSERT_EQ(outputs[turn].size(), 4U);
    expected[turn] = this->MakeExpected();
    EXPECT_EQ(report.NumberOfCoveredVoxels,
      std::count_if(expected[turn]->Coverage.begin(), expected[turn]->Coverage.end(), isCovered));
    revisions[turn] = report.Revision;
    if (random() % 2 == 0) // reads one array; the other arrays of this memory keep earlier outputs
    {
      const std::size_t array = random() % 4;
      outputs[turn][array]->Read();
      held[turn][array] = report.Revision;
    }
    const std::size_t other = random() % memories.size();
    if (!outputs[other].empty()) // reads all arrays, of this output or of an earlier one
    {
      Read(outputs[other]);
      ASSERT_TRUE(memories[other] == *expected[other]);
      held[other].fill(revisions[other]);
    }
  }
  EXPECT_GT(parts, GetNumberOfCases(40) / 3);
}

TEST_P(OutputOnDevice, LocalEditsReadLittle)
{
  DeformReport report = this->Update();
  Read(report.DeviceOutputs);
  this->At(12, 3, 2)[0] = 0.5F;
  this->Request.HeldRevisions.assign(4, report.Revision);
  report = this->Update();
  ASSERT_LT(report.NumberOfResampledBricks, report.NumberOfBricks);
  const std::uint64_t read = this->CountRead(report.DeviceOutputs);
  EXPECT_GT(read, 0U);
  EXPECT_LT(read, this->GetBytes() / 4);
  EXPECT_TRUE(this->Outputs == this->MakeExpected());
  // Nothing has changed.
  this->Request.HeldRevisions.assign(4, report.Revision);
  report = this->Update();
  EXPECT_EQ(this->CountRead(report.DeviceOutputs), 0U);
  EXPECT_TRUE(this->Outputs == this->MakeExpected());
}

TEST_P(OutputOnDevice, OutputsInPartsGoToTheHost)
{
  // Memory for 20 planes of an array of four bytes per voxel.
  this->Deformer->SetAllocationLimit(4 *
    static_cast<std::uint64_t>(GetSize(this->Edited.Output, 0)) *
    static_cast<std::uint64_t>(GetSize(this->Edited.Output, 1)) * 20);
  this->Edited.SendAll(*this->Deformer, GetParam());
  EXPECT_TRUE(this->Update().DeviceOutputs.empty());
  EXPECT_TRUE(this->Outputs == this->MakeExpected());
}

TEST_P(OutputOnDevice, ManyThreadsReadAtOnce)
{
  for (int i = 0; i < 10; ++i)
  {
    this->At(6, 3, 2)[1] += 0.25F;
    const DeviceOutputs outputs = this->Update().DeviceOutputs;
    const EditedOutputs expected = this->MakeExpected();
    FakeDriver::Get().BytesRead = 0;
    std::vector<std::thread> threads;
    std::array<bool, 8> same{};
    for (std::size_t thread = 0; thread < same.size(); ++thread)
    {
      threads.emplace_back(
        [&, thread]
        {
          outputs[thread % 4]->Read();
          same[thread] = thread % 4 == 0 ? this->Outputs.Shorts == expected.Shorts
            : thread % 4 == 1            ? this->Outputs.Floats == expected.Floats
            : thread % 4 == 2            ? this->Outputs.Labels == expected.Labels
                                         : this->Outputs.Coverage == expected.Coverage;
        });
    }
    for (std::thread& thread : threads)
    {
      thread.join();
    }
    EXPECT_TRUE(std::all_of(same.begin(), same.end(), [](bool one) { return one; }));
    EXPECT_EQ(FakeDriver::Get().BytesRead, this->GetBytes());
  }
}

TEST_P(OutputOnDevice, CopiesThatFail)
{
  for (const bool atOnce : { false, true })
  {
    const DeviceOutputs outputs = this->Update().DeviceOutputs;
    const EditedOutputs expected = this->MakeExpected();
    FakeDriver::Get().ReadError = -5;
    FakeDriver::Get().FailsAtOnce = atOnce;
    EXPECT_THROW(outputs[0]->Read(), Error);
    FakeDriver::Get().ReadError = 0;
    FakeDriver::Get().FailsAtOnce = false;
    EXPECT_THROW(outputs[0]->Read(), Error) << "the second call must fail like the first one";
    EXPECT_FALSE(outputs[0]->IsOnDevice());
    EXPECT_FALSE(outputs[0]->IsRead());
    EXPECT_EQ(std::count(this->Outputs.Shorts.begin(), this->Outputs.Shorts.end(), 3),
      static_cast<std::ptrdiff_t>(this->Outputs.Shorts.size()));
    Read({ outputs[1], outputs[2], outputs[3] });
    EXPECT_TRUE(this->Outputs.Floats == expected.Floats);
    // The deformer can still be used.
    this->At(6, 3, 2)[1] += 0.5F;
    Read(this->Update().DeviceOutputs);
    EXPECT_TRUE(this->Outputs == this->MakeExpected());
  }
}

INSTANTIATE_TEST_SUITE_P(
  Routes, OutputOnDevice, testing::Values(Route::Mesh, Route::Runs, Route::Field), GetRouteName);
