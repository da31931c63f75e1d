// SPDX-License-Identifier: BSD-3-Clause
// Compares the bounds of fields in which each voxel is a point with those of all voxels.
#include "FieldChecker.h"
#include "Lanes.h"

#include <gtest/gtest.h>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

using namespace deformvolume;

namespace
{

// A field, and a volume that its grid contains.
struct Case
{
  VoxelGrid Grid;
  DisplacementField Field;
  std::vector<float> Vectors;

  explicit Case(std::mt19937& random)
  {
    const auto draw = [&](int least, int most)
    { return std::uniform_int_distribution<int>(least, most)(random); };
    for (int axis = 0; axis < 3; ++axis)
    {
      const int voxels = draw(1, 14);
      const int before = draw(0, 3);
      const int first = draw(-20, 20);
      this->Grid.VertexExtent[2 * axis] = first;
      this->Grid.VertexExtent[2 * axis + 1] = first + voxels - 1;
      this->Field.Dimensions[axis] = before + voxels + draw(0, 3);
      this->Field.IndexToField[4 * axis + 3] = before - first;
    }
    std::normal_distribution<double> normal(0.0, 1.0);
    const int kind = draw(0, 2); // the identity, other diagonal matrices, any matrices
    for (int i = 0; i < 9; ++i)
    {
      if (kind == 2 || (kind == 1 && i % 4 == 0))
      {
        this->Field.ToDisplacement[i] = normal(random);
        this->Grid.ToOutput.Matrix[i] += 0.2 * normal(random);
      }
    }
    this->Grid.ToOutput.Shift = { { normal(random), 5.0 * normal(random), 0.0 } };
    this->Vectors.resize(3 * static_cast<std::size_t>(GetNumberOfPoints(this->Field)));
    std::generate(this->Vectors.begin(), this->Vectors.end(),
      [&] { return static_cast<float>(4.0 * normal(random)); });
    this->Field.Vectors = this->Vectors.data();
  }

  IndexBounds FindBounds() const
  {
    const OutputTransform transform = GetOutputTransform(this->Grid);
    const Extent& e = this->Grid.VertexExtent;
    const auto& size = this->Field.Dimensions;
    const auto& map = this->Field.IndexToField;
    IndexBounds bounds;
    for (int z = e[4]; z <= e[5]; ++z)
    {
      for (int y = e[2]; y <= e[3]; ++y)
      {
        for (int x = e[0]; x <= e[1]; ++x)
        {
          const int plane = z + static_cast<int>(map[11]);
          const int row = y + static_cast<int>(map[7]);
          const std::int64_t point =
            (std::int64_t{ plane } * size[1] + row) * size[0] + x + static_cast<int>(map[3]);
          bounds.Add(transform.ToOutput(glm::dvec3(x, y, z)) + GetVector(this->Field, point));
        }
      }
    }
    return bounds;
  }
};

bool IsEqual(const FieldCheckResult& a, const FieldCheckResult& b)
{
  return a.IsUsable == b.IsUsable && a.Bounds.Min == b.Bounds.Min && a.Bounds.Max == b.Bounds.Max;
}

} // namespace

TEST(FieldChecker, BoundsAreThoseOfAllVoxels)
{
  std::mt19937 random(5);
  const bool isWide = HasWideLanes();
  for (int i = 0; i < 600; ++i)
  {
    SCOPED_TRACE(i);
    Case one(random);
    ASSERT_TRUE(AreVoxelsPoints(one.Grid, one.Field));
    FieldChecker scan;
    const FieldCheckResult state = scan.Check(one.Grid, one.Field);
    const IndexBounds wanted = one.FindBounds();
    EXPECT_TRUE(state.IsUsable);
    EXPECT_TRUE(glm::all(glm::lessThan(glm::abs(state.Bounds.Min - wanted.Min), glm::dvec3(1e-9))));
    EXPECT_TRUE(glm::all(glm::lessThan(glm::abs(state.Bounds.Max - wanted.Max), glm::dvec3(1e-9))));
    UseWideLanes(false);
    EXPECT_TRUE(IsEqual(FieldChecker().Check(one.Grid, one.Field), state)) << "without AVX2";
    UseWideLanes(isWide);

    // A few vectors change.
    PointRanges changes;
    for (int change = 0; change < 3; ++change)
    {
      const std::size_t point = random() % (one.Vectors.size() / 3);
      one.Vectors[3 * point + random() % 3] *= -2.0F;
      changes.push_back({ { point, point + 1 } });
    }
    EXPECT_TRUE(IsEqual(
      scan.Check(one.Grid, one.Field, &changes), FieldChecker().Check(one.Grid, one.Field)));
  }
}

TEST(FieldChecker, UnusableVectorsAreFound)
{
  std::mt19937 random(6);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (int i = 0; i < 300; ++i)
  {
    SCOPED_TRACE(i);
    Case one(random);
    FieldChecker scan;
    const FieldCheckResult before = scan.Check(one.Grid, one.Field);
    const std::size_t value = random() % one.Vectors.size();
    const float was = one.Vectors[value];
    const PointRanges change{ { { value / 3, value / 3 + 1 } } };
    for (const float bad : { std::nanf(""), infinity, -infinity, 3e38F })
    {
      one.Vectors[value] = bad;
      EXPECT_FALSE(scan.Check(one.Grid, one.Field, &change).IsUsable) << bad;
      EXPECT_FALSE(FieldChecker().Check(one.Grid, one.Field).IsUsable) << bad;
    }
    one.Vectors[value] = was;
    EXPECT_TRUE(IsEqual(scan.Check(one.Grid, one.Field, &change), before));
  }
  // The largest usable displacement.
  Case one(random);
  one.Field.ToDisplacement = DisplacementField().ToDisplacement;
  one.Vectors.back() = static_cast<float>(LargestDisplacement);
  EXPECT_TRUE(FieldChecker().Check(one.Grid, one.Field).IsUsable);
  one.Vectors.back() = std::nextafter(one.Vectors.back(), infinity);
  EXPECT_FALSE(FieldChecker().Check(one.Grid, one.Field).IsUsable);
}
