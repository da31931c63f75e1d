// SPDX-License-Identifier: BSD-3-Clause
// Carving with a boundary between vertices, checked vertex by vertex and cell by cell; and edits of
// distances, compared with the minimum of their distances.
#include "Carving.h"
#include "CuttingReference.h"
#include "Error.h"
#include "MaskEditor.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

using namespace deformvolume;

namespace
{

const Extent Volume{ { -3, 17, 2, 20, 0, 9 } };
constexpr float Far = 100.0F;

using Function = std::function<double(const glm::dvec3&)>;

CarvingTool MakeTool(const Function& function, bool withDistance)
{
  CarvingTool tool;
  tool.Bounds = GetUnlimitedBounds();
  tool.Function = [function](const glm::dvec3* points, std::size_t count, double* values)
  { std::transform(points, points + count, values, function); };
  if (withDistance)
  {
    tool.Distance = [function](const glm::dvec3* points, std::size_t count, double* values)
    {
      std::transform(points, points + count, values,
        [&](const glm::dvec3& point) { return 2.0 * std::abs(function(point)); });
    };
  }
  return tool;
}

glm::dvec3 GetPoint(std::int64_t vertex)
{
  const std::int64_t x = GetSize(Volume, 0);
  const std::int64_t y = GetSize(Volume, 1);
  return glm::dvec3(
    Volume[0] + vertex % x, Volume[2] + vertex / x % y, Volume[4] + vertex / (x * y));
}

// Returns the distances of all vertices after an edit with this set.
std::vector<float> Spread(const DistanceSet& set)
{
  MaskEditor editor(Volume, Far);
  DistanceSet copy = set;
  editor.Add({}, std::move(copy));
  return editor.GetBoundaryDistances().Get().empty()
    ? std::vector<float>(static_cast<std::size_t>(GetNumberOfPoints(Volume)), Far)
    : editor.GetBoundaryDistances().Get();
}

// Whether one of the cells of a vertex has vertices on both sides.
bool IsNearBoundary(std::int64_t vertex, const std::vector<bool>& inside)
{
  const std::int64_t size[3] = { GetSize(Volume, 0), GetSize(Volume, 1), GetSize(Volume, 2) };
  const std::int64_t index[3] = { vertex % size[0], vertex / size[0] % size[1],
    vertex / (size[0] * size[1]) };
  for (int c = 0; c < 8; ++c)
  {
    const std::int64_t first[3] = { index[0] - (c & 1), index[1] - (c >> 1 & 1),
      index[2] - (c >> 2) };
    bool isCell = true;
    for (int axis = 0; axis < 3; ++axis)
    {
      isCell = isCell && first[axis] >= 0 && first[axis] < size[axis] - 1;
    }
    int insides = 0;
    for (int v = 0; isCell && v < 8; ++v)
    {
      insides += inside[static_cast<std::size_t>(
        ((first[2] + (v >> 2)) * size[1] + first[1] + (v >> 1 & 1)) * size[0] + first[0] +
        (v & 1))];
    }
    if (isCell && insides > 0 && insides < 8)
    {
      return true;
    }
  }
  return false;
}

void Check(const Function& function, bool withDistance)
{
  const CarvingTool tool = MakeTool(function, withDistance);
  const RestPositions rest(Volume);
  const SmoothCarving carving = FindSmoothCarving(rest, tool, Far);
  const std::vector<float> distances = Spread(carving.Distances);
  std::vector<bool> inside;
  for (std::int64_t v = 0; v < GetNumberOfPoints(Volume); ++v)
  {
    inside.push_back(function(GetPoint(v)) < 0.0);
  }
  for (std::int64_t v = 0; v < GetNumberOfPoints(Volume); ++v)
  {
    const auto i = static_cast<std::size_t>(v);
    const double value = (withDistance ? 2.0 : 1.0) * std::abs(function(GetPoint(v)));
    float expected = inside[i] ? -Far : Far;
    if (IsNearBoundary(v, inside))
    {
      expected = std::min(static_cast<float>(value), Far);
      expected = inside[i] ? -std::max(expected, std::numeric_limits<float>::min()) : expected;
    }
    ASSERT_EQ(distances[i], expected) << "voxel " << v;
    ASSERT_EQ(distances[i] < 0.0F, inside[i]) << "voxel " << v;
  }
  // The tetrahedra with all vertices inside are switched off.
  const TetrahedronSet minimal = FindCarvedTetrahedra(rest, tool, CarvingRule::Minimal);
  EXPECT_EQ(carving.Tetrahedra.Bricks, minimal.Bricks);
  EXPECT_EQ(carving.Tetrahedra.Blocks, minimal.Blocks);
}

DistanceSet MakeSet(std::mt19937& random, const CellBricks& bricks)
{
  DistanceSet set;
  for (std::size_t brick = 0; brick < bricks.GetNumberOfBricks(); ++brick)
  {
    if (random() % 2)
    {
      set.Bricks.push_back(brick);
      set.Blocks.emplace_back();
      for (float& distance : set.Blocks.back())
      {
        distance = random() % 3 ? Far : static_cast<float>(random() % 100) - 50.0F;
      }
    }
  }
  return set;
}

} // namespace

TEST(SmoothCarving, DistancesAreThoseNearTheBoundary)
{
  for (const bool withDistance : { false, true })
  {
    Check([](const glm::dvec3& p) { return glm::length(p - glm::dvec3(6.3, 11.2, 4.1)) - 5.2; },
      withDistance);
    Check(
      [](const glm::dvec3& p) { return 0.3 * p.x - 0.5 * p.y + 0.8 * p.z + 1.7; }, withDistance);
    Check([](const glm::dvec3& p) { return p.y - 8.0; }, withDistance); // passes through vertices
    Check([](const glm::dvec3& p) { return std::sin(2.0 * p.x) + std::sin(3.0 * p.y * p.z); },
      withDistance);
    Check([](const glm::dvec3&) { return 1.0; }, withDistance);
    Check([](const glm::dvec3&) { return -1.0; }, withDistance);
    Check([](const glm::dvec3&) { return std::nan(""); }, withDistance);
  }
}

TEST(SmoothCarving, LinearToolsAndBoundsDoNotChangeDistances)
{
  const Function plane = [](const glm::dvec3& p) { return 0.6 * p.x + 0.8 * p.z - 4.9; };
  const RestPositions rest(Volume);
  CarvingTool tool = MakeTool(plane, false);
  const std::vector<float> expected = Spread(FindSmoothCarving(rest, tool, Far).Distances);
  tool.IsLinear = true;
  EXPECT_EQ(Spread(FindSmoothCarving(rest, tool, Far).Distances), expected);
  const CarvingTool sphere = MakeSweptSphere({ glm::dvec3(6, 12, 4) }, glm::dvec3(3.3));
  CarvingTool unlimited = sphere;
  unlimited.Bounds = GetUnlimitedBounds();
  EXPECT_EQ(Spread(FindSmoothCarving(rest, sphere, Far).Distances),
    Spread(FindSmoothCarving(rest, unlimited, Far).Distances));
}

TEST(SmoothCarving, SweptSpheresHaveDistancesToFirstOrder)
{
  const std::vector<glm::dvec3> path{ glm::dvec3(2, 8, 4), glm::dvec3(9, 11, 5) };
  const CarvingTool tool = MakeSweptSphere(path, glm::dvec3(2.5));
  std::mt19937 random(4);
  for (int i = 0; i < 1000; ++i)
  {
    const auto coordinate = [&] { return static_cast<double>(random() % 4096) / 256.0; };
    const glm::dvec3 point(coordinate(), coordinate(), coordinate());
    const glm::dvec3 along = path[1] - path[0];
    const double share =
      glm::clamp(glm::dot(point - path[0], along) / glm::dot(along, along), 0.0, 1.0);
    const double distance = glm::length(point - path[0] - share * along) - 2.5;
    double value = 0.0;
    tool.Function(&point, 1, &value);
    double found = 0.0;
    tool.Distance(&point, 1, &found);
    EXPECT_EQ(value < 0.0, distance < 0.0);
    if (std::abs(distance) < 1.0)
    {
      // (d^2 - r^2) / 2 d differs from the distance by the square of the distance divided by 2 d.
      EXPECT_NEAR(found, std::abs(distance), 1e-9 + distance * distance / (2.0 * 1.5));
    }
    EXPECT_GE(found, 0.0);
  }
}

TEST(SmoothCarving, EditsOfDistancesAreUndoneAndRedone)
{
  std::mt19937 random(7);
  MaskEditor editor(Volume, Far);
  EXPECT_FALSE(editor.HasDistanceEdits());
  EXPECT_TRUE(editor.GetBoundaryDistances().TakeChangedBricks().empty());
  DistanceSet beyond;
  beyond.Bricks.push_back(editor.GetBoundaryDistances().GetBricks().GetNumberOfBricks());
  beyond.Blocks.emplace_back();
  EXPECT_THROW(editor.Add({}, std::move(beyond)), Error);

  const auto count = static_cast<std::size_t>(GetNumberOfPoints(Volume));
  std::vector<float> base(count, Far);
  std::vector<DistanceSet> edits;
  std::vector<DistanceSet> undone;
  std::vector<float> seen; // updated in the bricks that the editor reports
  for (int i = 0; i < 60; ++i)
  {
    switch (random() % 5)
    {
      case 0:
        if (editor.Undo())
        {
          undone.push_back(edits.back());
          edits.pop_back();
        }
        break;
      case 1:
        if (editor.Redo())
        {
          edits.push_back(undone.back());
          undone.pop_back();
        }
        break;
      case 2:
        if (random() % 3 == 0)
        {
          std::generate(
            base.begin(), base.end(), [&] { return static_cast<float>(random() % 80) - 20.0F; });
          editor.SetBaseDistances(base.data());
        }
        break;
      default:
        edits.push_back(MakeSet(random, editor.GetBoundaryDistances().GetBricks()));
        undone.clear();
        editor.Add({}, DistanceSet(edits.back()));
        break;
    }
    std::vector<float> expected = base;
    for (const DistanceSet& edit : edits)
    {
      const std::vector<float> spread = Spread(edit);
      std::transform(spread.begin(), spread.end(), expected.begin(), expected.begin(),
        [](float a, float b) { return std::min(a, b); });
    }
    EXPECT_EQ(editor.HasDistanceEdits(), !edits.empty());
    if (editor.GetBoundaryDistances().Get().empty())
    {
      continue;
    }
    ASSERT_EQ(editor.GetBoundaryDistances().Get(), expected);
    seen.resize(count, -1.0F);
    for (const std::size_t brick : editor.GetBoundaryDistances().TakeChangedBricks())
    {
      const Extent box = editor.GetBoundaryDistances().GetBricks().GetCells(brick);
      for (std::int64_t z = box[4]; z <= box[5]; ++z)
      {
        for (std::int64_t y = box[2]; y <= box[3]; ++y)
        {
          for (std::int64_t x = box[0]; x <= box[1]; ++x)
          {
            const auto vertex =
              static_cast<std::size_t>((z * GetSize(Volume, 1) + y) * GetSize(Volume, 0) + x);
            seen[vertex] = editor.GetBoundaryDistances().Get()[vertex];
          }
        }
      }
    }
    ASSERT_EQ(seen, expected);
  }
  editor.Reset();
  EXPECT_EQ(editor.GetBoundaryDistances().Get(), base);
}
