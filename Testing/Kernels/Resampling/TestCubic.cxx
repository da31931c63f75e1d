// SPDX-License-Identifier: BSD-3-Clause
// Cubic interpolation in the exact resampling: which functions it reproduces, where linear
// interpolation replaces it, element types, and that results do not depend on how the work is
// divided. TestResampling compares it with the reference for each kind of deformation, mask and
// cut. TestIncremental covers incremental updates.
#include "CubicReference.h"
#include "DeviceNeeds.h"
#include "RasterCase.h"
#include "TightMesh.h"

#include <gtest/gtest.h>

#include <glm/common.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

using namespace deformvolume;

namespace
{

const Extent CubicVolume{ { -4, 11, 1, 15, 0, 13 } };

std::int64_t GetPlace(const Extent& extent, int x, int y, int z)
{
  return (static_cast<std::int64_t>(z - extent[4]) * GetSize(extent, 1) + (y - extent[2])) *
    GetSize(extent, 0) +
    (x - extent[0]);
}

DeformerCase MakeJittered(double amplitude = 0.15)
{
  return MakeCase(CubicVolume, { { 1, 1, 1 } },
    [jitter = MakeJitter(5, amplitude)](const glm::dvec3& index) mutable
    { return 1.3 * jitter(index) + glm::dvec3(0.1, 0.2, 0.3); });
}

Deformed RunCubic(const DeformerCase& made, const std::vector<VolumeArray>& arrays,
  Route route = Route::Field, std::uint64_t allocationLimit = 0)
{
  VolumeDeformer deformer;
  deformer.SetAllocationLimit(allocationLimit);
  Load(deformer, made, arrays, route);
  return RunDeformer(deformer, made, arrays, Resampling::Exact, Interpolation::Cubic);
}

Deformed RunLinear(
  const DeformerCase& made, const std::vector<VolumeArray>& arrays, Route route = Route::Field)
{
  VolumeDeformer deformer;
  Load(deformer, made, arrays, route);
  return RunDeformer(deformer, made, arrays, Resampling::ExactByCell);
}

// An affine map that takes voxels to multiples of 1/256 voxel.
const glm::dmat3 Matrix(1.25, 0.25, -0.125, 0.125, 1.5, 0.375, -0.25, 0.0625, 0.875);
const glm::dvec3 Moved(0.375, -1.5, 2.25);

glm::dvec3 Map(const glm::dvec3& index)
{
  return Matrix * index + Moved;
}

// Whether the index is so far inside the volume that all 64 voxels of the stencil exist.
bool IsInside(const glm::dvec3& index)
{
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis)
  {
    inside &=
      index[axis] > CubicVolume[2 * axis] + 1 && index[axis] < CubicVolume[2 * axis + 1] - 1;
  }
  return inside;
}

} // namespace

TEST(Cubic, ByLanesOrColumnsIsAnError)
{
  const DeformerCase made = MakeJittered();
  const UsualArrays usual(made.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  VolumeDeformer deformer;
  Load(deformer, made, arrays, Route::Field);
  for (const Resampling method : { Resampling::ExactByLanes, Resampling::ExactByColumns })
  {
    try
    {
      RunDeformer(deformer, made, arrays, method, Interpolation::Cubic);
      ADD_FAILURE();
    }
    catch (const Error& error)
    {
      EXPECT_NE(std::string(error.what()).find("linearly only"), std::string::npos);
    }
  }
  const Deformed after =
    RunDeformer(deformer, made, arrays, Resampling::ExactByCell, Interpolation::Cubic);
  EXPECT_EQ(after.Outputs, RunCubic(made, arrays).Outputs);
}

TEST(Cubic, VoxelsComeOutBitForBit)
{
  for (const glm::dvec3& shift : { glm::dvec3(0.0), glm::dvec3(3.0, -2.0, 1.0) })
  {
    DeformerCase made = MakeCase(
      CubicVolume, { { 1, 1, 1 } }, [&](const glm::dvec3& index) { return index + shift; }, 0);
    UsualArrays usual(made.GetNumberOfVoxels());
    usual.Shorts = MakeRandomBits<std::int16_t>(usual.Shorts.size(), 1);
    usual.Floats = MakeRandomBits<float>(usual.Floats.size(), 2);
    const std::vector<VolumeArray> arrays = usual.Get();
    const Deformed deformed = RunCubic(made, arrays);
    for (std::size_t i = 0; i < arrays.size(); ++i)
    {
      EXPECT_EQ(
        std::memcmp(deformed.Outputs[i].data(), arrays[i].Data, deformed.Outputs[i].size()), 0)
        << "array " << i;
    }
    EXPECT_EQ(deformed.Report.NumberOfCoveredVoxels, made.GetNumberOfVoxels());
  }
}

// Voxels of the stencil with weight zero are not read.
TEST(Cubic, NotANumberStaysWithinItsCells)
{
  const DeformerCase made = MakeCase(
    CubicVolume, { { 1, 1, 1 } },
    [](const glm::dvec3& index) { return index + glm::dvec3(0.5, 1.0, 0.0); }, 0);
  UsualArrays usual(made.GetNumberOfVoxels());
  usual.Floats[GetPlace(CubicVolume, 3, 8, 6)] = std::numeric_limits<float>::quiet_NaN();
  const Deformed deformed = RunCubic(made, usual.Get());
  std::int64_t wrong = 0;
  std::int64_t voxel = 0;
  ForEachPoint(made.Output,
    [&](int x, int y, int z)
    {
      // Two voxels on each side.
      const bool isNear = y == 9 && z == 6 && x >= 2 && x <= 5;
      wrong += std::isnan(deformed.GetOutput<float>(1)[voxel++]) != isNear;
    });
  EXPECT_EQ(wrong, 0);
}

// Catmull-Rom interpolation reproduces polynomials of second degree in each index.
TEST(Cubic, QuadraticsAreReproduced)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const auto polynomial = [](const glm::dvec3& p)
  {
    return (1.0 + 0.5 * p.x - 0.25 * p.x * p.x) * (2.0 - p.y + 0.125 * p.y * p.y) *
      (0.5 + 0.25 * p.z + 0.0625 * p.z * p.z);
  };
  for (const double mirror : { 1.0, -1.0 })
  {
    const glm::dvec3 sign(mirror, 1.0, 1.0);
    const DeformerCase made = MakeCase(
      CubicVolume, { { 1, 1, 1 } }, [&](const glm::dvec3& index) { return sign * Map(index); });
    std::vector<double> values;
    ForEachPoint(
      CubicVolume, [&](int x, int y, int z) { values.push_back(polynomial(glm::dvec3(x, y, z))); });
    const std::vector<VolumeArray> arrays{ MakeArray(values) };
    const Deformed cubic = RunCubic(made, arrays);
    const Deformed linear = RunLinear(made, arrays);
    const glm::dmat3 back = glm::inverse(Matrix);
    double largest = 0.0;
    double largestOfLinear = 0.0;
    std::int64_t compared = 0;
    std::int64_t voxel = -1;
    ForEachPoint(made.Output,
      [&](int x, int y, int z)
      {
        ++voxel;
        const glm::dvec3 rest = back * (sign * glm::dvec3(x, y, z) - Moved);
        if (!IsInside(rest))
        {
          return;
        }
        ++compared;
        EXPECT_EQ(cubic.Coverage[voxel], 1);
        const double wanted = polynomial(rest);
        largest = std::max(largest, std::abs(cubic.GetOutput<double>(0)[voxel] - wanted));
        largestOfLinear =
          std::max(largestOfLinear, std::abs(linear.GetOutput<double>(0)[voxel] - wanted));
      });
    EXPECT_GT(compared, 2000);
    EXPECT_LT(largest, 1e-9); // the values are up to several thousand
    EXPECT_GT(largestOfLinear, 1.0)
      << "largest error of linear interpolation, which must be larger";
  }
}

// The deformation mesh bends in a plane of voxels. Both resamplers then find the same rest
// coordinates, and interpolate over the same 64 voxels.
TEST(Cubic, EqualsMeshRasterization)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const Extent extent{ { 0, 16, 0, 16, 0, 16 } };
  const auto bend = [](const glm::dvec3& index)
  {
    const glm::dvec3 moved = Map(index);
    return index.x > 8.0 ? moved + (index.x - 8.0) * glm::dvec3(-0.25, 0.5, 0.125) : moved;
  };
  const DeformerCase made = MakeCase(extent, { { 1, 1, 1 } }, bend);
  RasterCase raster = MakeRasterCase(extent, 2, bend);
  raster.Output = made.Output;
  const UsualArrays usual(made.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  const Deformed exact = RunCubic(made, arrays);
  const Deformed other = LoadAndRun(raster, arrays, Interpolation::Cubic);
  const reference::Result reference = ResampleByReference(made);
  double largest = 0.0;
  std::int64_t compared = 0;
  for (std::size_t voxel = 0; voxel < exact.Coverage.size(); ++voxel)
  {
    const auto& containing = reference.Voxels[voxel];
    if (containing.empty() || !IsCubicCell(made, containing.front().Cell))
    {
      continue;
    }
    ASSERT_EQ(exact.Coverage[voxel], 1);
    ASSERT_EQ(other.Coverage[voxel], 1);
    ++compared;
    largest = std::max<double>(
      largest, std::abs(exact.GetOutput<float>(1)[voxel] - other.GetOutput<float>(1)[voxel]));
  }
  EXPECT_GT(compared, 3000);
  // Positions are exact. Rest coordinates in mesh rasterization are multiples of 2^-24 voxel, and
  // values of neighboring voxels differ by up to 2000.
  EXPECT_LT(largest, 1e-2);
}

// Around a missing voxel or cell, values equal those of linear interpolation bit by bit. All other
// values do not change.
TEST(Cubic, LinearWhereVoxelsAreMissing)
{
  const DeformerCase whole = MakeJittered();
  const UsualArrays usual(whole.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  const std::size_t voxel = GetPlace(CubicVolume, 3, 8, 6);
  const Extent cells{ { -4, 10, 1, 14, 0, 12 } };
  const std::size_t cell = GetPlace(cells, 3, 8, 6);
  struct Defect
  {
    const char* Name;
    std::function<void(DeformerCase&)> Make;
    Route Way = Route::Field;
    int Cells = 0; // the number of cells that the defect makes linear
  };
  const std::vector<Defect> defects{
    { "nothing", [](DeformerCase&) {} },
    { "blanked",
      [&](DeformerCase& made)
      {
        made.Blanked.resize(made.GetNumberOfVoxels());
        made.Blanked[voxel] = 1;
      },
      Route::Field, 64 },
    { "unlinked",
      [&](DeformerCase& made)
      {
        made.Unlinked.resize(made.GetNumberOfVoxels());
        made.Unlinked[voxel] = true;
      },
      Route::Mesh, 64 },
    { "clipped",
      [&](DeformerCase& made)
      {
        made.Distances.assign(made.GetNumberOfVoxels(), 1.0F);
        made.Distances[voxel] = -0.25F;
      },
      Route::Field, 64 },
    { "inactive",
      [&](DeformerCase& made)
      {
        made.Active.assign(GetNumberOfCells(CubicVolume), 31);
        made.Active[cell] = 29;
      },
      Route::Field, 27 },
    { "cut",
      [&](DeformerCase& made)
      {
        made.Crossed.assign(GetNumberOfCells(CubicVolume), 0);
        made.Crossed[cell] = 31;
        made.CutDistances.assign(made.GetNumberOfVoxels(), 1.0F);
        made.CutDistances[voxel] = -1.0F;
      },
      Route::Field, 27 },
  };
  std::array<Deformed, 3> wholes;
  for (const Route route : { Route::Field, Route::Mesh })
  {
    wholes[static_cast<int>(route)] = RunCubic(whole, arrays, route);
  }
  int linearCells = 0; // the cells at the border of the volume
  for (const Defect& defect : defects)
  {
    SCOPED_TRACE(defect.Name);
    DeformerCase made = whole;
    defect.Make(made);
    int linears = 0;
    for (std::int64_t i = 0; i < GetNumberOfCells(CubicVolume); ++i)
    {
      linears += !IsCubicCell(made, i);
    }
    linearCells = defect.Cells == 0 ? linears : linearCells;
    EXPECT_EQ(linears, linearCells + defect.Cells) << "cells that must be interpolated linearly";
    const reference::Result reference = ResampleByReference(made);
    const Deformed linear = RunLinear(made, arrays, defect.Way);
    const Deformed cubic = RunCubic(made, arrays, defect.Way);
    const Deformed& complete = wholes[static_cast<int>(defect.Way)];
    EXPECT_EQ(cubic.Coverage, linear.Coverage);
    EXPECT_EQ(cubic.Outputs[2], linear.Outputs[2]) << "labels";
    std::int64_t wrong = 0;
    std::int64_t different = 0; // voxels that differ from linear interpolation
    std::int64_t cubics = 0;
    for (std::size_t i = 0; i < reference.Voxels.size(); ++i)
    {
      if (reference.Voxels[i].empty())
      {
        continue;
      }
      const bool isCubic = IsCubicCell(made, reference.Voxels[i].front().Cell);
      const Deformed& wanted = isCubic ? complete : linear;
      wrong += cubic.GetOutput<float>(1)[i] != wanted.GetOutput<float>(1)[i] ||
        cubic.GetOutput<std::int16_t>(0)[i] != wanted.GetOutput<std::int16_t>(0)[i];
      different += isCubic && cubic.GetOutput<float>(1)[i] != linear.GetOutput<float>(1)[i];
      cubics += isCubic;
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(cubics, 2000);
    EXPECT_GT(different, cubics * 9 / 10);
  }
}

// With three voxels on an axis no cell has two voxels on either side of it.
TEST(Cubic, ThinVolumesAreLinear)
{
  for (const int axis : { 0, 1, 2 })
  {
    Extent extent = CubicVolume;
    extent[2 * axis + 1] = extent[2 * axis] + 1 + axis % 2;
    const DeformerCase made = MakeCase(extent, { { 1, 1, 1 } }, Map);
    const UsualArrays usual(made.GetNumberOfVoxels());
    const std::vector<VolumeArray> arrays = usual.Get();
    const Deformed cubic = RunCubic(made, arrays);
    const Deformed linear = RunLinear(made, arrays);
    EXPECT_GT(cubic.Report.NumberOfCoveredVoxels, 50);
    EXPECT_EQ(cubic.Coverage, linear.Coverage);
    EXPECT_EQ(cubic.Outputs, linear.Outputs);
  }
}

// Interpolated random values exceed the range of integers. 64-bit integers are exact if their
// differences are small, also at the ends of the range.
TEST(Cubic, TypesAndComponents)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const DeformerCase made = MakeJittered();
  const std::size_t voxels = made.GetNumberOfVoxels();
  const auto bytes = MakeRandomValues<std::uint8_t>(2 * voxels, 1);
  const auto signedBytes = MakeRandomValues<std::int8_t>(voxels, 2);
  const auto words = MakeRandomValues<std::uint32_t>(voxels, 3);
  const auto longs = MakeRandomValues<std::int64_t>(3 * voxels, 4);
  auto highest = MakeRandomValues<std::uint64_t>(voxels, 5);
  auto lowest = MakeRandomValues<std::int64_t>(2 * voxels, 6);
  for (std::uint64_t& value : highest)
  {
    value |= ~std::uint64_t{ 1023 };
  }
  for (std::int64_t& value : lowest)
  {
    value = std::numeric_limits<std::int64_t>::lowest() + (value & 1023);
  }
  const auto doubles = MakeRandomValues<double>(4 * voxels, 7);
  const auto labels = MakeRandomValues<std::int64_t>(voxels, 8);
  const std::vector<VolumeArray> arrays{ MakeArray(bytes, 2, false, 3), MakeArray(signedBytes),
    MakeArray(words), MakeArray(longs, 3), MakeArray(highest), MakeArray(lowest, 2),
    MakeArray(doubles, 4, false, -7.5), MakeArray(labels, 1, true) };
  const reference::Result reference = ResampleByReference(made);
  EXPECT_GT(
    ExpectEqualsCubicReference(made, reference, arrays, RunCubic(made, arrays, Route::Runs)), 2000);
}

// Chunks of a few layers, of a volume with masks and a cut. With a cut, memory for less than six
// planes of links is too little.
TEST(Cubic, ChunksEqualTheWhole)
{
  DeformerCase made = MakeJittered(0.5); // folded
  made.Blanked.resize(made.GetNumberOfVoxels());
  made.Blanked[GetPlace(CubicVolume, 3, 8, 6)] = 1;
  made.Active.assign(GetNumberOfCells(CubicVolume), 31);
  made.Active[200] = 7;
  const UsualArrays usual(made.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  const std::uint64_t plane =
    sizeof(VertexLink) * GetSize(CubicVolume, 0) * GetSize(CubicVolume, 1);
  for (const bool isCut : { false, true })
  {
    if (isCut)
    {
      CutAlong(made, [](const glm::dvec3& index) { return index.z + 0.25 * index.x - 7.1; });
    }
    const Deformed whole = RunCubic(made, arrays, Route::Mesh);
    EXPECT_GT(whole.Report.NumberOfInvertedTetrahedra, 0);
    for (const std::uint64_t planes : { 4, 5, 6, 8 })
    {
      if (isCut && planes < 6)
      {
        continue;
      }
      SCOPED_TRACE(planes);
      const Deformed chunked = RunCubic(made, arrays, Route::Mesh, planes * plane);
      EXPECT_EQ(chunked.Coverage, whole.Coverage);
      EXPECT_EQ(chunked.Outputs, whole.Outputs);
    }
  }
}

// The device gets only the voxels that are deformed into the requested part of the output, and one
// layer more.
TEST(Cubic, PartsEqualTheWhole)
{
  const auto move = [jitter = MakeJitter(7, 0.2)](const glm::dvec3& index) mutable
  { return jitter(index) + glm::dvec3(0.5, 0.25, 0.5); };
  DeformerCase whole = MakeCase(CubicVolume, { { 1, 1, 1 } }, move);
  whole.Active.assign(GetNumberOfCells(CubicVolume), 31);
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i)
  {
    whole.Active[random() % whole.Active.size()] = 15;
  }
  const UsualArrays usual(whole.GetNumberOfVoxels());
  const Deformed all = RunCubic(whole, usual.Get());
  // Samples with z from 5 to 7 lie in cells between voxels 4 and 8.
  const std::int64_t plane = GetSize(CubicVolume, 0) * GetSize(CubicVolume, 1);
  const std::int64_t layer = (GetSize(CubicVolume, 0) - 1) * (GetSize(CubicVolume, 1) - 1);
  const std::int64_t first = 3;
  const std::int64_t last = 9;
  DeformerCase part = whole;
  part.VoxelGrid.WholeExtent = CubicVolume;
  part.VoxelGrid.VertexExtent[4] = static_cast<int>(first);
  part.VoxelGrid.VertexExtent[5] = static_cast<int>(last);
  part.Displacements = { whole.Displacements.begin() + first * plane,
    whole.Displacements.begin() + (last + 1) * plane };
  part.Active = { whole.Active.begin() + first * layer, whole.Active.begin() + last * layer };
  part.Output[4] = 5;
  part.Output[5] = 7;
  UsualArrays values(0);
  values.Shorts = { usual.Shorts.begin() + first * plane,
    usual.Shorts.begin() + (last + 1) * plane };
  values.Floats = { usual.Floats.begin() + first * plane,
    usual.Floats.begin() + (last + 1) * plane };
  values.Labels = { usual.Labels.begin() + 2 * first * plane,
    usual.Labels.begin() + 2 * (last + 1) * plane };
  const Deformed some = RunCubic(part, values.Get());
  std::int64_t wrong = 0;
  std::int64_t voxel = 0;
  ForEachPoint(part.Output,
    [&](int x, int y, int z)
    {
      const std::int64_t at = GetPlace(whole.Output, x, y, z);
      wrong += some.Coverage[voxel] != all.Coverage[at] ||
        some.GetOutput<float>(1)[voxel] != all.GetOutput<float>(1)[at] ||
        some.GetOutput<std::int16_t>(0)[voxel] != all.GetOutput<std::int16_t>(0)[at];
      ++voxel;
    });
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(some.Report.NumberOfCoveredVoxels, 400);
}

// If the deformation mesh ends inside the volume, cells that its boundary crosses are interpolated
// linearly. So are their neighbors, although all of their vertices exist.
TEST(Cubic, TightMeshes)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const glm::dvec3 middle(8.2, 9.1, 7.4);
  const Extent volume{ { 0, 17, 0, 18, 0, 16 } };
  TightMesh mesh = MakeTightMesh(volume, 1.9, glm::dmat3(1.0), middle,
    [&](const glm::dvec3& point) { return glm::length(point - middle) < 6.5; });
  const glm::dmat3 bend(0.0, 0.0, 0.03, 0.05, 0.0, 0.0, 0.0, -0.04, 0.0);
  const glm::dvec3 shift(0.3, 0.2, 0.1);
  mesh.Move([&](const glm::dvec3& point) { return bend * point + shift; });
  VolumeDeformer deformer;
  Load(deformer, mesh);
  const TightOutput linear = DeformTight(deformer, mesh, Resampling::ExactByCell);
  const TightOutput cubic =
    DeformTight(deformer, mesh, Resampling::Exact, nullptr, Interpolation::Cubic);
  EXPECT_EQ(cubic.Coverage, linear.Coverage);
  EXPECT_EQ(cubic.Labels, linear.Labels);
  DeformerCase made; // like the other case, but without the crossed cells
  made.VoxelGrid.VertexExtent = volume;
  made.Active.assign(GetNumberOfCells(volume), 31);
  for (const std::int64_t cell :
    FindMeshBoundary(volume, volume, mesh.Points, mesh.Tetrahedra).Crossed)
  {
    made.Active[cell] = 0;
  }
  const glm::dmat3 back = glm::inverse(glm::dmat3(1.0) + bend);
  std::int64_t cubics = 0;
  std::int64_t linears = 0;
  std::int64_t beside = 0; // in cells that the boundary does not cross
  std::int64_t wrong = 0;
  std::int64_t voxel = -1;
  ForEachPoint(mesh.Output,
    [&](int x, int y, int z)
    {
      const glm::dvec3 rest = back * (glm::dvec3(x, y, z) - shift);
      const glm::dvec3 first = glm::floor(rest);
      // Positions are rounded to 1/256 voxel: a sample near a face may lie in either cell.
      const glm::dvec3 in = glm::abs(rest - first - 0.5);
      if (!cubic.Coverage[++voxel] || std::max({ in.x, in.y, in.z }) > 0.48)
      {
        return;
      }
      const Extent cells{ { 0, 16, 0, 17, 0, 15 } };
      const std::int64_t cell = GetPlace(
        cells, static_cast<int>(first.x), static_cast<int>(first.y), static_cast<int>(first.z));
      const bool isCubic = IsCubicCell(made, cell);
      wrong += isCubic == (cubic.Values[voxel] == linear.Values[voxel]);
      cubics += isCubic;
      linears += !isCubic;
      beside += !isCubic && made.Active[cell] != 0;
    });
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(cubics, 100);
  EXPECT_GT(linears, 500);
  EXPECT_GT(beside, 100);
}
