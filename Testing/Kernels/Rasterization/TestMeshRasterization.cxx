// SPDX-License-Identifier: BSD-3-Clause
// The resampler MeshRasterization, compared with a brute-force reference: misuse, coverage, values,
// and that results do not depend on tiles, slabs and work-groups.
#include "AllTypes.h"
#include "CaughtError.h"
#include "DeviceNeeds.h"
#include "RasterCase.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

using namespace deformvolume;

namespace
{

glm::dvec3 Wave(const glm::dvec3& index)
{
  return index +
    glm::dvec3(0.8 * std::sin(0.5 * index.y) + 0.31, 0.6 * std::cos(0.4 * index.z) - 0.17,
      0.7 * std::sin(0.3 * index.x));
}

} // namespace

TEST(MeshRasterization, MisuseLeavesTheDeformerUsable)
{
  const RasterCase good = MakeRasterCase(Volume, 2, Wave, { { 1, 1, 1 } });
  const UsualArrays usual(good.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  VolumeDeformer deformer;
  deformer.SetDevice("");
  deformer.SetVoxelGrid(good.VoxelGrid);
  deformer.SetArrays(arrays);
  EXPECT_NE(
    GetError([&] { Rasterize(deformer, good, arrays); }).find("SetRestMesh"), std::string::npos);
  EXPECT_NE(
    GetError([&] { deformer.SetNodeDisplacements(good.Displacements.data()); }).find("SetMesh"),
    std::string::npos);
  EXPECT_NE(GetError(
              [&]
              {
                deformer.SetRestMesh(
                  good.Tetrahedra.data(), good.Tetrahedra.size(), good.RestNodes.size(), nullptr);
              })
              .find("empty"),
    std::string::npos);
  Load(deformer, good, arrays);
  // Without links only mesh rasterization is possible.
  DeformerCase output;
  output.Output = good.Output;
  EXPECT_NE(GetError([&] { RunDeformer(deformer, output, arrays); }).find("deformation"),
    std::string::npos);

  // A node that is too far away, and a tetrahedron that is too large.
  RasterCase far = good;
  far.RestNodes[0].x = 4e6;
  EXPECT_NE(GetError([&] { LoadAndRun(far, arrays); }).find("Node 0 "), std::string::npos);
  far = good;
  far.RestNodes[0].x = -6000.0;
  EXPECT_NE(GetError([&] { LoadAndRun(far, arrays); }).find("5,000"), std::string::npos);
  far.RestNodes[0].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(GetError([&] { LoadAndRun(far, arrays); }).find("Node 0 "), std::string::npos);

  // A field instead of a mesh.
  const std::vector<float> vectors(24);
  DisplacementField field;
  field.Dimensions = { { 2, 2, 2 } };
  field.Vectors = vectors.data();
  deformer.SetDisplacementField(field);
  EXPECT_NE(GetError([&] { Rasterize(deformer, good, arrays); }).find("field"), std::string::npos);

  Load(deformer, good, arrays);
  ExpectEqualsReference(good, arrays, Rasterize(deformer, good, arrays));
}

// Tetrahedra that overlap many tiles need more memory for their lists than is estimated.
TEST(MeshRasterization, NotEnoughMemoryForLists)
{
  const RasterCase wild = MakeRasterCase({ { 0, 19, 0, 19, 0, 19 } }, 12, MakeJitter(5, 30.0));
  const UsualArrays usual(wild.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  VolumeDeformer deformer;
  Load(deformer, wild, arrays);
  Rasterize(deformer, wild, arrays);
  const std::uint64_t used = deformer.GetDeviceMemory();
  std::string error;
  // The first limits do not suffice for the estimate.
  for (std::uint64_t limit = used / 8; error.find("lists of tetrahedra") == std::string::npos;
       limit += used / 16)
  {
    ASSERT_LT(limit, used) << error;
    deformer.ReleaseMemory();
    deformer.SetMemoryLimit(limit);
    Load(deformer, wild, arrays);
    error = GetError([&] { Rasterize(deformer, wild, arrays); });
  }
  deformer.SetMemoryLimit(used + used / 8);
  EXPECT_NO_THROW(Rasterize(deformer, wild, arrays));
}

TEST(MeshRasterization, AbortThrows)
{
  const RasterCase good = MakeRasterCase(Volume, 2, Wave, { { 1, 1, 1 } });
  const UsualArrays usual(good.GetNumberOfVoxels());
  VolumeDeformer deformer;
  Load(deformer, good, usual.Get());
  std::vector<signed char> coverage(GetNumberOfPoints(good.Output));
  UsualArrays outputs(coverage.size());
  DeformRequest request;
  request.Method = Resampling::MeshRasterization;
  request.OutputExtent = good.Output;
  request.Outputs = { outputs.Shorts.data(), outputs.Floats.data(), outputs.Labels.data() };
  request.Coverage = coverage.data();
  double last = -1.0;
  request.Progress = [&last](double done)
  {
    EXPECT_GE(done, last);
    EXPECT_LE(done, 1.0);
    last = done;
    return true;
  };
  deformer.Deform(request);
  EXPECT_GE(last, 0.0);
  request.Progress = [](double) { return false; };
  EXPECT_THROW(deformer.Deform(request), Aborted);
}

// Random bits appear at the voxels that a shift by whole voxels gives.
TEST(MeshRasterization, IdentityAndWholeShiftsAreBitExact)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  for (const double shift : { 0.0, -5.0 })
  {
    const RasterCase moved = MakeRasterCase(
      { Volume, { { 1, 1, 1 } } }, glm::dvec3(Volume[0], Volume[2], Volume[4]) - 0.3,
      glm::dvec3(Volume[1], Volume[3], Volume[5]) + 2.7, 3,
      [shift](const glm::dvec3& index) { return index + glm::dvec3(shift, 2.0 * shift, 0.0); }, 0);
    const std::size_t voxels = static_cast<std::size_t>(moved.GetNumberOfVoxels());
    const AllTypes types(voxels, 0.0, true);
    const std::vector<VolumeArray>& arrays = types.Arrays;
    for (const Interpolation interpolation : { Interpolation::Linear, Interpolation::Cubic })
    {
      const Deformed deformed = LoadAndRun(moved, arrays, interpolation);
      EXPECT_EQ(deformed.Report.NumberOfCoveredVoxels, moved.GetNumberOfVoxels());
      EXPECT_FALSE(deformed.Report.Overlapping);
      for (std::size_t i = 0; i < arrays.size(); ++i)
      {
        const std::size_t tuple = GetTupleSize(arrays[i]);
        std::size_t wrong = 0;
        std::size_t voxel = 0;
        for (int z = Volume[4]; z <= Volume[5]; ++z)
        {
          for (int y = Volume[2]; y <= Volume[3]; ++y)
          {
            for (int x = Volume[0]; x <= Volume[1]; ++x, ++voxel)
            {
              const auto target =
                static_cast<std::size_t>(((z - moved.Output[4]) * GetSize(moved.Output, 1) + y +
                                           int(2 * shift) - moved.Output[2]) *
                    GetSize(moved.Output, 0) +
                  x + int(shift) - moved.Output[0]);
              wrong += deformed.Coverage[target] != 1 ||
                std::memcmp(deformed.Outputs[i].data() + target * tuple,
                  static_cast<const char*>(arrays[i].Data) + voxel * tuple, tuple) != 0;
            }
          }
        }
        EXPECT_EQ(wrong, 0U) << "type " << static_cast<int>(arrays[i].Type) << " components "
                             << arrays[i].Components << " cubic "
                             << (interpolation == Interpolation::Cubic);
      }
    }
  }
}

// An output with a finer grid: every voxel of the volume appears at its position.
TEST(MeshRasterization, UndeformedAtAnotherSpacingKeepsTheVoxels)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const RasterCase finer = MakeRasterCase(Volume, 3,
    [](const glm::dvec3& index) { return index * glm::dvec3(3, 2, 7); }, { { 3, 2, 7 } });
  UsualArrays usual(static_cast<std::size_t>(finer.GetNumberOfVoxels()));
  usual.Floats = MakeRandomBits<float>(usual.Floats.size(), 5);
  const Deformed deformed = LoadAndRun(finer, usual.Get());
  std::size_t voxel = 0;
  for (int z = Volume[4]; z <= Volume[5]; ++z)
  {
    for (int y = Volume[2]; y <= Volume[3]; ++y)
    {
      for (int x = Volume[0]; x <= Volume[1]; ++x, ++voxel)
      {
        const std::int64_t target =
          ((7 * z - finer.Output[4]) * GetSize(finer.Output, 1) + 2 * y - finer.Output[2]) *
            GetSize(finer.Output, 0) +
          3 * x - finer.Output[0];
        ASSERT_EQ(std::memcmp(&deformed.GetOutput<float>(1)[target], &usual.Floats[voxel], 4), 0)
          << "voxel " << voxel;
      }
    }
  }
}

TEST(MeshRasterization, ValuesOfAllTypesEqualReference)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const RasterCase waved = MakeRasterCase(Volume, 4, Wave, { { 1, 1, 1 } });
  const AllTypes types(static_cast<std::size_t>(waved.GetNumberOfVoxels()), 0.0, false);
  for (const Interpolation interpolation : { Interpolation::Linear, Interpolation::Cubic })
  {
    SCOPED_TRACE(interpolation == Interpolation::Cubic);
    ExpectEqualsReference(
      waved, types.Arrays, LoadAndRun(waved, types.Arrays, interpolation), interpolation);
  }
}

TEST(MeshRasterization, AffineMapsEqualReference)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  std::mt19937 random(7);
  for (int run = 0; run < 12; ++run)
  {
    SCOPED_TRACE(run);
    glm::dmat3 matrix = MakeRandomMatrix(random);
    std::array<double, 3> scale{ { 1, 1, 1 } };
    if (run == 1)
    {
      matrix = glm::dmat3(glm::rotate(glm::dmat4(1.0), 0.7853981633974483, glm::dvec3(1, 0, 0)));
    }
    if (run == 2)
    {
      matrix = glm::dmat3(0, 1, 0, 0, 0, 1, 1, 0, 0); // permuted axes: all voxels lie on faces
    }
    if (run % 3 == 0)
    {
      scale = { { 0.7, 1.9, 1.3 } };
    }
    const RasterCase affine = MakeRasterCase(
      Volume, 1 + run % 4, [&matrix](const glm::dvec3& index) { return matrix * index; }, scale);
    const UsualArrays usual(affine.GetNumberOfVoxels());
    const std::vector<VolumeArray> arrays = usual.Get();
    ExpectEqualsReference(affine, arrays, LoadAndRun(affine, arrays));
  }
}

// Nodes have large independent displacements: inverted tetrahedra, slivers, and overlaps
// everywhere.
TEST(MeshRasterization, FoldedMeshesEqualReference)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  for (unsigned int seed = 1; seed < 6; ++seed)
  {
    SCOPED_TRACE(seed);
    RasterCase folded =
      MakeRasterCase({ Volume, { { 1, 1, 1 } } }, glm::dvec3(Volume[0], Volume[2], Volume[4]) - 3.0,
        glm::dvec3(Volume[1], Volume[3], Volume[5]) + 2.0, 3, MakeJitter(seed, 6.0));
    // A tetrahedron that is flat at rest, one that uses a node twice, and a copy of another one.
    folded.Tetrahedra.push_back({ { 0, 1, 2, 3 } });
    folded.Tetrahedra.push_back({ { 5, 5, 9, 20 } });
    folded.Tetrahedra.push_back(folded.Tetrahedra[7]);
    const UsualArrays usual(folded.GetNumberOfVoxels());
    const std::vector<VolumeArray> arrays = usual.Get();
    const Deformed deformed = LoadAndRun(folded, arrays);
    EXPECT_TRUE(deformed.Report.Overlapping);
    EXPECT_GT(deformed.Report.NumberOfInvertedTetrahedra, 0);
    ExpectEqualsReference(folded, arrays, deformed);
  }
}

// A mesh that is almost flat, at an angle, and a mesh that is strongly stretched.
TEST(MeshRasterization, SliversAndStretchedMeshesEqualReference)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  for (const double thickness : { 0.02, 0.3 })
  {
    const RasterCase flat = MakeRasterCase(Volume, 2,
      [thickness](const glm::dvec3& index) {
        return glm::dvec3(
          index.x + 0.5 * index.y, index.y + 0.4, 0.5 * index.x + thickness * index.z);
      },
      { { 1, 1, 1 } });
    const UsualArrays usual(flat.GetNumberOfVoxels());
    const std::vector<VolumeArray> arrays = usual.Get();
    const Deformed deformed = LoadAndRun(flat, arrays);
    EXPECT_GT(deformed.Report.NumberOfCoveredVoxels, 0);
    ExpectEqualsReference(flat, arrays, deformed);
  }
  const RasterCase wide = MakeRasterCase({ 0, 3, 0, 3, 0, 3 }, 1,
    [](const glm::dvec3& index)
    { return index * glm::dvec3(40.0, 9.0, 13.0) + glm::dvec3(-50.5, 3.25, 0.1 * index.x); },
    { { 1, 1, 1 } });
  const UsualArrays usual(wide.GetNumberOfVoxels());
  ExpectEqualsReference(wide, usual.Get(), LoadAndRun(wide, usual.Get()));
}

TEST(MeshRasterization, MasksEqualReference)
{
  for (const double amplitude : { 0.0, 0.4, 4.0 })
  {
    SCOPED_TRACE(amplitude);
    RasterCase masked = MakeRasterCase(Volume, 3, MakeJitter(4, amplitude), { { 1, 1, 1 } });
    std::mt19937 random(5);
    masked.Blanked.resize(masked.GetNumberOfVoxels());
    for (auto& byte : masked.Blanked)
    {
      byte = random() % 20 == 0 ? 3 : 0;
    }
    masked.Active.resize(GetNumberOfCells(Volume));
    for (auto& byte : masked.Active)
    {
      byte = random() % 4 == 0 ? static_cast<unsigned char>(random() % 32) : 31;
    }
    const UsualArrays usual(masked.GetNumberOfVoxels());
    std::vector<VolumeArray> arrays = usual.Get();
    arrays[0].Background = 200.4;
    for (const Interpolation interpolation : { Interpolation::Linear, Interpolation::Cubic })
    {
      ExpectEqualsReference(
        masked, arrays, LoadAndRun(masked, arrays, interpolation), interpolation);
    }
    masked.Blanked.clear();
    const Deformed deformed = LoadAndRun(masked, arrays);
    ExpectEqualsReference(masked, arrays, deformed);
    for (std::size_t voxel = 0; voxel < deformed.Coverage.size(); ++voxel)
    {
      if (deformed.Coverage[voxel] == 0)
      {
        ASSERT_EQ(deformed.GetOutput<std::int16_t>(0)[voxel], 200);
      }
    }
  }
}

// Work-group sizes, slabs, and the requested part of the output do not change any bit.
TEST(MeshRasterization, ResultDoesNotDependOnTheDivisionOfWork)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const RasterCase folded = MakeRasterCase(Volume, 3, MakeJitter(9, 3.0), { { 2.3, 2.3, 1.7 } });
  const UsualArrays usual(folded.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  VolumeDeformer deformer;
  Load(deformer, folded, arrays);
  const Deformed whole = Rasterize(deformer, folded, arrays);
  ExpectEqualsReference(folded, arrays, whole);
  for (const std::size_t group : { 2, 7, 64 })
  {
    deformer.SetWorkGroupSize(group);
    const Deformed other = Rasterize(deformer, folded, arrays);
    EXPECT_EQ(other.Outputs, whole.Outputs) << "work-groups of " << group << " items";
    EXPECT_EQ(other.Coverage, whole.Coverage) << "work-groups of " << group << " items";
  }
  deformer.SetWorkGroupSize(0);
  // Slabs of a few planes.
  const std::uint64_t plane = 4 * GetSize(folded.Output, 0) * GetSize(folded.Output, 1);
  deformer.SetAllocationLimit(3 * plane);
  Deformed other = Rasterize(deformer, folded, arrays);
  EXPECT_EQ(other.Outputs, whole.Outputs);
  EXPECT_EQ(other.Coverage, whole.Coverage);
  EXPECT_EQ(other.Report.NumberOfInvertedTetrahedra, whole.Report.NumberOfInvertedTetrahedra);
  EXPECT_EQ(other.Report.NumberOfCoveredVoxels, whole.Report.NumberOfCoveredVoxels);
  // Unaligned outputs: each slab is copied from the device while the next one is made.
  const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(folded.Output));
  for (const int calls : { 1000, 2, 40 })
  {
    auto outputs = std::make_unique<std::vector<std::vector<unsigned char>>>();
    std::vector<signed char> coverage(voxels);
    DeformRequest request;
    request.Method = Resampling::MeshRasterization;
    request.OutputExtent = folded.Output;
    for (const VolumeArray& array : arrays)
    {
      outputs->emplace_back(voxels * GetTupleSize(array) + 1);
      request.Outputs.push_back(outputs->back().data() + 1);
    }
    request.Coverage = coverage.data();
    int left = calls;
    request.Progress = [&left](double) { return --left > 0; };
    if (calls < 1000)
    {
      // The memory of the outputs is freed as soon as the call has ended.
      EXPECT_THROW(deformer.Deform(request), Aborted);
      continue;
    }
    EXPECT_EQ(deformer.Deform(request).NumberOfCoveredVoxels, whole.Report.NumberOfCoveredVoxels);
    EXPECT_LT(left, 1000 - 2 * 32) << "Progress was called too rarely for more than two slabs";
    for (std::size_t i = 0; i < arrays.size(); ++i)
    {
      EXPECT_EQ(
        std::memcmp(request.Outputs[i], whole.Outputs[i].data(), (*outputs)[i].size() - 1), 0);
    }
    EXPECT_EQ(coverage, whole.Coverage);
  }
  deformer.SetAllocationLimit(0);
  // A part of the output.
  RasterCase part = folded;
  part.Output = { { folded.Output[0] + 11, folded.Output[1] - 5, folded.Output[2] + 3,
    folded.Output[3] - 9, folded.Output[4] + 5, folded.Output[5] - 2 } };
  other = Rasterize(deformer, part, arrays);
  std::size_t voxel = 0;
  for (int z = part.Output[4]; z <= part.Output[5]; ++z)
  {
    for (int y = part.Output[2]; y <= part.Output[3]; ++y)
    {
      for (int x = part.Output[0]; x <= part.Output[1]; ++x, ++voxel)
      {
        const std::int64_t at =
          ((z - folded.Output[4]) * GetSize(folded.Output, 1) + y - folded.Output[2]) *
            GetSize(folded.Output, 0) +
          x - folded.Output[0];
        ASSERT_EQ(other.Coverage[voxel], whole.Coverage[at]);
        ASSERT_EQ(other.GetOutput<float>(1)[voxel], whole.GetOutput<float>(1)[at]);
      }
    }
  }
}

// NaN and infinite values affect only the cells around their voxel.
TEST(MeshRasterization, NotANumberStaysWithinItsCells)
{
  const RasterCase shifted = MakeRasterCase(Volume, 2,
    [](const glm::dvec3& index) { return index + glm::dvec3(0.5, 0.0, 1.0); }, { { 1, 1, 1 } });
  UsualArrays usual(shifted.GetNumberOfVoxels());
  const std::int64_t place = (5 * GetSize(Volume, 1) + 6) * GetSize(Volume, 0) + 9;
  usual.Floats[place] = std::numeric_limits<float>::quiet_NaN();
  const Deformed deformed = LoadAndRun(shifted, usual.Get());
  std::int64_t numberOfNaN = 0;
  for (std::size_t voxel = 0; voxel < deformed.Coverage.size(); ++voxel)
  {
    numberOfNaN += std::isnan(deformed.GetOutput<float>(1)[voxel]);
  }
  EXPECT_EQ(numberOfNaN, 2); // one output voxel on either side of the NaN
}

// Small enough for an interpreter of kernels. It covers folds, masks, arrays in single and double
// precision, and work-groups of several items.
TEST(MeshRasterization, TinyEqualsReference)
{
  RasterCase tiny = MakeRasterCase({ { { 0, 6, -2, 3, 1, 5 } }, { { 1, 1, 1 } } },
    glm::dvec3(0.0, -2.0, 1.0), glm::dvec3(6.0, 3.0, 5.0), 1, MakeJitter(3, 2.0), 0);
  tiny.Active.assign(GetNumberOfCells(tiny.VoxelGrid.VertexExtent), 31);
  tiny.Active[7] = 5;
  tiny.Blanked.assign(tiny.GetNumberOfVoxels(), 0);
  tiny.Blanked[50] = 1;
  const auto shorts = MakeRandomValues<std::uint16_t>(tiny.GetNumberOfVoxels(), 3);
  const auto floats = MakeRandomValues<float>(3 * tiny.GetNumberOfVoxels(), 4);
  const std::vector<VolumeArray> arrays{ MakeArray(shorts), MakeArray(floats, 3) };
  VolumeDeformer deformer;
  Load(deformer, tiny, arrays);
  for (const std::size_t group : { 0, 4 })
  {
    deformer.SetWorkGroupSize(group);
    ExpectEqualsReference(tiny, arrays, Rasterize(deformer, tiny, arrays));
  }
}
