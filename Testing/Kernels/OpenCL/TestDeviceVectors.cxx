// SPDX-License-Identifier: BSD-3-Clause
// Vectors on a device: misuse, their record of changes, and volumes that they deform. The outputs
// must equal those with displacements from the host bit for bit. TestDeviceVectorsGraphics runs
// these tests on a device with its own memory.
#include "BoxBounds.h"
#include "CaughtError.h"
#include "ChainMailModel.h"
#include "DeformedBounds.h"
#include "DeformerCase.h"
#include "Device.h"
#include "DeviceNeeds.h"
#include "DeviceVectors.h"
#include "RangeLog.h"
#include "VectorBounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

using namespace deformvolume;

namespace
{

using Matrix = std::array<double, 9>;
using Vectors = std::shared_ptr<DeviceVectors>;

const Matrix Identity = DisplacementField().ToDisplacement;
// A matrix without zeros, symmetries or exact binary fractions.
const Matrix Turned{ { 0.61, -0.23, 0.07, 0.19, 0.71, -0.11, -0.05, 0.13, 0.83 } };

// Random vectors in world units, small enough that the volume is hardly folded.
std::vector<float> MakeVectors(std::size_t points, unsigned int seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> component(-0.4F, 0.4F);
  std::vector<float> vectors(3 * points);
  std::generate(vectors.begin(), vectors.end(), [&] { return component(random); });
  return vectors;
}

std::vector<float> Map(const std::vector<float>& vectors, const Matrix& matrix)
{
  DisplacementField field;
  field.ToDisplacement = matrix;
  field.Vectors = vectors.data();
  std::vector<float> displacements;
  for (std::size_t point = 0; point < vectors.size() / 3; ++point)
  {
    const auto displacement = GetDisplacement(field, static_cast<std::int64_t>(point));
    displacements.insert(displacements.end(), displacement.begin(), displacement.end());
  }
  return displacements;
}

// A volume with a node at each voxel.
struct Subject
{
  explicit Subject(const Extent& extent = { { 0, 21, 0, 18, -1, 17 } },
    const std::array<double, 3>& scale = { { 1, 1, 1 } })
    : Case(MakeCase(extent, scale,
        [&](const glm::dvec3& i) { return i * glm::dvec3(scale[0], scale[1], scale[2]); }))
    , Points(static_cast<std::size_t>(this->Case.GetNumberOfVoxels()))
    , Values(MakeRandomValues<std::int16_t>(this->Points, 3))
    , Arrays{ MakeArray(this->Values) }
  {
  }

  DisplacementField GetField() const
  {
    DisplacementField field;
    for (int axis = 0; axis < 3; ++axis)
    {
      field.Dimensions[axis] = static_cast<int>(GetSize(this->Case.VoxelGrid.VertexExtent, axis));
      field.IndexToField[4 * axis + 3] = -this->Case.VoxelGrid.VertexExtent[2 * axis];
    }
    return field;
  }
  void LoadInto(VolumeDeformer& deformer, Route route) const
  {
    Load(deformer, this->Case, this->Arrays, route);
  }
  std::vector<std::vector<unsigned char>> Run(VolumeDeformer& deformer) const
  {
    return RunDeformer(deformer, this->Case, this->Arrays).Outputs;
  }
  // Returns the outputs of a deformer that has never used vectors on a device.
  std::vector<std::vector<unsigned char>> RunFresh(
    Route route, const std::vector<float>& vectors, const Matrix& matrix) const
  {
    VolumeDeformer deformer;
    this->LoadInto(deformer, route);
    const std::vector<float> displacements = Map(vectors, matrix);
    if (route == Route::Field)
    {
      DisplacementField field = this->GetField();
      field.Vectors = displacements.data();
      deformer.SetDisplacementField(field);
    }
    else
    {
      deformer.SetNodeDisplacements(displacements.data());
    }
    return this->Run(deformer);
  }
  void Move(
    VolumeDeformer& deformer, Route route, const Vectors& vectors, const Matrix& matrix) const
  {
    if (route == Route::Field)
    {
      DisplacementField field = this->GetField();
      field.ToDisplacement = matrix;
      deformer.SetDisplacementField(field, vectors);
    }
    else
    {
      deformer.SetNodeDisplacements(vectors, matrix);
    }
  }

  DeformerCase Case;
  std::size_t Points;
  std::vector<std::int16_t> Values;
  std::vector<VolumeArray> Arrays;
};

Vectors MakeOnDevice(const std::vector<float>& vectors)
{
  const auto made = std::make_shared<DeviceVectors>("", vectors.size() / 3);
  made->Write(vectors.data());
  return made;
}

} // namespace

TEST(RangeLog, RemembersTheLastRanges)
{
  RangeLog log;
  EXPECT_EQ(log.GetRevision(), 0U);
  EXPECT_EQ(log.GetSince(0), PointRanges());
  EXPECT_FALSE(log.GetSince(1)) << "the revision is not yet reached";
  log.Add({ { { 3, 5 } }, { { 9, 10 } } });
  const std::uint64_t first = log.GetRevision();
  EXPECT_GT(first, 0U);
  log.Add({ { { 1, 2 } } });
  EXPECT_EQ(log.GetSince(0)->size(), 3U);
  EXPECT_EQ(log.GetSince(first), (PointRanges{ { { 1, 2 } } }));
  EXPECT_EQ(log.GetSince(log.GetRevision()), PointRanges());
  for (std::size_t i = 0; i + 1 < RangeLog::MostEntries; ++i)
  {
    log.Add({ { { i, i + 1 } } });
  }
  EXPECT_FALSE(log.GetSince(0)) << "ranges of the first revision were discarded";
  EXPECT_EQ(log.GetSince(first)->size(), RangeLog::MostEntries);
  const std::uint64_t before = log.GetRevision();
  log.AddAll();
  EXPECT_FALSE(log.GetSince(before));
  EXPECT_EQ(log.GetSince(log.GetRevision()), PointRanges());
  log.Add(PointRanges(RangeLog::MostEntries + 1, { { 0, 1 } }));
  EXPECT_FALSE(log.GetSince(before + 1)) << "more ranges than the log keeps";
}

TEST(DeviceVectors, Misuse)
{
  EXPECT_NE(GetError([] { DeviceVectors("", 0); }).find("at least one point"), std::string::npos);
  EXPECT_NE(
    GetError([] { DeviceVectors("no such device", 3); }).find("no such device"), std::string::npos);
  DeviceVectors three("", 3);
  EXPECT_NE(GetError([&] { three.Write(nullptr); }), "");
  EXPECT_NE(GetError([&] { three.Write(nullptr, { { { 0, 1 } } }); }), "");
  EXPECT_EQ(three.GetRevision(), 0U);

  const Subject subject(Extent{ { 0, 4, 0, 4, 0, 4 } });
  const Vectors few = std::make_shared<DeviceVectors>("", subject.Points - 1);
  VolumeDeformer deformer;
  EXPECT_NE(GetError([&] { deformer.SetNodeDisplacements(few); }), "") << "without a volume";
  deformer.SetVoxelGrid(subject.Case.VoxelGrid);
  EXPECT_NE(
    GetError([&] { deformer.SetNodeDisplacements(few); }).find("SetMesh"), std::string::npos);
  for (const Route route : { Route::Mesh, Route::Field })
  {
    subject.LoadInto(deformer, route);
    const auto expected = subject.Run(deformer);
    const auto getError = [&](const Vectors& vectors)
    { return GetError([&] { subject.Move(deformer, route, vectors, Identity); }); };
    EXPECT_NE(getError(nullptr).find("vectors on a device are null"), std::string::npos);
    EXPECT_NE(getError(few).find(std::to_string(subject.Points - 1) +
                " vectors on the device for " + std::to_string(subject.Points) + " points"),
      std::string::npos);
    EXPECT_EQ(subject.Run(deformer), expected) << "an error must not change the deformation";
  }
  DisplacementField empty;
  EXPECT_NE(GetError([&] { deformer.SetDisplacementField(empty, few); }), "");
}

// The test needs several devices: see Kernels.DeviceVectorsOnTwoDevices.
TEST(DeviceVectors, AnotherDevice)
{
  const std::vector<std::string> names = GetDeviceNames();
  if (names.size() < 2)
  {
    GTEST_SKIP() << "There is one device only.";
  }
  const Subject subject(Extent{ { 0, 4, 0, 4, 0, 4 } });
  VolumeDeformer deformer;
  subject.LoadInto(deformer, Route::Mesh); // on the first device
  const Vectors there = std::make_shared<DeviceVectors>(names[1], subject.Points);
  ASSERT_EQ(there->GetDevice(), names[1]);
  const std::string error = GetError([&] { deformer.SetNodeDisplacements(there); });
  for (const std::size_t device : { 0, 1 })
  {
    EXPECT_NE(error.find("\"" + names[device] + "\""), std::string::npos) << error;
  }
}

TEST(DeviceVectors, ReadAndWritten)
{
  constexpr std::size_t points = 1000;
  DeviceVectors vectors("", points);
  EXPECT_EQ(vectors.GetNumberOfPoints(), points);
  EXPECT_EQ(vectors.GetDevice(), ResolveDevice(""));
  EXPECT_EQ(vectors.GetDeviceMemory(), 12 * points);
  EXPECT_TRUE(std::all_of(
    vectors.Read(), vectors.Read() + 3 * points, [](float value) { return value == 0.0F; }));
  std::vector<float> expected = MakeVectors(points, 1);
  vectors.Write(expected.data());
  const std::uint64_t whole = vectors.GetRevision();
  EXPECT_FALSE(vectors.GetChanges(0)) << "all vectors have changed";
  EXPECT_EQ(std::memcmp(vectors.Read(), expected.data(), 12 * points), 0);
  // Only the points in the ranges are read.
  std::vector<float> others = MakeVectors(points, 2);
  vectors.Write(others.data(), { { { 5, 9 } }, { { 998, 2000 } }, { { 7, 7 } } });
  std::copy(others.begin() + 15, others.begin() + 27, expected.begin() + 15);
  std::copy(others.begin() + 2994, others.end(), expected.begin() + 2994);
  EXPECT_EQ(std::memcmp(vectors.Read(), expected.data(), 12 * points), 0);
  PointRanges changes = vectors.GetChanges(whole).value();
  std::sort(changes.begin(), changes.end());
  EXPECT_EQ(changes, (PointRanges{ { { 5, 9 } }, { { 998, 1000 } } }));
  const std::uint64_t revision = vectors.GetRevision();
  vectors.Write(others.data(), { { { 1000, 1001 } } });
  EXPECT_EQ(vectors.GetRevision(), revision) << "the range contains no points";
}

class DeviceVectorsRoutes : public testing::TestWithParam<Route>
{
};

TEST_P(DeviceVectorsRoutes, EqualsHost)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const Subject subject;
  VolumeDeformer deformer;
  subject.LoadInto(deformer, GetParam());
  const Vectors shared = std::make_shared<DeviceVectors>("", subject.Points);
  std::vector<float> vectors = MakeVectors(subject.Points, 1);
  for (const Matrix& matrix : { Identity, Turned })
  {
    shared->Write(vectors.data());
    subject.Move(deformer, GetParam(), shared, matrix);
    EXPECT_EQ(subject.Run(deformer), subject.RunFresh(GetParam(), vectors, matrix));
    // Frames in which some of the points move.
    for (std::size_t frame = 1; frame < 4; ++frame)
    {
      const std::size_t first = 700 * frame;
      const std::size_t end = first + (frame == 2 ? 2000 : 5);
      std::fill(vectors.begin() + 3 * static_cast<std::ptrdiff_t>(first),
        vectors.begin() + 3 * static_cast<std::ptrdiff_t>(end), 0.125F * static_cast<float>(frame));
      shared->Write(vectors.data(), { { { first, end } } });
      subject.Move(deformer, GetParam(), shared, matrix);
      EXPECT_EQ(subject.Run(deformer), subject.RunFresh(GetParam(), vectors, matrix))
        << "frame " << frame;
    }
    subject.Move(deformer, GetParam(), shared, matrix);
    EXPECT_EQ(subject.Run(deformer), subject.RunFresh(GetParam(), vectors, matrix))
      << "after an update without a change";
  }
}

// The changes of one object of vectors are irrelevant after another object was used.
TEST_P(DeviceVectorsRoutes, AlternateWithOtherVectors)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const Subject subject;
  VolumeDeformer deformer;
  subject.LoadInto(deformer, GetParam());
  std::vector<float> one = MakeVectors(subject.Points, 1);
  const std::vector<float> two = MakeVectors(subject.Points, 2);
  const std::vector<float> host = MakeVectors(subject.Points, 3);
  const Vectors first = MakeOnDevice(one);
  const Vectors second = MakeOnDevice(two);
  for (int turn = 0; turn < 2; ++turn)
  {
    subject.Move(deformer, GetParam(), first, Turned);
    EXPECT_EQ(subject.Run(deformer), subject.RunFresh(GetParam(), one, Turned));
    subject.Move(deformer, GetParam(), second, Turned);
    EXPECT_EQ(subject.Run(deformer), subject.RunFresh(GetParam(), two, Turned));
    const std::vector<float> displacements = Map(host, Identity);
    if (GetParam() == Route::Field)
    {
      DisplacementField field = subject.GetField();
      field.Vectors = displacements.data();
      deformer.SetDisplacementField(field);
    }
    else
    {
      deformer.SetNodeDisplacements(displacements.data());
    }
    EXPECT_EQ(subject.Run(deformer), subject.RunFresh(GetParam(), host, Identity));
    // The vectors have not changed, but the deformer has other displacements now.
    subject.Move(deformer, GetParam(), second, Turned);
    EXPECT_EQ(subject.Run(deformer), subject.RunFresh(GetParam(), two, Turned));
    one[30] = 0.25F;
    first->Write(one.data(), { { { 10, 11 } } });
  }
  subject.LoadInto(deformer, Route::Mesh);
  deformer.SetNodeDisplacements(first, Turned);
  EXPECT_EQ(subject.Run(deformer), subject.RunFresh(Route::Mesh, one, Turned))
    << "after another mesh was set";
}

TEST_P(DeviceVectorsRoutes, NonFiniteVectors)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const Subject subject;
  VolumeDeformer deformer;
  subject.LoadInto(deformer, GetParam());
  std::vector<float> vectors = MakeVectors(subject.Points, 1);
  const Vectors shared = MakeOnDevice(vectors);
  const std::string name = GetParam() == Route::Field ? "point 7 " : "node 7 ";
  for (const float bad :
    { std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity(), 40000.0F })
  {
    std::vector<float> wrong = vectors;
    wrong[3 * 7 + 1] = wrong[3 * 2000] = bad;
    shared->Write(wrong.data(), { { { 7, 8 } }, { { 2000, 2001 } } });
    const std::string error = GetError([&] { subject.Move(deformer, GetParam(), shared, Turned); });
    EXPECT_NE(error.find("displacement of " + name), std::string::npos) << error;
    shared->Write(vectors.data(), { { { 7, 8 } }, { { 2000, 2001 } } });
    subject.Move(deformer, GetParam(), shared, Turned);
    EXPECT_EQ(subject.Run(deformer), subject.RunFresh(GetParam(), vectors, Turned));
  }
}

INSTANTIATE_TEST_SUITE_P(
  All, DeviceVectorsRoutes, testing::Values(Route::Field, Route::Mesh, Route::Runs));

// The voxels lie between the points of the field.
TEST(DeviceVectors, FieldsOfAnotherGrid)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const Subject subject;
  DisplacementField field;
  field.Dimensions = { { 9, 8, 7 } };
  field.IndexToField = { { 0.3, 0, 0, 1, 0, 0.3, 0, 0.5, 0, 0, 0.3, 0.5 } };
  field.ToDisplacement = Turned;
  const std::vector<float> vectors = MakeVectors(9 * 8 * 7, 1);
  VolumeDeformer deformer;
  subject.LoadInto(deformer, Route::Field);
  deformer.SetDisplacementField(field, MakeOnDevice(vectors));
  const auto found = subject.Run(deformer);
  field.Vectors = vectors.data();
  VolumeDeformer fresh;
  subject.LoadInto(fresh, Route::Field);
  fresh.SetDisplacementField(field);
  EXPECT_EQ(found, subject.Run(fresh));
}

// Appended nodes have vectors, too.
TEST(DeviceVectors, ConnectivityChanges)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const Subject subject;
  VolumeDeformer deformer;
  subject.LoadInto(deformer, Route::Mesh);
  std::vector<float> vectors = MakeVectors(subject.Points, 1);
  deformer.SetNodeDisplacements(MakeOnDevice(vectors), Turned);
  subject.Run(deformer);
  // Tetrahedron 4 contains voxel 4 at its first node. Another node replaces this node.
  const auto size = static_cast<std::int32_t>(subject.Points);
  const Tetrahedron before{ { 4, 5, 6, 7 } };
  const TetrahedronChange change{ 4, before, { { size + 1, 5, 6, 7 } } };
  const std::vector<TetrahedronChange> changes{ change };
  std::vector<Tetrahedron> unused(subject.Points);
  deformer.ChangeConnectivity(unused.data(), subject.Points, subject.Points + 2, &changes);
  std::vector<float> more = vectors;
  more.insert(more.end(), { 0.0F, 0.0F, 0.0F, 0.375F, -0.25F, 0.125F });
  deformer.SetNodeDisplacements(MakeOnDevice(more), Turned);
  std::copy_n(more.end() - 3, 3, vectors.begin() + 12);
  EXPECT_EQ(subject.Run(deformer), subject.RunFresh(Route::Mesh, vectors, Turned));
}

// Bounds are found on the device of the vectors, or not at all.
TEST(DeviceVectors, Bounds)
{
  const Subject subject(Extent{ { 2, 21, -3, 18, -1, 17 } });
  VoxelGrid grid = subject.Case.VoxelGrid;
  grid.ToOutput = std::array<double, 3>{ { 0.3, 1.7, 0.6 } };
  DisplacementField field = subject.GetField();
  // Points without voxels do not count.
  for (int axis = 0; axis < 3; ++axis)
  {
    field.Dimensions[axis] += 3;
    field.IndexToField[4 * axis + 3] += 1;
  }
  const auto points = static_cast<std::size_t>(GetNumberOfPoints(field));
  std::vector<float> vectors = MakeVectors(points, 1);
  std::fill(vectors.begin(), vectors.begin() + 30, 3000.0F);
  const Vectors shared = MakeOnDevice(vectors);
  const bool isPossible = !shared->AreInHostMemory() && GetDeviceAbilities("").DoublePrecision;
  for (const Matrix& matrix : { Identity, Turned })
  {
    field.ToDisplacement = matrix;
    field.Vectors = vectors.data();
    const IndexBounds expected = ComputeDeformedBounds(grid, field);
    field.Vectors = nullptr;
    const std::optional<IndexBounds> found = FindDeformedBounds(grid, field, *shared);
    ASSERT_EQ(found.has_value(), isPossible);
    if (found)
    {
      EXPECT_EQ(found->Min, expected.Min);
      EXPECT_EQ(found->Max, expected.Max);
    }
  }
  EXPECT_THROW(FindDeformedBounds(grid, subject.GetField(), *shared), Error) << "fewer points";
  field.IndexToField[0] = 0.5;
  EXPECT_FALSE(FindDeformedBounds(grid, field, *shared)) << "voxels between points";
  field.IndexToField[0] = 1.0;
  const std::size_t inside = points / 2 + 10 * 23 + 10; // neither at an end of a row nor of a plane
  vectors[3 * inside] = std::numeric_limits<float>::quiet_NaN();
  shared->Write(vectors.data(), { { { inside, inside + 1 } } });
  EXPECT_FALSE(FindDeformedBounds(grid, field, *shared)) << "not finite";
}

// Two drags: the displacements of one stay on the device, and those of the other are copied to the
// host.
TEST(DeviceVectors, OutputOfChainMail)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const Extent extent{ { 0, 21, 0, 18, -1, 17 } };
  const std::array<double, 9> toWorld{ { 0.5, 0, 0, 0, 0.5, 0, 0, 0, 2 } };
  const Matrix toIndex{ { 2, 0, 0, 0, 2, 0, 0, 0, 0.5 } };
  const Subject subject(extent);
  ChainMailModel models[2];
  std::vector<float> host(3 * subject.Points);
  const auto output = std::make_shared<DeviceVectors>("", subject.Points);
  EXPECT_NE(GetError([&] { models[0].SetOutput(output); }), "") << "without a volume";
  for (ChainMailModel& model : models)
  {
    model.SetVoxelGrid(extent, toWorld);
  }
  EXPECT_NE(GetError([&] { models[0].SetOutput(Vectors()); }).find("vectors on a device are null"),
    std::string::npos);
  EXPECT_NE(GetError([&] { models[0].SetOutput(std::make_shared<DeviceVectors>("", 5)); }), "");
  models[0].SetOutput(output);
  models[1].SetOutput(host.data());
  VolumeDeformer deformer;
  subject.LoadInto(deformer, Route::Field);
  const auto expectSame = [&]
  {
    ASSERT_EQ(std::memcmp(output->Read(), host.data(), 12 * subject.Points), 0);
    subject.Move(deformer, Route::Field, output, toIndex);
    EXPECT_EQ(subject.Run(deformer), subject.RunFresh(Route::Field, host, toIndex));
  };
  for (int step = 1; step <= 3; ++step)
  {
    ChainMailRequest request;
    request.Handles.resize(1);
    request.Handles[0].RestPosition = { { 10, 9, 8 } };
    request.Handles[0].Displacement = { { 0.7 * step, -0.3 * step, 0.25 * step } };
    request.RelaxationSweeps = 2;
    const std::uint64_t before = output->GetRevision();
    const ChainMailReport report = models[0].Step(request);
    models[1].Step(request);
    ASSERT_GT(report.NumberOfMovedVoxels, 0);
    const std::optional<PointRanges> changes = output->GetChanges(before);
    ASSERT_TRUE(changes);
    std::size_t changed = 0;
    for (const auto& range : *changes)
    {
      changed += range[1] - range[0];
    }
    EXPECT_GE(changed, static_cast<std::size_t>(report.NumberOfMovedVoxels));
    EXPECT_LT(changed, subject.Points);
    expectSame();
  }
  for (ChainMailModel& model : models)
  {
    model.Reset();
  }
  expectSame();
  // The output is host memory again.
  ChainMailRequest request;
  request.Handles.resize(1);
  request.Handles[0].RestPosition = { { 10, 9, 8 } };
  request.Handles[0].Displacement = { { 1, 0, 0 } };
  models[1].Step(request);
  std::vector<float> other(3 * subject.Points);
  models[0].SetOutput(other.data());
  models[0].Step(request);
  EXPECT_EQ(other, host);
}

TEST(DeviceVectors, TinyEqualsHost)
{
  const Subject subject(Extent{ { 0, 3, 0, 3, 0, 3 } });
  const std::vector<float> vectors = MakeVectors(subject.Points, 1);
  const Vectors shared = MakeOnDevice(vectors);
  for (const Route route : { Route::Field, Route::Mesh })
  {
    VolumeDeformer deformer;
    subject.LoadInto(deformer, route);
    for (const Matrix& matrix : { Identity, Turned })
    {
      subject.Move(deformer, route, shared, matrix);
      EXPECT_EQ(subject.Run(deformer), subject.RunFresh(route, vectors, matrix));
    }
  }
  FindDeformedBounds(subject.Case.VoxelGrid, subject.GetField(), *shared);
}

TEST(DeviceVectors, TinyBoxes)
{
  WorkDevice device;
  const std::array<int, 3> size{ { 5, 4, 3 } };
  const std::vector<float> vectors = MakeVectors(80, 1); // 60 vectors of four floats
  cl::Buffer there;
  device.Send(there, vectors.data(), 60 * 4 * sizeof(float));
  const std::vector<Extent> boxes{ { { 0, 4, 0, 3, 0, 2 } }, { { 4, 4, 3, 3, 2, 2 } },
    { { 1, 3, 0, 1, 1, 2 } } };
  EXPECT_TRUE(FindBoxBounds(device, there, size, {}).empty());
  const std::vector<DisplacementBounds> found = FindBoxBounds(device, there, size, boxes);
  ASSERT_EQ(found.size(), boxes.size());
  for (std::size_t box = 0; box < boxes.size(); ++box)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      float least = 1.0F;
      float greatest = -1.0F;
      for (int z = boxes[box][4]; z <= boxes[box][5]; ++z)
      {
        for (int y = boxes[box][2]; y <= boxes[box][3]; ++y)
        {
          for (int x = boxes[box][0]; x <= boxes[box][1]; ++x)
          {
            const float next = vectors[4 * static_cast<std::size_t>((z * 4 + y) * 5 + x) + axis];
            least = std::min(least, next);
            greatest = std::max(greatest, next);
          }
        }
      }
      EXPECT_EQ(found[box].Min[axis], least);
      EXPECT_EQ(found[box].Max[axis], greatest);
    }
  }
}
