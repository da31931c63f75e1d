// SPDX-License-Identifier: BSD-3-Clause
// The tetrahedra that tools carve out, compared with a slow reference.
#include "Carving.h"
#include "CuttingReference.h"
#include "Error.h"
#include "Sheet.h"
#include "SurfaceInterior.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <limits>
#include <random>
#include <vector>

using namespace deformvolume;

namespace
{

const CarvingRule Rules[] = { CarvingRule::Centroid, CarvingRule::Conservative,
  CarvingRule::Minimal };

reference::Mask Carve(const VertexPositions& positions, const CarvingTool& tool, CarvingRule rule)
{
  return reference::GetMask(positions.GetBricks(), FindCarvedTetrahedra(positions, tool, rule));
}

// The tetrahedra that a rule carves out, found one by one. isInside: takes points in quarters of a
// step.
template <typename Function>
reference::Mask CarveSlowly(
  const reference::FreePositions& positions, CarvingRule rule, Function&& isInside)
{
  reference::Mask mask(positions.GetBricks().GetNumberOfCells());
  const Extent& all = positions.GetBricks().GetVertices();
  std::size_t cell = 0;
  for (int z = all[4]; z < all[5]; ++z)
  {
    for (int y = all[2]; y < all[3]; ++y)
    {
      for (int x = all[0]; x < all[1]; ++x, ++cell)
      {
        for (int t = 0; t < 5; ++t)
        {
          SnappedPoint sum(0);
          int inside = 0;
          bool hasPositions = true;
          for (const reference::Place& place : reference::GetTetrahedron({ { x, y, z } }, t))
          {
            const std::size_t number = positions.GetNumber(place);
            hasPositions = hasPositions && positions.Has[number];
            inside += isInside(std::int64_t{ 4 } * positions.Points[number]) ? 1 : 0;
            sum += positions.Points[number];
          }
          const bool hit = rule == CarvingRule::Centroid ? isInside(sum)
            : rule == CarvingRule::Minimal               ? inside == 4
                                                         : inside > 0;
          mask[cell] |= static_cast<unsigned char>((hit && hasPositions ? 1U : 0U) << t);
        }
      }
    }
  }
  return mask;
}

Extent MakeExtent(std::mt19937& random, unsigned int most)
{
  Extent vertices;
  for (int axis = 0; axis < 3; ++axis)
  {
    vertices[2 * axis] = static_cast<int>(random() % 7) - 3;
    vertices[2 * axis + 1] = vertices[2 * axis] + 1 + static_cast<int>(random() % most);
  }
  return vertices;
}

glm::dvec3 MakePoint(std::mt19937& random, const Extent& vertices, int unit)
{
  glm::dvec3 point;
  for (int axis = 0; axis < 3; ++axis)
  {
    std::uniform_int_distribution<int> place(
      256 * (vertices[2 * axis] - 1) / unit, 256 * (vertices[2 * axis + 1] + 1) / unit);
    point[axis] = place(random) * unit / 256.0;
  }
  return point;
}

} // namespace

TEST(Carving, MisuseIsAnError)
{
  const double bad = std::nan("");
  EXPECT_THROW(MakeSweptSphere({}, glm::dvec3(1.0)), Error);
  EXPECT_THROW(MakeSweptSphere({ glm::dvec3(0.0, bad, 0.0) }, glm::dvec3(1.0)), Error);
  for (const double radius : { 0.0, -1.0, bad, std::numeric_limits<double>::infinity() })
  {
    EXPECT_THROW(MakeSweptSphere({ glm::dvec3(0.0) }, glm::dvec3(1.0, radius, 1.0)), Error);
  }
  const RestPositions positions(Extent{ { 0, 8, 0, 8, 0, 8 } });
  const Sheet open(
    { glm::dvec3(1.0), glm::dvec3(5, 1, 1), glm::dvec3(1, 5, 1) }, { { { 0, 1, 2 } } });
  EXPECT_THROW(MakeSurfaceInterior(open, positions.GetBox()), Error);
  // Points with the value NaN are outside.
  CarvingTool nothing;
  nothing.Bounds = GetUnlimitedBounds();
  nothing.Function = [bad](const glm::dvec3*, std::size_t count, double* values)
  { std::fill_n(values, count, bad); };
  for (const CarvingRule rule : Rules)
  {
    EXPECT_TRUE(FindCarvedTetrahedra(positions, nothing, rule).IsEmpty());
  }
}

// Checks the carved volume. A corner tetrahedron has 1/6 of the volume of a cell, a central one
// 1/3.
TEST(Carving, SphereHasItsVolume)
{
  const RestPositions positions(Extent{ { 3, 53, -2, 48, 0, 50 } });
  std::mt19937 random(6);
  std::uniform_real_distribution<double> move(-1.0, 1.0);
  double least[3] = { 2.0, 2.0, 2.0 };
  double most[3] = { 0.0, 0.0, 0.0 };
  for (int round = 0; round < 20; ++round)
  {
    const CarvingTool sphere = MakeSweptSphere(
      { glm::dvec3(28 + move(random), 23 + move(random), 25 + move(random)) }, glm::dvec3(20.0));
    for (int rule = 0; rule < 3; ++rule)
    {
      double volume = 0.0;
      for (const unsigned char byte : Carve(positions, sphere, Rules[rule]))
      {
        for (int t = 0; t < 5; ++t)
        {
          volume += (byte >> t & 1) * (t < 4 ? 1.0 / 6 : 1.0 / 3);
        }
      }
      const double share = volume / (4.0 / 3.0 * 3.14159265358979 * 20.0 * 20.0 * 20.0);
      least[rule] = std::min(least[rule], share);
      most[rule] = std::max(most[rule], share);
    }
  }
  std::cout << "centroid " << least[0] << " to " << most[0] << ", conservative " << least[1]
            << " to " << most[1] << ", minimal " << least[2] << " to " << most[2] << "\n";
  EXPECT_GT(least[0], 0.99);
  EXPECT_LT(most[0], 1.01);
  EXPECT_GT(least[1], most[0]);
  EXPECT_LT(most[2], least[0]);
}

TEST(Carving, SweptSpheresEqualTheReference)
{
  std::mt19937 random(7);
  int carved = 0;
  for (int round = 0; round < 3000; ++round)
  {
    const Extent vertices = MakeExtent(random, round % 20 ? 4 : 12);
    reference::FreePositions positions(vertices);
    if (round % 2)
    {
      positions.Shake(random, 200, 1);
      positions.Has[random() % positions.Has.size()] = round % 4 != 1;
    }
    std::vector<glm::dvec3> centers;
    for (int k = 0; k <= round % 3; ++k)
    {
      centers.push_back(MakePoint(random, vertices, 1));
    }
    std::uniform_real_distribution<double> size(0.3, 3.0);
    const glm::dvec3 radii(size(random), size(random), size(random));
    // Whether a point is within the radius of a path. isCertain: whether no distance is too close
    // to the radius to be decided.
    bool isCertain = true;
    const auto isInside = [&](const SnappedPoint& quarters)
    {
      const glm::dvec3 point = glm::dvec3(quarters) / 1024.0 / radii;
      double nearest = glm::distance(point, centers.front() / radii);
      for (std::size_t k = 1; k < centers.size(); ++k)
      {
        const glm::dvec3 a = centers[k - 1] / radii;
        const glm::dvec3 b = centers[k] / radii;
        // The distance is convex along a segment: a ternary search finds its minimum.
        double low = 0.0;
        double high = 1.0;
        for (int step = 0; step < 80; ++step)
        {
          const double third = (high - low) / 3.0;
          if (glm::distance(point, a + (low + third) * (b - a)) <
            glm::distance(point, a + (high - third) * (b - a)))
          {
            high -= third;
          }
          else
          {
            low += third;
          }
        }
        nearest = std::min(nearest, glm::distance(point, a + low * (b - a)));
      }
      // The rounding errors of both implementations are less than 2^-40 here.
      isCertain = isCertain && std::abs(nearest - 1.0) > 1e-9;
      return nearest < 1.0;
    };
    const CarvingRule rule = Rules[round % 3];
    const reference::Mask expected = CarveSlowly(positions, rule, isInside);
    if (isCertain)
    {
      ASSERT_EQ(Carve(positions, MakeSweptSphere(centers, radii), rule), expected)
        << "round " << round;
      carved += reference::Count(expected);
    }
  }
  EXPECT_GT(carved, 50000);
}

// Tests planes with and without the shortcut for bricks on one side of a plane.
TEST(Carving, PlanesEqualTheReference)
{
  std::mt19937 random(11);
  int carved = 0;
  for (int round = 0; round < 300; ++round)
  {
    const Extent vertices = MakeExtent(random, 30);
    reference::FreePositions positions(vertices);
    const int unit = round % 2 ? 256 : 1;
    if (round % 3 == 0)
    {
      positions.Shake(random, 256, unit);
      positions.Has[random() % positions.Has.size()] = false;
    }
    // Use integers, so that values are exact.
    std::uniform_int_distribution<int> component(-3, 3);
    const SnappedPoint normal(component(random), component(random), component(random));
    const SnappedPoint origin = Snap(MakePoint(random, vertices, unit));
    const auto isInside = [&](const SnappedPoint& quarters)
    {
      const SnappedPoint to = quarters - std::int64_t{ 4 } * origin;
      return normal.x * to.x + normal.y * to.y + normal.z * to.z < 0;
    };
    CarvingTool plane;
    plane.Bounds = GetUnlimitedBounds();
    plane.Function = [&](const glm::dvec3* points, std::size_t count, double* values)
    {
      for (std::size_t i = 0; i < count; ++i)
      {
        values[i] = glm::dot(glm::dvec3(normal), 256.0 * points[i] - glm::dvec3(origin));
      }
    };
    const CarvingRule rule = Rules[round % 3];
    const reference::Mask expected = CarveSlowly(positions, rule, isInside);
    for (const bool isLinear : { false, true })
    {
      plane.IsLinear = isLinear;
      ASSERT_EQ(Carve(positions, plane, rule), expected) << "round " << round;
    }
    carved += reference::Count(expected);
  }
  EXPECT_GT(carved, 100000);
}

// Tests surfaces of several tetrahedra, which overlap, touch, and pass through vertices and
// centroids.
TEST(Carving, ClosedSurfacesEqualTheReference)
{
  std::mt19937 random(8);
  int carved = 0;
  for (int round = 0; round < 3000; ++round)
  {
    const Extent vertices = MakeExtent(random, round % 20 ? 4 : 12);
    reference::FreePositions positions(vertices);
    const int unit = std::array<int, 3>{ { 256, 64, 1 } }[round % 3];
    if (round % 2)
    {
      positions.Shake(random, 256, unit);
    }
    std::vector<glm::dvec3> points;
    std::vector<Sheet::Triangle> triangles;
    std::vector<std::array<SnappedPoint, 4>> bodies;
    // The largest triangles are divided.
    const double scale = round % 10 == 9 ? 1024.0 : 1.0;
    for (std::int64_t body = 0; body <= round % 3; ++body)
    {
      bodies.emplace_back();
      for (int k = 0; k < 4; ++k)
      {
        points.push_back(scale * MakePoint(random, vertices, unit));
        bodies.back()[static_cast<std::size_t>(k)] = Snap(points.back());
      }
      for (int k = 0; k < 4; ++k)
      {
        triangles.push_back(
          { { 4 * body + (k + 1) % 4, 4 * body + (k + 2) % 4, 4 * body + (k + 3) % 4 } });
        std::shuffle(triangles.back().begin(), triangles.back().end(), random);
      }
    }
    // The parts of a divided face are at most half a step away from it.
    bool isCertain = true;
    const auto isInside = [&](const SnappedPoint& point)
    {
      int count = 0;
      for (const std::array<SnappedPoint, 4>& body : bodies)
      {
        count += reference::Holds(body, point) ? 1 : 0;
        for (int k = 0; scale > 1.0 && k < 4; ++k)
        {
          const glm::dvec3 a(body[(k + 1) % 4]);
          const glm::dvec3 normal =
            glm::cross(glm::dvec3(body[(k + 2) % 4]) - a, glm::dvec3(body[(k + 3) % 4]) - a);
          const double length = glm::length(normal);
          isCertain = isCertain && length > 0.0 &&
            std::abs(glm::dot(normal, 0.25 * glm::dvec3(point) - a)) > 4.0 * length;
        }
      }
      return count % 2 != 0;
    };
    const CarvingRule rule = Rules[round / 3 % 3];
    const reference::Mask expected = CarveSlowly(positions, rule, isInside);
    const Sheet surface(points, triangles);
    if (isCertain)
    {
      ASSERT_EQ(Carve(positions, MakeSurfaceInterior(surface, positions.GetBox()), rule), expected)
        << "round " << round;
      carved += reference::Count(expected);
    }
  }
  EXPECT_GT(carved, 20000);
}

TEST(Carving, LabelsEqualTheReference)
{
  std::mt19937 random(9);
  for (int round = 0; round < 300; ++round)
  {
    const Extent vertices = MakeExtent(random, 12);
    const reference::FreePositions positions(vertices);
    std::vector<double> values(positions.Points.size());
    std::generate(values.begin(), values.end(), [&] { return random() % 3 ? -1.0 : 1.0; });
    CarvingTool tool;
    tool.Bounds = GetUnlimitedBounds();
    tool.IsOfVertices = true;
    tool.Function = [&](const glm::dvec3* points, std::size_t count, double* found)
    {
      std::transform(points, points + count, found,
        [&](const glm::dvec3& point)
        {
          const glm::ivec3 voxel(point);
          return values[positions.GetNumber({ { voxel.x, voxel.y, voxel.z } })];
        });
    };
    for (const CarvingRule rule : Rules)
    {
      const reference::Mask carved = Carve(RestPositions(vertices), tool, rule);
      std::size_t cell = 0;
      for (int z = vertices[4]; z < vertices[5]; ++z)
      {
        for (int y = vertices[2]; y < vertices[3]; ++y)
        {
          for (int x = vertices[0]; x < vertices[1]; ++x, ++cell)
          {
            for (int t = 0; t < 5; ++t)
            {
              int inside = 0;
              for (const reference::Place& place : reference::GetTetrahedron({ { x, y, z } }, t))
              {
                inside += values[positions.GetNumber(place)] < 0.0 ? 1 : 0;
              }
              const int needed = rule == CarvingRule::Conservative ? 1
                : rule == CarvingRule::Centroid                    ? 3
                                                                   : 4;
              ASSERT_EQ(carved[cell] >> t & 1, inside >= needed ? 1 : 0);
            }
          }
        }
      }
    }
  }
}
