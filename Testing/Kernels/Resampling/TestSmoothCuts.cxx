// SPDX-License-Identifier: BSD-3-Clause
// Smooth cuts, which divide the tetrahedra that a sheet crosses. In comparisons with the reference
// distances are multiples of 1/16: the kernels and the reference add them without rounding.
#include "DeformerCase.h"
#include "DeviceNeeds.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

using namespace deformvolume;

namespace
{

const Extent CutExtent{ { -3, 17, 0, 9, 1, 8 } };
using Deformation = std::function<glm::dvec3(const glm::dvec3&)>;

// Results with the cut and without it.
struct Pair
{
  Deformed Cut, Whole;
};

Pair RunBoth(
  const DeformerCase& cut, const std::vector<VolumeArray>& arrays, Route route = Route::Field)
{
  DeformerCase whole = cut;
  whole.Crossed.clear();
  return { LoadAndRun(cut, arrays, route), LoadAndRun(whole, arrays, route) };
}

Route GetSomeRoute(unsigned int seed)
{
  return seed % 3 == 0 ? Route::Field : seed % 3 == 1 ? Route::Mesh : Route::Runs;
}

void ExpectSame(const Deformed& a, const Deformed& b)
{
  EXPECT_EQ(a.Coverage, b.Coverage);
  EXPECT_EQ(a.Outputs, b.Outputs);
}

} // namespace

TEST(SmoothCuts, MisuseIsAnError)
{
  VolumeDeformer deformer;
  deformer.SetDevice("");
  DeformerCase still = MakeCase(CutExtent, NoScale, [](const glm::dvec3& index) { return index; });
  CutAtRandom(still, 1, 2);
  EXPECT_THROW(deformer.SetCut(still.Crossed.data(), still.CutDistances.data()), Error);
  const UsualArrays usual(still.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  Load(deformer, still, arrays, Route::Field);
  EXPECT_THROW(deformer.SetCut(still.Crossed.data(), nullptr), Error);
  EXPECT_THROW(deformer.SetCut(nullptr, still.CutDistances.data()), Error);
  const std::vector<double> nodes{ -99, -99, -99, 99, -99, -99, -99, 99, -99, -99, -99, 99 };
  const std::vector<float> none(12, 0.0F);
  const Tetrahedron tetrahedron{ { 0, 1, 2, 3 } };
  deformer.SetRestMesh(&tetrahedron, 1, 4, nodes.data());
  deformer.SetNodeDisplacements(none.data());
  EXPECT_THROW(RunDeformer(deformer, still, arrays, Resampling::MeshRasterization), Error);
  deformer.SetCut(nullptr, nullptr);
  EXPECT_NO_THROW(RunDeformer(deformer, still, arrays, Resampling::MeshRasterization));
  MoveByField(deformer, still);
  EXPECT_NO_THROW(RunDeformer(deformer, still, arrays));
  // Memory for four planes of links.
  deformer.SetAllocationLimit(16384);
  EXPECT_THROW(Load(deformer, still, arrays, Route::Mesh), Error);
  still.Crossed.clear();
  EXPECT_NO_THROW(Load(deformer, still, arrays, Route::Mesh));
}

TEST(SmoothCuts, InvisibleAtRest)
{
  for (const double scale : { 1.0, 2.0, 0.5 })
  {
    SCOPED_TRACE(scale);
    DeformerCase cut = MakeCase(CutExtent, { { scale, scale, scale } },
      [=](const glm::dvec3& index) { return index * scale; });
    const UsualArrays usual(cut.GetNumberOfVoxels());
    const std::vector<VolumeArray> arrays = usual.Get();
    for (unsigned int seed = 0; seed < 4; ++seed)
    {
      SCOPED_TRACE(seed);
      CutAtRandom(cut, seed, 1 + seed);
      const Pair both = RunBoth(cut, arrays);
      EXPECT_EQ(both.Cut.Coverage, both.Whole.Coverage);
      EXPECT_FALSE(both.Cut.Report.Overlapping);
      EXPECT_EQ(both.Cut.Outputs[0], both.Whole.Outputs[0]);
      EXPECT_EQ(both.Cut.ByCell->Coverage, both.Whole.Coverage);
      EXPECT_EQ(both.Cut.ByCell->Outputs, both.Whole.ByCell->Outputs);
      // By lanes, cells that the cut does not divide are interpolated in single precision.
      for (std::size_t voxel = 0; voxel < both.Cut.Coverage.size(); ++voxel)
      {
        const float value = both.Cut.GetOutput<float>(1)[voxel];
        ASSERT_TRUE(value == both.Whole.GetOutput<float>(1)[voxel] ||
          value == both.Cut.ByCell->GetOutput<float>(1)[voxel]);
      }
      if (scale == 1.0)
      {
        EXPECT_EQ(both.Cut.Outputs[1], both.Whole.Outputs[1]);
      }
    }
  }
}

// A copy of a divided tetrahedron must win an overlap even if no vertex of the cells in its
// work-group is near the voxel. One side of the cut was moved across the other side and away from
// it. The copies of the other side extend beyond all of these vertices, into patches of the output
// without such vertices. There they win over inverted cells that come first. No cell is aligned,
// and no sample lies on a face, because these are other reasons to examine a patch.
TEST(SmoothCuts, CopiesBeyondTheVerticesOfTheirCellsWin)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const Extent extent{ { 0, 4, 0, 8, 0, 3 } };
  const double step = 8; // output voxels per voxel along x: the size of a patch
  DeformerCase cut = MakeCase(extent, { { step, 1, 1 } },
    [=](const glm::dvec3& index)
    {
      if (index.y < 3)
      {
        return glm::dvec3(22.25 - 1.5 * index.x, 4.625 + 1.25 * index.y, index.z + 0.3125);
      }
      return glm::dvec3(step * index.x - 0.75, index.y + 0.25, index.z + 0.375 + 0.125 * index.x) +
        (index.x > 2 ? glm::dvec3(-2 * step, 20, 0) : glm::dvec3(0.0));
    });
  cut.Output = { { 0, 39, 0, 39, 0, 7 } };
  CutAlong(
    cut, [](const glm::dvec3& index) { return index.x - 2.875; },
    [](const glm::dvec3& cell) { return cell.y >= 4; });
  cut.Active.clear();
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(cut.Crossed.size()); ++i)
  {
    const std::int64_t y = i / 4 % 8;
    cut.Active.push_back(y == 2 || y == 3 ? 0 : 31);
  }
  const reference::Result reference = ResampleByReference(cut);
  EXPECT_GT(reference.NumberOfOverlappedVoxels, 0);
  EXPECT_GT(reference.NumberOfInvertedTetrahedra, 0);
  ExpectEqualsReference(cut);
}

TEST(SmoothCuts, ChunksEqualTheWhole)
{
  std::mt19937 random(8);
  for (unsigned int seed = 0; seed < 4; ++seed)
  {
    SCOPED_TRACE(seed);
    const glm::dmat3 matrix = MakeRandomMatrix(random);
    const Deformation jitter = MakeJitter(seed, 0.4);
    const Extent extent{ { -3, 9, 0, 9, 1, 20 } };
    DeformerCase cut =
      MakeCase(extent, NoScale, [&](const glm::dvec3& index) { return matrix * jitter(index); });
    CutAtRandom(cut, seed, 1 + seed);
    const UsualArrays usual(cut.GetNumberOfVoxels());
    const std::vector<VolumeArray> arrays = usual.Get();
    const Deformed whole = LoadAndRun(cut, arrays, Route::Mesh);
    VolumeDeformer chunked;
    chunked.SetDevice("");
    chunked.SetAllocationLimit(16384);
    Load(chunked, cut, arrays, Route::Mesh);
    ExpectSame(RunDeformer(chunked, cut, arrays), whole);
  }
}

// The gap lies between the two moved planes. Everything outside the gap is covered, and nothing
// inside it.
TEST(SmoothCuts, NothingIsLostBetweenThePlanesOfAGap)
{
  const Extent extent{ { -1, 10, 0, 7, 0, 6 } };
  const std::array<double, 3> scale{ { 16, 4, 4 } };
  const glm::dvec3 factor(16, 4, 4);
  struct Plane
  {
    glm::dvec3 Normal;
    double Place;
  };
  const std::vector<Plane> planes{ { { 1, 0, 0 }, 4.3 }, { { 1, 0, 0 }, 4.0 },
    { { 1, 0.25, 0 }, 5.125 }, { { 1, -0.5, 0.25 }, 3.5 }, { { 0.25, 1, 0.5 }, 5.0625 } };
  for (const Plane& plane : planes)
  {
    SCOPED_TRACE(plane.Place);
    const auto sheet = [&](const glm::dvec3& i) { return glm::dot(plane.Normal, i) - plane.Place; };
    const glm::dvec3 apart(24, 3, 5); // more than the slope of the plane compensates
    DeformerCase cut = MakeCase(extent, scale,
      [&](const glm::dvec3& index)
      { return index * factor + (sheet(index) < 0.0 ? -apart : apart); });
    CutAlong(cut, sheet);
    const UsualArrays usual(cut.GetNumberOfVoxels());
    const Deformed deformed = LoadAndRun(cut, usual.Get());
    // Distances are floats: only samples on a plane are nearer to it than this.
    constexpr double rounding = 1e-5;
    std::size_t voxel = 0;
    std::int64_t expected = 0;
    for (int z = cut.Output[4]; z <= cut.Output[5]; ++z)
    {
      for (int y = cut.Output[2]; y <= cut.Output[3]; ++y)
      {
        for (int x = cut.Output[0]; x <= cut.Output[1]; ++x, ++voxel)
        {
          const auto isIn = [&](const glm::dvec3& at)
          {
            return at.x >= extent[0] && at.x <= extent[1] && at.y >= extent[2] &&
              at.y <= extent[3] && at.z >= extent[4] && at.z <= extent[5];
          };
          const glm::dvec3 low = (glm::dvec3(x, y, z) + apart) / factor;
          const glm::dvec3 high = (glm::dvec3(x, y, z) - apart) / factor;
          const bool covered =
            (isIn(low) && sheet(low) < -rounding) || (isIn(high) && sheet(high) >= -rounding);
          expected += covered ? 1 : 0;
          ASSERT_EQ(deformed.Coverage[voxel] != 0, covered)
            << "voxel " << x << " " << y << " " << z;
        }
      }
    }
    EXPECT_EQ(deformed.Report.NumberOfCoveredVoxels, expected);
    EXPECT_FALSE(deformed.Report.Overlapping);
    // Without a smooth cut, switching tetrahedra off removes the tissue around the plane.
    DeformerCase off = cut;
    off.Active.assign(off.Crossed.size(), 31);
    for (std::size_t i = 0; i < off.Active.size(); ++i)
    {
      off.Active[i] = off.Crossed[i] ? 0 : 31;
    }
    off.Crossed.clear();
    const Deformed lossy = LoadAndRun(off, usual.Get());
    EXPECT_LT(lossy.Report.NumberOfCoveredVoxels, 0.95 * static_cast<double>(expected));
  }
}

// A closed cut under affine maps. Coverage does not change. Values near the sheet change by
// rounding errors of the interpolation, and other values are equal bit for bit.
TEST(SmoothCuts, AffineMotionsLeaveTheCutClosed)
{
  std::mt19937 random(21);
  for (unsigned int seed = 0; seed < 8; ++seed)
  {
    SCOPED_TRACE(seed);
    const glm::dmat3 matrix = seed < 2 ? glm::dmat3(1.0) : MakeRandomMatrix(random, 0.4);
    const glm::dvec3 shift(0.4 * seed, -0.3, 0.77);
    const auto sheet = [](const glm::dvec3& i) { return i.x - 7.3 + 0.2 * i.y - 0.4 * i.z; };
    DeformerCase cut =
      MakeCase(CutExtent, NoScale, [&](const glm::dvec3& index) { return matrix * index + shift; });
    CutAlong(cut, sheet, [seed](const glm::dvec3& cell) { return seed % 2 == 0 || cell.y < 5; });
    const UsualArrays usual(cut.GetNumberOfVoxels());
    const Pair both = RunBoth(cut, usual.Get(), GetSomeRoute(seed));
    EXPECT_EQ(both.Cut.Coverage, both.Whole.Coverage);
    EXPECT_FALSE(both.Cut.Report.Overlapping);
    const glm::dmat3 inverse = glm::inverse(matrix);
    const float* with = both.Cut.GetOutput<float>(1);
    const float* without = both.Whole.GetOutput<float>(1);
    std::size_t voxel = 0;
    for (int z = cut.Output[4]; z <= cut.Output[5]; ++z)
    {
      for (int y = cut.Output[2]; y <= cut.Output[3]; ++y)
      {
        for (int x = cut.Output[0]; x <= cut.Output[1]; ++x, ++voxel)
        {
          const double distance = sheet(inverse * (glm::dvec3(x, y, z) - shift));
          // The vertices of a crossed cell are within (1, 0.2, 0.4) . (1, 1, 1) = 1.6 of the sheet.
          // Cells that share a vertex with a crossed cell are within another 1.6: they add eight
          // values of at most 1000, with weights of at most 1, in double instead of single
          // precision. The same holds for samples on the faces of the next cells.
          const bool near = std::abs(distance) < 3 * 1.6 + 0.1;
          if (near)
          {
            ASSERT_NEAR(with[voxel], without[voxel], 1000.0 * 32 * std::ldexp(1.0, -23));
          }
          else
          {
            ASSERT_EQ(with[voxel], without[voxel]);
          }
        }
      }
    }
  }
}

// Deformations that bend the volume, with cuts through all of it and cuts that end inside. There
// must be no holes and no overlaps.
TEST(SmoothCuts, SmoothMotionsLeaveTheCutClosed)
{
  const Extent extent{ { 0, 24, 0, 16, 0, 12 } };
  for (unsigned int seed = 0; seed < 6; ++seed)
  {
    SCOPED_TRACE(seed);
    const auto sheet = [](const glm::dvec3& i)
    { return i.x - 11.3 + 0.2 * i.y - 0.03 * i.z * i.z; };
    // The second derivatives are less than 1/4 per voxel: extrapolated displacements err by less.
    const double bend = 0.02 * (1 + seed % 3);
    DeformerCase cut = MakeCase(extent, NoScale,
      [&](const glm::dvec3& i) {
        return i +
          glm::dvec3(bend * i.y * i.y / 2, 2.0 * std::sin(0.25 * i.x), bend * i.x * i.y / 4);
      });
    CutAlong(cut, sheet,
      [seed](const glm::dvec3& cell) { return seed < 3 || (cell.y < 9 && cell.z > 3); });
    const UsualArrays usual(cut.GetNumberOfVoxels());
    const Pair both = RunBoth(cut, usual.Get(), GetSomeRoute(seed));
    // The kernel by cells interpolates both alike. By lanes, cells away from the sheet are
    // interpolated in single precision.
    ExpectSame(*both.Cut.ByCell, *both.Whole.ByCell);
    EXPECT_EQ(both.Cut.Coverage, both.Whole.Coverage);
    EXPECT_FALSE(both.Cut.Report.Overlapping);
    for (std::size_t voxel = 0; voxel < both.Cut.Coverage.size(); ++voxel)
    {
      ASSERT_NEAR(both.Cut.GetOutput<std::int16_t>(0)[voxel],
        both.Whole.GetOutput<std::int16_t>(0)[voxel], 1);
    }
  }
}

// A cut that ends inside the volume is opened. The gap is the only hole, and the tissue at the end
// of the cut is not torn.
TEST(SmoothCuts, NothingTearsAtTheEndOfACut)
{
  const Extent extent{ { 0, 20, 0, 20, 0, 6 } };
  const auto sheet = [](const glm::dvec3& i) { return i.x - 10.3; };
  const auto isCut = [](const glm::dvec3& cell) { return cell.y < 10; };
  // The cut opens towards y = 0, from its end.
  const Deformation open = [&](const glm::dvec3& i)
  {
    const double width = std::max(0.0, 10.0 - i.y) * 0.4;
    return i + glm::dvec3(sheet(i) < 0.0 ? -width : width, 0.0, 0.0);
  };
  DeformerCase cut = MakeCase(extent, NoScale, open);
  CutAlong(cut, sheet, isCut);
  const UsualArrays usual(cut.GetNumberOfVoxels());
  const Deformed deformed = LoadAndRun(cut, usual.Get());
  EXPECT_FALSE(deformed.Report.Overlapping);
  EXPECT_EQ(deformed.Report.NumberOfInvertedTetrahedra, 0);
  std::size_t voxel = 0;
  for (int z = cut.Output[4]; z <= cut.Output[5]; ++z)
  {
    for (int y = cut.Output[2]; y <= cut.Output[3]; ++y)
    {
      for (int x = cut.Output[0]; x <= cut.Output[1]; ++x, ++voxel)
      {
        const double width = std::max(0.0, 10.0 - y) * 0.4;
        const bool inVolume =
          y >= 0 && y <= 20 && z >= 0 && z <= 6 && x >= -width && x <= 20 + width;
        const bool inGap = x >= 10.3 - width && x < 10.3 + width;
        // Around the end of the cut vertices are joined: tissue stretches over the gap, of up to
        // two cells.
        if (!inVolume || !inGap)
        {
          ASSERT_EQ(deformed.Coverage[voxel] != 0, inVolume)
            << "voxel " << x << " " << y << " " << z;
        }
        else if (y < 8)
        {
          ASSERT_EQ(deformed.Coverage[voxel], 0) << "voxel " << x << " " << y << " " << z;
        }
      }
    }
  }
}
