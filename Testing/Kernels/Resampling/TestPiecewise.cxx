// SPDX-License-Identifier: BSD-3-Clause
// Deformations that differ from cell to cell: compares coverage and values with the reference, and
// checks that one tetrahedron writes each sample.
#include "DeformerCase.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <functional>
#include <thread>
#include <tuple>

using namespace deformvolume;

namespace
{

void Check(const DeformerCase& deformerCase, Route route = Route::Field)
{
  const UsualArrays usual(deformerCase.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  const reference::Result reference = ResampleByReference(deformerCase);
  ExpectEmbedding(reference);
  EXPECT_GT(reference.NumberOfCoveredVoxels, 0);
  ExpectEqualsReference(deformerCase, reference, arrays, LoadAndRun(deformerCase, arrays, route));
}

glm::dmat3 Rotate(double degrees, const glm::dvec3& axis)
{
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), glm::radians(degrees), axis));
}

} // namespace

TEST(Piecewise, JitteredVoxels)
{
  Check(MakeCase({ { 0, 23, 0, 23, 0, 23 } }, NoScale, MakeJitter(1, 0.17)));
  Check(MakeCase({ { -5, 10, 3, 20, -30, -17 } }, NoScale, MakeJitter(2, 0.17)), Route::Mesh);
  Check(MakeCase({ { -5, 10, 3, 20, -30, -17 } }, NoScale, MakeJitter(3, 0.17)), Route::Runs);
}

TEST(Piecewise, CoarseRandomField)
{
  // Random displacements at every fourth voxel, interpolated linearly along each axis.
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-0.7, 0.7);
  std::array<std::array<std::array<glm::dvec3, 7>, 7>, 7> nodes;
  for (auto& plane : nodes)
  {
    for (auto& row : plane)
    {
      for (glm::dvec3& node : row)
      {
        const double x = uniform(random);
        const double y = uniform(random);
        node = glm::dvec3(x, y, uniform(random));
      }
    }
  }
  Check(MakeCase({ { 0, 23, 0, 23, 0, 23 } }, NoScale,
    [&nodes](const glm::dvec3& index)
    {
      const glm::ivec3 low = glm::ivec3(index) / 4;
      const glm::dvec3 t = index / 4.0 - glm::dvec3(low);
      glm::dvec3 moved = index;
      for (int corner = 0; corner < 8; ++corner)
      {
        const glm::ivec3 c(corner & 1, corner >> 1 & 1, corner >> 2);
        const glm::dvec3 w = glm::mix(1.0 - t, t, glm::dvec3(c));
        moved += w.x * w.y * w.z * nodes[low.z + c.z][low.y + c.y][low.x + c.x];
      }
      return moved;
    }));
}

// If nothing moves along an axis, or everything moves by whole voxels, all samples lie on faces of
// cells.
TEST(Piecewise, MovedAlongSomeAxes)
{
  const glm::dmat3 identity(1.0);
  const glm::dmat3 turned(glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, -1));
  const glm::dmat3 swapped(glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0));
  int run = 0;
  for (const glm::dmat3& pose : { identity, turned, swapped })
  {
    for (int axes = 1; axes < 7; ++axes) // the axes that move, as bits
    {
      SCOPED_TRACE(axes);
      const glm::dvec3 moving(axes & 1, axes >> 1 & 1, axes >> 2 & 1);
      const auto jitter = MakeJitter(++run, 0.17);
      const auto move = [&](const glm::dvec3& index)
      {
        const glm::dvec3 still = index + glm::dvec3(3, -2, 5);
        return pose * (still + moving * (jitter(index) - index));
      };
      Check(MakeCase({ { -4, 47, 0, 9, 3, 11 } }, NoScale, move));
    }
  }
}

// Linear maps that put faces, edges and vertices of many tetrahedra exactly on samples.
TEST(Piecewise, SamplesOnManyFaces)
{
  const glm::dmat3 swapped(glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0));
  const std::vector<std::pair<const char*, glm::dmat3>> matrices{
    { "identity", glm::dmat3(1.0) },
    { "axes swapped", swapped },
    { "quarter turn", Rotate(90.0, glm::dvec3(0, 0, 1)) },
    { "half turn", Rotate(180.0, glm::dvec3(0, 1, 0)) },
    { "doubled", glm::dmat3(2.0) },
    { "tripled", glm::dmat3(3.0) },
    { "seven and a half times", glm::dmat3(7.5) },
    { "unequally stretched", glm::dmat3(7, 0, 0, 0, 1, 0, 0, 0, 0.25) },
    { "large and sheared", glm::dmat3(5, 0, 0, 1, 5, 0, 0, -1, 5) },
    { "halved", glm::dmat3(0.5) },
    { "one and a half", glm::dmat3(1.5) },
    { "shear by a quarter", glm::dmat3(1, 0, 0, 0.25, 1, 0, 0, 0.25, 1) },
    { "shear by one", glm::dmat3(1, 0, 0, 1, 1, 0, 0, 1, 1) },
    { "turned by the diagonal", glm::dmat3(1, 1, 0, -1, 1, 0, 0, 0, 1) },
    { "turned by two diagonals", glm::dmat3(1, 1, 0, -1, 1, 1, 0, -1, 1) },
  };
  for (const auto& [name, matrix] : matrices)
  {
    for (const double shift : { 0.0, 0.5, 0.25 })
    {
      SCOPED_TRACE(name);
      SCOPED_TRACE(shift);
      Check(MakeCase({ { -1, 4, 0, 5, 3, 7 } }, NoScale,
        [&, m = matrix](const glm::dvec3& index)
        { return m * index + glm::dvec3(shift, 0.0, -shift); }));
    }
  }
}

// An inner vertex lies on a sample: exactly one of its 8 or 32 tetrahedra writes the sample.
TEST(Piecewise, VerticesOnSamplesOfAJitteredMesh)
{
  auto jitter = MakeJitter(3, 0.3);
  Check(MakeCase({ { 0, 8, 0, 8, 0, 8 } }, NoScale,
    [&jitter](const glm::dvec3& index)
    {
      const glm::dvec3 moved = jitter(index);
      // Every third vertex stays on its sample. The vertices between them move along one axis only.
      const int kind = static_cast<int>(index.x + 2 * index.y + 4 * index.z) % 3;
      return kind == 0 ? 2.0 * index
                       : 2.0 * index +
          (kind == 1 ? glm::dvec3(moved.x - index.x, 0, 0) : glm::dvec3(0, 0, moved.z - index.z));
    }));
}

TEST(Piecewise, ScaledVoxelGrid)
{
  // The rest position is the index times a scale: the output has another spacing than the volume.
  for (const std::array<double, 3>& scale :
    { std::array<double, 3>{ { 2, 2, 2 } }, std::array<double, 3>{ { 0.5, 0.75, 0.25 } },
      std::array<double, 3>{ { 1.5, 1, 3.25 } }, std::array<double, 3>{ { 4.5, 6, 5 } } })
  {
    SCOPED_TRACE(scale[0]);
    const glm::dvec3 s(scale[0], scale[1], scale[2]);
    auto jitter = MakeJitter(8, 0.15);
    Check(MakeCase({ { -3, 6, 2, 9, 0, 8 } }, scale,
      [&](const glm::dvec3& index) { return s * jitter(index); }));
    Check(MakeCase(
      { { -3, 6, 2, 9, 0, 8 } }, scale, [&](const glm::dvec3& index) { return s * index; }));
  }
}

TEST(Piecewise, ParityIsThatOfTheStructuredIndex)
{
  for (int parity = 0; parity < 8; ++parity)
  {
    SCOPED_TRACE(parity);
    const Extent extent{ { -(parity & 1), 4, (parity >> 1 & 1) - 6, -1, parity >> 2, 5 } };
    Check(MakeCase(extent, NoScale, MakeJitter(parity, 0.15)));
  }
}

TEST(Piecewise, ThinVolumes)
{
  Check(MakeCase({ { 0, 1, 0, 1, 0, 1 } }, NoScale, MakeJitter(1, 0.15)));
  Check(MakeCase({ { 0, 20, 3, 4, -1, 0 } }, NoScale, MakeJitter(2, 0.15)));
  Check(MakeCase({ { 0, 1, 0, 70, 0, 1 } }, NoScale, MakeJitter(3, 0.15)));
  Check(MakeCase({ { 0, 1, -1, 0, 0, 40 } }, NoScale, MakeJitter(4, 0.15)));
  Check(MakeCase({ { 0, 130, 0, 2, 0, 2 } }, NoScale, MakeJitter(5, 0.15)));
}

// With many bricks per processor, one work-item takes two bricks, one above the other. Here are
// five layers of bricks, so that the last one has no partner. The first and last layers are
// incomplete.
TEST(Piecewise, StacksOfBricks)
{
  const int units = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  DeformerCase jittered =
    MakeCase({ { 0, 2, 1, 7 * 16 * units, -5, 65 } }, NoScale, MakeJitter(7, 0.15));
  Check(jittered, Route::Mesh);
  std::mt19937 random(8);
  for (std::int64_t voxel = 0; voxel < jittered.GetNumberOfVoxels(); ++voxel)
  {
    jittered.Blanked.push_back(random() % 500 == 0 ? 8 : 0);
  }
  Check(jittered);
}

TEST(Piecewise, OutputSmallerThanTheDeformedVolume)
{
  DeformerCase jittered = MakeCase({ { 0, 11, 0, 11, 0, 11 } }, NoScale, MakeJitter(6, 0.15));
  jittered.Output = { { 3, 7, 4, 4, 5, 30 } };
  Check(jittered);
}

// Aligned cells of three voxels that the border of the output divides.
TEST(Piecewise, OutputCutsAlignedCells)
{
  DeformerCase tripled = MakeCase(
    { { 0, 24, 0, 8, 0, 8 } }, NoScale, [](const glm::dvec3& index) { return 3.0 * index; });
  for (const int cut : { 4, 5, 6 })
  {
    SCOPED_TRACE(cut);
    tripled.Output = { { cut, 60 + cut, cut, 15 + cut, cut, 15 + cut } };
    Check(tripled);
  }
}

TEST(Piecewise, OutputBesideTheDeformedVolume)
{
  DeformerCase jittered = MakeCase({ { 0, 5, 0, 5, 0, 5 } }, NoScale, MakeJitter(6, 0.15));
  jittered.Output = { { 20, 25, 0, 3, -100, -98 } };
  const UsualArrays usual(jittered.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  ExpectEqualsReference(
    jittered, ResampleByReference(jittered), arrays, LoadAndRun(jittered, arrays));
}

// Cells of more than four voxels, in which undecided samples are decided one by one; of more than
// eight voxels, whose normals floats cannot hold; and with more samples than the lanes take. The
// shears put every face on samples.
TEST(Piecewise, LargeCells)
{
  const glm::dmat3 turned = Rotate(23.0, glm::dvec3(1, 2, 3));
  const glm::dmat3 sheared(1, 0.25, 0, 0.25, 1, 0, 0, -0.25, 1);
  for (const glm::dvec3& size :
    { glm::dvec3(4.5, 4.25, 4.75), glm::dvec3(6.5), glm::dvec3(8.0), glm::dvec3(9.25, 9.0, 8.5),
      glm::dvec3(1.0, 1.25, 10.0), glm::dvec3(40.0, 3.0, 2.0), glm::dvec3(12.0, 12.5, 12.25) })
  {
    SCOPED_TRACE(size.x);
    const glm::dmat3 stretched(size.x, 0, 0, 0, size.y, 0, 0, 0, size.z);
    for (const glm::dmat3& matrix : { stretched, turned * stretched, sheared * stretched })
    {
      auto jitter = MakeJitter(4, 0.1);
      const auto move = [&](const glm::dvec3& index) { return matrix * index; };
      const auto moveAndJitter = [&](const glm::dvec3& index) { return matrix * jitter(index); };
      const Extent extent{ { -1, 4, 0, 2, 2, 4 } };
      Check(MakeCase(extent, NoScale, move));
      DeformerCase jittered = MakeCase(extent, NoScale, moveAndJitter);
      Check(jittered, Route::Mesh);
      for (std::int64_t cell = 0; cell < GetNumberOfCells(extent); ++cell)
      {
        jittered.Active.push_back(static_cast<unsigned char>(cell % 4 == 0 ? 27 : 31));
      }
      // Only the middle of the output, whose border divides cells.
      for (int axis = 0; axis < 3; ++axis)
      {
        const int part = (jittered.Output[2 * axis + 1] - jittered.Output[2 * axis]) / 3;
        jittered.Output[2 * axis] += part;
        jittered.Output[2 * axis + 1] -= part;
      }
      Check(jittered);
    }
  }
}

TEST(Piecewise, LargeTetrahedra)
{
  // Tetrahedra with edges of up to 60 voxels.
  Check(MakeCase({ { 0, 2, 0, 1, 0, 2 } }, NoScale,
    [](const glm::dvec3& index)
    {
      return glm::dvec3(23.5 * index.x + 11.0 * index.y, 30.25 * index.y - 7.0 * index.z,
        21.0 * index.z + 9.0 * index.x);
    }));
}
