// SPDX-License-Identifier: BSD-3-Clause
// Inverse displacement fields, compared with a look-up on the host in extended precision: misuse,
// coverage, values, and that results do not depend on slabs and work-groups.
#include "CaughtError.h"
#include "FieldFolds.h"
#include "LookupBounds.h"
#include "OutputPlace.h"
#include "RasterCase.h"
#include "RasterReference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

using namespace deformvolume;

namespace
{

struct InverseCase
{
  deformvolume::VoxelGrid VoxelGrid;
  DisplacementField Field;
  std::vector<float> Vectors;
  Extent Output;
};

InverseCase MakeCase(const Extent& volume, const std::array<int, 3>& points, float strength,
  const std::array<double, 3>& scale = { { 1, 1, 1 } })
{
  InverseCase made;
  made.VoxelGrid = { volume, scale, {} };
  made.Vectors = MakeRandomValues<float>(3L * points[0] * points[1] * points[2], 7);
  for (float& number : made.Vectors)
  {
    number *= strength;
  }
  made.Field.Dimensions = points;
  // The field is slightly rotated, and extends approximately from the first to the last voxel.
  for (int axis = 0; axis < 3; ++axis)
  {
    const double first = scale[axis] * volume[2 * axis];
    const double length = scale[axis] * (volume[2 * axis + 1] - volume[2 * axis]);
    const double step = (points[axis] - 1) / length;
    made.Field.IndexToField[4 * axis + (axis + 1) % 3] = 0.02;
    made.Field.IndexToField[4 * axis + axis] = step;
    made.Field.IndexToField[4 * axis + 3] = 0.1 - step * first;
    made.Output[2 * axis] = static_cast<int>(std::floor(first)) - 3;
    made.Output[2 * axis + 1] = static_cast<int>(std::ceil(first + length)) + 2;
  }
  return made;
}

Deformed RunCase(VolumeDeformer& deformer, InverseCase& c, const std::vector<VolumeArray>& arrays,
  Interpolation interpolation = Interpolation::Linear)
{
  c.Field.Vectors = c.Vectors.data();
  deformer.SetVoxelGrid(c.VoxelGrid, sizeof(float), false);
  deformer.SetArrays(arrays);
  deformer.SetInverseField(c.Field);
  DeformerCase output;
  output.Output = c.Output;
  return RunDeformer(deformer, output, arrays, Resampling::MeshRasterization, interpolation);
}

/// The position of an output voxel in the volume, counted from the volume's first voxel. margin is
/// the distance to the border, in points of the field or voxels of the volume. It is negative
/// outside and for a voxel that needs an undefined vector.
std::array<long double, 3> GetRest(
  const InverseCase& c, const std::array<int, 3>& voxel, long double& margin)
{
  margin = 1e9L;
  std::array<long double, 3> vector{};
  std::array<long double, 3> place{};
  for (int axis = 0; axis < 3; ++axis)
  {
    const double* row = &c.Field.IndexToField[4 * axis];
    place[axis] = static_cast<long double>(row[3]);
    for (int column = 0; column < 3; ++column)
    {
      place[axis] += static_cast<long double>(row[column]) * voxel[column];
    }
    const long double last = c.Field.Dimensions[axis] - 1;
    if (!c.Field.Extrapolate)
    {
      margin = std::min({ margin, place[axis], last - place[axis] });
    }
    place[axis] = std::min(std::max(place[axis], 0.0L), last);
  }
  const Extent points{ { 0, c.Field.Dimensions[0] - 1, 0, c.Field.Dimensions[1] - 1, 0,
    c.Field.Dimensions[2] - 1 } };
  // Positions nearer to a point than 1/1024 may be treated as on the point.
  long double most = 0.0L;
  for (const auto& [point, weight] : reference::GetWeights(points, place, false))
  {
    if (std::isnan(c.Vectors[3 * point]))
    {
      most = std::max(most, static_cast<long double>(weight));
      continue;
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      vector[axis] += weight * static_cast<long double>(c.Vectors[3 * point + axis]);
    }
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    vector[axis] += voxel[axis];
  }
  std::array<long double, 3> rest = FindRestIndex(c.VoxelGrid.ToOutput, vector);
  for (int axis = 0; axis < 3; ++axis)
  {
    const Extent& volume = c.VoxelGrid.VertexExtent;
    rest[axis] -= volume[2 * axis];
    margin = std::min(
      { margin, rest[axis], static_cast<long double>(GetSize(volume, axis) - 1) - rest[axis] });
  }
  margin = most > 1.0L / 1024.0L ? -1.0L : most > 1e-9L ? 0.0L : margin;
  return rest;
}

void ExpectLookedUp(const InverseCase& c, const std::vector<float>& values,
  const std::vector<std::int16_t>& integers, const Deformed& deformed, bool cubic = false)
{
  std::int64_t covered = 0;
  std::int64_t voxel = 0;
  int wrong = 0;
  long double border = 1.0L / 1024.0L;
  for (int axis = 0; axis < 3; ++axis)
  {
    border = std::max(border, FindRestTolerance(c.VoxelGrid.ToOutput, axis) + 1e-5L);
  }
  std::array<int, 3> at{};
  for (at[2] = c.Output[4]; at[2] <= c.Output[5]; ++at[2])
  {
    for (at[1] = c.Output[2]; at[1] <= c.Output[3]; ++at[1])
    {
      for (at[0] = c.Output[0]; at[0] <= c.Output[1]; ++at[0], ++voxel)
      {
        long double margin = 0.0L;
        const auto rest = GetRest(c, at, margin);
        const bool isCovered = deformed.Coverage[voxel] != 0;
        covered += isCovered ? 1 : 0;
        // The error at the border is up to 1/256 output voxel on each axis, or 1/1024 point of the
        // field.
        if ((margin > 1e-5L && !isCovered) || (margin < -border && isCovered))
        {
          ++wrong;
        }
        if (!isCovered || margin < 1e-5L)
        {
          continue;
        }
        long double value = 0.0L;
        long double integer = 0.0L;
        for (const auto& [source, weight] :
          reference::GetWeights(c.VoxelGrid.VertexExtent, rest, cubic))
        {
          value += weight * static_cast<long double>(values[source]);
          integer += weight * integers[source];
        }
        integer = std::min(std::max(integer, -32768.0L), 32767.0L);
        // The bound is 1e-5 of the largest value, like for meshes. The largest values are 1,000 and
        // 2^15.
        wrong += std::fabs(deformed.GetOutput<float>(1)[voxel] - value) <= 1e-2L ? 0 : 1;
        wrong += std::fabs(deformed.GetOutput<std::int16_t>(0)[voxel] - integer) <= 0.83L ? 0 : 1;
      }
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(deformed.Report.NumberOfCoveredVoxels, covered);
  EXPECT_GT(covered, GetNumberOfPoints(c.VoxelGrid.VertexExtent) / 8);
}

// Compares a whole output with the look-up, linear and cubic, and expects the same result with
// slabs and other work-group sizes.
void ExpectLookedUpInSlabs(InverseCase& c)
{
  const auto values = MakeRandomValues<float>(GetNumberOfPoints(Volume), 1);
  const auto integers = MakeRandomValues<std::int16_t>(GetNumberOfPoints(Volume), 2);
  const std::vector<VolumeArray> arrays{ MakeArray(integers), MakeArray(values) };
  VolumeDeformer deformer;
  deformer.SetDevice("");
  const Deformed first = RunCase(deformer, c, arrays);
  ExpectLookedUp(c, values, integers, first);
  ExpectLookedUp(c, values, integers, RunCase(deformer, c, arrays, Interpolation::Cubic), true);
  // The vectors of the field need one allocation.
  deformer.SetAllocationLimit(
    std::max<std::uint64_t>(8 * GetNumberOfPoints(Volume), c.Vectors.size() * sizeof(float)));
  deformer.SetWorkGroupSize(3);
  const Deformed second = RunCase(deformer, c, arrays);
  EXPECT_EQ(first.Coverage, second.Coverage);
  EXPECT_EQ(first.Outputs, second.Outputs);
}

} // namespace

TEST(InverseField, MisuseIsAnError)
{
  InverseCase c = MakeCase(Volume, { { 5, 4, 6 } }, 0.002F);
  const auto values = MakeRandomValues<float>(GetNumberOfPoints(Volume), 1);
  const auto integers = MakeRandomValues<std::int16_t>(GetNumberOfPoints(Volume), 2);
  const std::vector<VolumeArray> arrays{ MakeArray(integers), MakeArray(values) };
  VolumeDeformer deformer;
  deformer.SetDevice("");
  deformer.SetVoxelGrid(c.VoxelGrid);
  deformer.SetArrays(arrays);
  EXPECT_NE(GetError([&] { deformer.SetInverseField({}); }).find("empty"), std::string::npos);
  c.Field.Vectors = c.Vectors.data();
  deformer.SetInverseField(c.Field);
  DeformerCase output;
  output.Output = c.Output;
  EXPECT_NE(GetError([&] { RunDeformer(deformer, output, arrays); }).find("No deformation"),
    std::string::npos);
  ExpectLookedUp(c, values, integers, RunCase(deformer, c, arrays));
}

TEST(InverseField, EqualsReference)
{
  for (const std::array<double, 3>& scale :
    { std::array<double, 3>{ { 1, 1, 1 } }, { { 0.7, 1.3, 1.9 } } })
  {
    for (const bool extrapolate : { false, true })
    {
      InverseCase c = MakeCase(Volume, { { 5, 4, 6 } }, 0.002F, scale);
      c.Field.Extrapolate = extrapolate;
      ExpectLookedUpInSlabs(c);
    }
  }
}

// Registration: the grid of the output is rotated, scaled and perhaps mirrored relative to the grid
// of the volume. The grid of the field differs from both.
TEST(InverseField, EqualsReferenceOnATurnedGrid)
{
  for (const bool isMirrored : { false, true })
  {
    InverseCase c = MakeCase(Volume, { { 9, 8, 7 } }, 0.002F);
    OutputMap& map = c.VoxelGrid.ToOutput;
    const double z = isMirrored ? -1.0 : 1.0;
    map.Matrix = { { 0.71, -0.52, 0.31 * z, 0.48, 0.83, -0.12 * z, -0.17, 0.22, 0.94 * z } };
    map.Shift = { { 3.3, -7.9, 12.6 } };
    // The output extent contains the whole volume. The field ends inside the extent on one side.
    for (int axis = 0; axis < 3; ++axis)
    {
      double low = 1e9;
      double high = -1e9;
      for (int corner = 0; corner < 8; ++corner)
      {
        const double place = PlaceInOutput(map,
          glm::dvec3(
            Volume[corner & 1], Volume[2 + (corner >> 1 & 1)], Volume[4 + (corner >> 2)]))[axis];
        low = std::min(low, place);
        high = std::max(high, place);
      }
      c.Output[2 * axis] = static_cast<int>(std::floor(low)) - 3;
      c.Output[2 * axis + 1] = static_cast<int>(std::ceil(high)) + 2;
      const double step = (c.Field.Dimensions[axis] - 1) / (high - low);
      c.Field.IndexToField[4 * axis + axis] = step;
      c.Field.IndexToField[4 * axis + 3] = (axis == 1 ? -1.3 : 0.2) - step * low;
    }
    ExpectLookedUpInSlabs(c);
  }
}

// The points of the field are voxels of the output, as registrations compute it, or lie halfway
// between neighbors on x.
TEST(InverseField, EqualsReferenceOnTheGridOfTheOutput)
{
  for (const double shift : { 0.0, 0.5 })
  {
    for (const bool hasUndefined : { false, true })
    {
      InverseCase c = MakeCase(Volume, { { 33, 20, 22 } }, 0.002F);
      c.Field.IndexToField = { { 1, 0, 0, 6 + shift, 0, 1, 0, 1, 0, 0, 1, 12 } };
      for (std::size_t point = 0; hasUndefined && point < c.Vectors.size() / 3; point += 101)
      {
        std::fill_n(&c.Vectors[3 * point], 3, std::nanf(""));
      }
      ExpectLookedUpInSlabs(c);
    }
  }
}

TEST(InverseField, VoxelsThatNeedUndefinedVectorsAreNotCovered)
{
  const float nan = std::nanf("");
  // Points between voxels; then points that lie exactly on every third voxel.
  for (const bool onVoxels : { false, true })
  {
    InverseCase c = MakeCase(Volume, { { 8, 7, 6 } }, 0.002F);
    if (onVoxels)
    {
      c.Field.IndexToField = { { 1 / 3.0, 0, 0, 1, 0, 1 / 3.0, 0, -1 / 3.0, 0, 0, 1 / 3.0, 3 } };
    }
    for (const std::size_t point : { 0U, 100U, 101U, 160U, 200U })
    {
      std::fill_n(&c.Vectors[3 * point], 3, nan);
    }
    const auto values = MakeRandomValues<float>(GetNumberOfPoints(Volume), 1);
    const auto integers = MakeRandomValues<std::int16_t>(GetNumberOfPoints(Volume), 2);
    const std::vector<VolumeArray> arrays{ MakeArray(integers), MakeArray(values) };
    VolumeDeformer deformer;
    deformer.SetDevice("");
    ExpectLookedUp(c, values, integers, RunCase(deformer, c, arrays));
    c.Vectors[3 * 100 + 1] = 0.0F;
    EXPECT_NE(
      GetError([&] { RunCase(deformer, c, arrays); }).find("point 100 "), std::string::npos);
  }
}

// The bounds are those of the covered voxels of a larger output. A cell of the field has thousands
// of voxels; the field is rotated, ends inside the output, fades there, or has undefined points.
TEST(InverseField, BoundsHoldCoveredVoxels)
{
  const auto values = MakeRandomValues<float>(GetNumberOfPoints(Volume), 1);
  VolumeDeformer deformer;
  deformer.SetDevice("");
  for (int number = 0; number < 32; ++number)
  {
    InverseCase c = MakeCase(Volume, { { 3, 3, 3 } }, 0.012F);
    for (int axis = 0; axis < 3; ++axis)
    {
      const int part = (number & 1) != 0 ? 3 : 1; // of the output that the field covers
      const double step = 2.0 / (60 / part);
      c.Output[2 * axis] = Volume[2 * axis] - 22;
      c.Output[2 * axis + 1] = Volume[2 * axis] + 38;
      c.Field.IndexToField[4 * axis + axis] = step;
      c.Field.IndexToField[4 * axis + (axis + 1) % 3] = (number & 2) != 0 ? 0.3 * step : 0.0;
      c.Field.IndexToField[4 * axis + 3] = 1.0 - step * (Volume[2 * axis] + 8 + number % 5);
      c.Field.Fading[static_cast<std::size_t>(axis)] = (number & 12) == 12 ? 1.0 : 0.0;
    }
    c.Field.Extrapolate = (number & 4) != 0;
    if ((number & 16) != 0)
    {
      std::fill_n(&c.Vectors[3 * 16], 3, std::nanf(""));
    }
    const Deformed deformed = RunCase(deformer, c, { MakeArray(values) });
    IndexBounds covered;
    std::size_t voxel = 0;
    ForEachPoint(c.Output,
      [&](int x, int y, int z)
      {
        if (deformed.Coverage[voxel++])
        {
          covered.Add(glm::dvec3(x, y, z));
        }
      });
    const IndexBounds bounds = ComputeLookupBounds(c.VoxelGrid, c.Field);
    EXPECT_GT(deformed.Report.NumberOfCoveredVoxels, 0) << number;
    EXPECT_EQ(bounds.Min, covered.Min) << number;
    EXPECT_EQ(bounds.Max, covered.Max) << number;
  }
}

// A field in other units than the volume: a cell has 10^11 voxels. Voxels at x move to
// x / 2 + (100, 200, 300).
TEST(InverseField, BoundsInLargeCells)
{
  InverseCase c = MakeCase(Volume, { { 3, 3, 3 } }, 0.0F);
  for (int point = 0; point < 27; ++point)
  {
    const int at[3] = { point % 3, point / 3 % 3, point / 9 };
    for (int axis = 0; axis < 3; ++axis)
    {
      c.Vectors[3 * point + axis] =
        -2500.0F * static_cast<float>(at[axis] - 1) + 100.0F * static_cast<float>(axis + 1);
    }
  }
  c.Field.IndexToField = { { 2e-4, 0, 0, 1, 0, 2e-4, 0, 1, 0, 0, 2e-4, 1 } };
  c.Field.Vectors = c.Vectors.data();
  const IndexBounds bounds = ComputeLookupBounds(c.VoxelGrid, c.Field);
  EXPECT_EQ(bounds.Min, glm::dvec3(-206, -396, -618));
  EXPECT_EQ(bounds.Max, glm::dvec3(-164, -368, -590));
}

// Six times the signed volume of a tetrahedron.
long double GetVolume(const std::array<std::array<long double, 3>, 4>& points)
{
  long double e[3][3];
  for (int k = 0; k < 3; ++k)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      e[k][axis] = points[k + 1][axis] - points[0][axis];
    }
  }
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
    e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
    e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

// The central tetrahedron of each cell has the four vertices whose indices have an even sum. Each
// of the other four vertices forms a tetrahedron with its three neighbors in the cell.
std::int64_t CountInvertedByDefinition(const DisplacementField& field)
{
  using Index = std::array<int, 3>;
  const auto& size = field.Dimensions;
  const auto isInverted = [&](const std::array<Index, 4>& points)
  {
    std::array<std::array<long double, 3>, 4> rest;
    std::array<std::array<long double, 3>, 4> moved;
    for (int k = 0; k < 4; ++k)
    {
      const Index& at = points[k];
      const float* vector = field.Vectors +
        3 * ((static_cast<std::int64_t>(at[2]) * size[1] + at[1]) * size[0] + at[0]);
      for (int axis = 0; axis < 3; ++axis)
      {
        rest[k][axis] = moved[k][axis] = at[axis];
        for (int column = 0; column < 3; ++column)
        {
          moved[k][axis] +=
            static_cast<long double>(field.IndexToField[4 * axis + column]) * vector[column];
        }
      }
    }
    return GetVolume(moved) / GetVolume(rest) < 0.0L;
  };
  std::int64_t inverted = 0;
  for (int cell = 0; cell < (size[0] - 1) * (size[1] - 1) * (size[2] - 1); ++cell)
  {
    const Index first{ { cell % (size[0] - 1), cell / (size[0] - 1) % (size[1] - 1),
      cell / (size[0] - 1) / (size[1] - 1) } };
    std::vector<Index> middle;
    for (int vertex = 0; vertex < 8; ++vertex)
    {
      const Index step{ { vertex & 1, vertex >> 1 & 1, vertex >> 2 } };
      const Index point{ { first[0] + step[0], first[1] + step[1], first[2] + step[2] } };
      if ((point[0] + point[1] + point[2]) % 2 == 0)
      {
        middle.push_back(point);
        continue;
      }
      std::array<Index, 4> corner{ { point, point, point, point } };
      for (int axis = 0; axis < 3; ++axis)
      {
        corner[axis + 1][axis] += step[axis] != 0 ? -1 : 1;
      }
      inverted += isInverted(corner) ? 1 : 0;
    }
    inverted += isInverted({ { middle[0], middle[1], middle[2], middle[3] } }) ? 1 : 0;
  }
  return inverted;
}

TEST(InverseField, InvertedTetrahedra)
{
  // Compressed by slightly less or slightly more than what makes the cells flat, along each axis.
  for (int axis = 0; axis < 3; ++axis)
  {
    for (const float factor : { 0.99F, 1.01F })
    {
      InverseCase c;
      c.Field.Dimensions = { { 4, 3, 5 } };
      c.Vectors.resize(3L * 4 * 3 * 5);
      for (int point = 0; point < 4 * 3 * 5; ++point)
      {
        const int at[3] = { point % 4, point / 4 % 3, point / 12 };
        c.Vectors[3 * point + axis] = -factor * at[axis];
      }
      c.Field.Vectors = c.Vectors.data();
      EXPECT_EQ(CountInvertedTetrahedra(c.Field), factor < 1.0F ? 0 : 5L * 3 * 2 * 4)
        << "axis " << axis << ", factor " << factor;
    }
  }
  // From a few inverted tetrahedra to many, on a grid that is rotated slightly, and on one that is
  // not.
  for (const float strength : { 0.0F, 0.0001F, 0.0003F, 0.0005F, 0.0007F, 0.001F, 0.005F })
  {
    for (const bool isAligned : { false, true })
    {
      InverseCase c = MakeCase(Volume, { { 9, 8, 7 } }, strength);
      if (isAligned)
      {
        c.Field.IndexToField = { { 0.4, 0, 0, 0, 0, 1.7, 0, 0, 0, 0, 0.9, 0 } };
      }
      c.Field.Vectors = c.Vectors.data();
      EXPECT_EQ(CountInvertedTetrahedra(c.Field), CountInvertedByDefinition(c.Field))
        << "strength " << strength << ", aligned " << isAligned;
      // Tetrahedra with an undefined vertex are not counted.
      for (const std::size_t point : { 0U, 100U, 101U, 163U, 300U })
      {
        std::fill_n(&c.Vectors[3 * point], 3, std::nanf(""));
      }
      EXPECT_EQ(CountInvertedTetrahedra(c.Field), CountInvertedByDefinition(c.Field))
        << "with undefined vectors, strength " << strength << ", aligned " << isAligned;
    }
  }
}

TEST(InverseField, TinyEqualsReference)
{
  const Extent volume{ { 0, 4, -2, 1, 1, 4 } };
  InverseCase c = MakeCase(volume, { { 3, 1, 2 } }, 0.0005F);
  c.Field.IndexToField = { { 0.5, 0, 0, 0, 0, 0.01, 0, 0.02, 0, 0, 0.25, -0.25 } };
  c.Field.Extrapolate = true;
  const auto values = MakeRandomValues<float>(GetNumberOfPoints(volume), 1);
  const auto integers = MakeRandomValues<std::int16_t>(GetNumberOfPoints(volume), 2);
  const std::vector<VolumeArray> arrays{ MakeArray(integers), MakeArray(values) };
  VolumeDeformer deformer;
  deformer.SetDevice("");
  ExpectLookedUp(c, values, integers, RunCase(deformer, c, arrays));
}
