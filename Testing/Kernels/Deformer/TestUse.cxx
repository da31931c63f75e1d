// SPDX-License-Identifier: BSD-3-Clause
// The order of calls: misuse, repeated use, masks that are set and removed, memory, progress and
// abort.
#include "DeformerCase.h"
#include "Device.h"
#include "MemoryNeeds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

using namespace deformvolume;

namespace
{

DeformerCase MakeSmallCase(unsigned int seed = 1)
{
  return MakeCase({ { 0, 7, 0, 6, 0, 5 } }, { { 1, 1, 1 } }, MakeJitter(seed, 0.15));
}

std::string GetError(const std::function<void()>& function)
{
  try
  {
    function();
  }
  catch (const Error& error)
  {
    EXPECT_GT(std::strlen(error.what()), 20U)
      << "the message is too short to say what is wrong: " << error.what();
    return error.what();
  }
  ADD_FAILURE() << "expected an error, but none was thrown";
  return "";
}

class DeformerUse : public testing::Test
{
protected:
  DeformerCase Case = MakeSmallCase();
  reference::Result Reference = ResampleByReference(this->Case);
  std::vector<float> Values = MakeRandomValues<float>(this->Case.GetNumberOfVoxels(), 3);
  std::vector<VolumeArray> Arrays{ MakeArray(this->Values) };
  std::vector<signed char> Coverage =
    std::vector<signed char>(GetNumberOfPoints(this->Case.Output));
  std::vector<float> Output = std::vector<float>(GetNumberOfPoints(this->Case.Output));
  VolumeDeformer Deformer;

  DeformRequest MakeRequest()
  {
    DeformRequest request;
    request.OutputExtent = this->Case.Output;
    request.Outputs = { this->Output.data() };
    request.Coverage = this->Coverage.data();
    return request;
  }
  /// Checks that the deformer works after any error.
  void ExpectUsable()
  {
    SCOPED_TRACE("after the error");
    ASSERT_NO_THROW(Load(this->Deformer, this->Case, this->Arrays, Route::Field));
    ExpectEqualsReference(this->Case, this->Reference, this->Arrays,
      RunDeformer(this->Deformer, this->Case, this->Arrays));
  }
};

} // namespace

TEST_F(DeformerUse, DeformBeforeAnythingIsSet)
{
  GetError([&] { this->Deformer.Deform(this->MakeRequest()); });
  this->Deformer.SetDevice("");
  GetError([&] { this->Deformer.Deform(this->MakeRequest()); });
  this->Deformer.SetVoxelGrid(this->Case.VoxelGrid);
  GetError([&] { this->Deformer.Deform(this->MakeRequest()); });
  this->Deformer.SetArrays(this->Arrays);
  GetError([&] { this->Deformer.Deform(this->MakeRequest()); });
  this->ExpectUsable();
}

TEST_F(DeformerUse, MeshWithoutDisplacements)
{
  Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
  const std::vector<VertexLink> links(this->Case.GetNumberOfVoxels());
  const Tetrahedron tetrahedron{ { 0, 1, 2, 3 } };
  this->Deformer.SetMesh(&tetrahedron, 1, 4, links.data());
  GetError([&] { this->Deformer.Deform(this->MakeRequest()); });
  this->ExpectUsable();
}

TEST_F(DeformerUse, SettersInAnyOrder)
{
  GetError([&] { this->Deformer.SetArrays(this->Arrays); });
  GetError([&] { this->Deformer.SetNodeDisplacements(this->Values.data()); });
  this->ExpectUsable();
}

TEST_F(DeformerUse, WrongNumberOfOutputs)
{
  Load(this->Deformer, this->Case, this->Arrays, Route::Field);
  DeformRequest request = this->MakeRequest();
  request.Outputs.clear();
  GetError([&] { this->Deformer.Deform(request); });
  request.Outputs = { this->Output.data(), this->Output.data() };
  GetError([&] { this->Deformer.Deform(request); });
  this->ExpectUsable();
}

TEST_F(DeformerUse, EmptyExtents)
{
  Load(this->Deformer, this->Case, this->Arrays, Route::Field);
  DeformRequest request = this->MakeRequest();
  request.OutputExtent = { { 0, -1, 0, 3, 0, 3 } };
  GetError([&] { this->Deformer.Deform(request); });
  VoxelGrid voxelGrid;
  GetError([&] { this->Deformer.SetVoxelGrid(voxelGrid); });
  voxelGrid.VertexExtent = { { 0, 5, 0, 5, 3, 3 } };
  GetError([&] { this->Deformer.SetVoxelGrid(voxelGrid); });
  this->ExpectUsable();
}

TEST_F(DeformerUse, IndicesOutsideTheMesh)
{
  Load(this->Deformer, this->Case, this->Arrays, Route::Field);
  std::vector<VertexLink> links(this->Case.GetNumberOfVoxels());
  const Tetrahedron outside{ { 0, 1, 2, 4 } };
  GetError([&] { this->Deformer.SetMesh(&outside, 1, 4, links.data()); });
  const Tetrahedron inside{ { 0, 1, 2, 3 } };
  links[5].Tetrahedron = 1;
  GetError([&] { this->Deformer.SetMesh(&inside, 1, 4, links.data()); });
  this->ExpectUsable();
}

// Positions relative to an output that is 2^24 voxels away overflow 32 bits.
TEST_F(DeformerUse, OutputsFarAway)
{
  Load(this->Deformer, this->Case, this->Arrays, Route::Field);
  for (int axis = 0; axis < 3; ++axis)
  {
    for (const int offset : { -(1 << 24), -(1 << 23), -100000, 1 << 20, 1 << 22, 1 << 23, 1 << 24 })
    {
      SCOPED_TRACE(testing::Message() << "axis " << axis << " offset " << offset);
      DeformerCase away = this->Case;
      away.Output[2 * axis] += offset;
      away.Output[2 * axis + 1] += offset;
      for (const Resampling method : { Resampling::Exact, Resampling::ExactByCell })
      {
        const Deformed deformed = RunDeformer(this->Deformer, away, this->Arrays, method);
        EXPECT_EQ(deformed.Report.NumberOfCoveredVoxels, 0);
        EXPECT_FALSE(deformed.Report.Overlapping);
        EXPECT_EQ(std::count(deformed.Coverage.begin(), deformed.Coverage.end(), 0),
          static_cast<std::ptrdiff_t>(deformed.Coverage.size()));
      }
    }
  }
  this->ExpectUsable();
}

TEST_F(DeformerUse, UnknownDevice)
{
  const std::string error = GetError([&] { this->Deformer.SetDevice("no such device"); });
  EXPECT_NE(error.find("no such device"), std::string::npos) << error;
  GetError([] { ResolveDevice("no such device"); });
  this->ExpectUsable();
}

TEST_F(DeformerUse, DeviceNames)
{
  const std::vector<std::string> names = GetDeviceNames();
  ASSERT_FALSE(names.empty());
  EXPECT_EQ(ResolveDevice(names.front()), names.front());
  EXPECT_EQ(this->Deformer.SetDevice(names.front()), names.front());
  this->ExpectUsable();
}

TEST_F(DeformerUse, NotEnoughMemory)
{
  this->Deformer.SetDevice("");
  this->Deformer.SetMemoryLimit(12345);
  VoxelGrid voxelGrid;
  voxelGrid.VertexExtent = { { 0, 99, 0, 99, 0, 99 } };
  const std::string error = GetError(
    [&]
    {
      this->Deformer.CheckMemory({ voxelGrid, this->Arrays, voxelGrid.VertexExtent, 100, 200,
        GetMappingBytes(voxelGrid, false, 0), false });
    });
  EXPECT_NE(error.find("12345"), std::string::npos) << error;
  // The needed number of bytes is at least that of a volume with 4 bytes per voxel.
  std::size_t largest = 0;
  for (std::size_t i = 0; i < error.size(); ++i)
  {
    if (std::isdigit(static_cast<unsigned char>(error[i])) != 0)
    {
      std::size_t length = 0;
      largest = std::max<std::size_t>(largest, std::stoull(error.substr(i), &length));
      i += length;
    }
  }
  EXPECT_GE(largest, 4000000U) << error;
  EXPECT_LE(largest, 64000000U) << error;
  GetError(
    [&]
    {
      Load(this->Deformer, this->Case, this->Arrays, Route::Field);
      this->Deformer.SetMemoryLimit(1);
      this->Deformer.Deform(this->MakeRequest());
    });
  this->Deformer.SetMemoryLimit(0);
  this->ExpectUsable();
}

// Memory for winners is requested only if tetrahedra overlap.
TEST_F(DeformerUse, NotEnoughMemoryForAFold)
{
  // CheckMemory() also counts memory that this case does not use. The output is so large that its
  // winners do not fit into that memory.
  const DeformerCase folded =
    MakeCase(this->Case.VoxelGrid.VertexExtent, { { 1, 1, 1 } }, MakeJitter(3, 1.0), 10);
  const auto nodes = static_cast<std::size_t>(this->Case.GetNumberOfVoxels());
  std::uint64_t limit = 1000;
  for (bool enough = false; !enough; limit += enough ? 0 : 100)
  {
    this->Deformer.SetMemoryLimit(limit);
    try
    {
      this->Deformer.CheckMemory(
        { folded.VoxelGrid, this->Arrays, folded.Output, nodes, 0, 0, false });
      enough = true;
    }
    catch (const Error&)
    {
      ASSERT_LT(limit, 1000000U);
    }
  }
  Load(this->Deformer, folded, this->Arrays, Route::Field);
  const std::string error = GetError([&] { RunDeformer(this->Deformer, folded, this->Arrays); });
  EXPECT_NE(error.find("folds"), std::string::npos) << error;
  // The keys of the winners, and the states of patches of the output.
  std::int64_t patches = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    patches *= (GetSize(folded.Output, axis) + 7) / 8;
  }
  this->Deformer.SetMemoryLimit(limit + 4 * GetNumberOfPoints(folded.Output) + 2 * patches);
  ExpectEqualsReference(folded, ResampleByReference(folded), this->Arrays,
    RunDeformer(this->Deformer, folded, this->Arrays));
  this->Deformer.SetMemoryLimit(0);
  this->ExpectUsable();
}

TEST_F(DeformerUse, MemoryIsCountedAndReleased)
{
  EXPECT_EQ(this->Deformer.GetDeviceMemory(), 0U);
  this->ExpectUsable();
  const std::uint64_t used = this->Deformer.GetDeviceMemory();
  EXPECT_GE(used, this->Values.size() * sizeof(float));
  this->ExpectUsable();
  EXPECT_EQ(this->Deformer.GetDeviceMemory(), used);
  this->Deformer.ReleaseMemory();
  EXPECT_EQ(this->Deformer.GetDeviceMemory(), 0U);
  this->ExpectUsable();
}

TEST_F(DeformerUse, AbortedByProgress)
{
  Load(this->Deformer, this->Case, this->Arrays, Route::Field);
  DeformRequest request = this->MakeRequest();
  int calls = 0;
  double last = 0.0;
  request.Progress = [&](double fraction)
  {
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1.0);
    last = fraction;
    ++calls;
    return true;
  };
  this->Deformer.Deform(request);
  ASSERT_GT(calls, 0);
  for (int allowed = 0; allowed < calls; ++allowed)
  {
    int left = allowed;
    request.Progress = [&left](double) { return left-- > 0; };
    EXPECT_THROW(this->Deformer.Deform(request), Aborted)
      << "abort after " << allowed << " of " << calls << " calls";
  }
  // The data need not be loaded again.
  ExpectEqualsReference(this->Case, this->Reference, this->Arrays,
    RunDeformer(this->Deformer, this->Case, this->Arrays));
}

TEST_F(DeformerUse, ManyUpdates)
{
  Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
  for (unsigned int seed = 10; seed < 14; ++seed)
  {
    SCOPED_TRACE(seed);
    const DeformerCase moved = MakeSmallCase(seed);
    std::vector<float> displacements;
    for (const auto& displacement : moved.Displacements)
    {
      for (const std::int64_t component : displacement)
      {
        displacements.push_back(static_cast<float>(component) / 256.0F);
      }
    }
    this->Deformer.SetNodeDisplacements(displacements.data());
    ExpectEqualsReference(moved, ResampleByReference(moved), this->Arrays,
      RunDeformer(this->Deformer, moved, this->Arrays));
  }
}

TEST_F(DeformerUse, MasksAreSetAndRemoved)
{
  Load(this->Deformer, this->Case, this->Arrays, Route::Field);
  const auto check = [this]
  {
    const reference::Result reference = ResampleByReference(this->Case);
    ExpectEqualsReference(
      this->Case, reference, this->Arrays, RunDeformer(this->Deformer, this->Case, this->Arrays));
    return reference.NumberOfCoveredVoxels;
  };
  const std::int64_t all = check();
  this->Case.Blanked.assign(this->Case.GetNumberOfVoxels(), 0);
  this->Case.Blanked[3 * 8 * 7 + 3 * 8 + 3] = 1;
  this->Deformer.SetBlanked(this->Case.Blanked.data());
  EXPECT_LT(check(), all);
  this->Case.Blanked.clear();
  this->Deformer.SetBlanked(nullptr);
  EXPECT_EQ(check(), all);
  this->Case.Active.assign(GetNumberOfCells(this->Case.VoxelGrid.VertexExtent), 31);
  std::fill(this->Case.Active.begin(), this->Case.Active.begin() + 60, 0x12);
  this->Deformer.SetActiveTetrahedra(this->Case.Active.data());
  EXPECT_LT(check(), all);
  std::fill(this->Case.Active.begin(), this->Case.Active.end(), 0);
  this->Deformer.SetActiveTetrahedra(this->Case.Active.data());
  EXPECT_EQ(check(), 0);
  this->Case.Active.clear();
  this->Deformer.SetActiveTetrahedra(nullptr);
  EXPECT_EQ(check(), all);
}

TEST_F(DeformerUse, ArraysAreReplaced)
{
  this->ExpectUsable();
  const auto labels = MakeRandomValues<std::uint64_t>(this->Values.size() * 2, 4);
  const std::vector<VolumeArray> arrays{ MakeArray(labels, 2, true), MakeArray(this->Values) };
  this->Deformer.SetArrays(arrays);
  ExpectEqualsReference(
    this->Case, this->Reference, arrays, RunDeformer(this->Deformer, this->Case, arrays));
}

TEST_F(DeformerUse, TimesAreMeasured)
{
  Load(this->Deformer, this->Case, this->Arrays, Route::Field);
  const DeformReport report = RunDeformer(this->Deformer, this->Case, this->Arrays).Report;
  EXPECT_EQ(report.MappingTime, 0.0);
  EXPECT_GT(report.ResamplingTime, 0.0);
  EXPECT_GT(report.TransferTime, 0.0);
  EXPECT_LT(report.ResamplingTime + report.TransferTime, 60.0);
}

TEST_F(DeformerUse, TwoDeformersSideBySide)
{
  VolumeDeformer other;
  const DeformerCase otherCase = MakeSmallCase(99);
  Load(this->Deformer, this->Case, this->Arrays, Route::Field);
  Load(other, otherCase, this->Arrays, Route::Mesh);
  ExpectEqualsReference(this->Case, this->Reference, this->Arrays,
    RunDeformer(this->Deformer, this->Case, this->Arrays));
  ExpectEqualsReference(otherCase, ResampleByReference(otherCase), this->Arrays,
    RunDeformer(other, otherCase, this->Arrays));
}
