// SPDX-License-Identifier: BSD-3-Clause
// The tetrahedra of the sampling mesh that a sheet switches off: exact numbers, comparisons with a
// slow reference, and the separation of volumes by complete sheets.
#include "CutMask.h"
#include "CuttingReference.h"
#include "Error.h"
#include "Sheet.h"
#include "TimeAllowance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <random>

using namespace deformvolume;

namespace
{

const Extent EightCells{ { 0, 8, 0, 8, 0, 8 } };

// A sheet with a random triangulation of a plane, wider than a volume of 8 cells on each axis. Its
// points are those of a grid, randomly moved inside it. The triangles have random orientations.
template <typename Plane>
Sheet MakePlane(std::mt19937& random, int count, double low, double high, Plane&& plane)
{
  std::vector<glm::dvec3> points;
  const double step = std::floor((high - low) / count);
  std::uniform_int_distribution<int> move(
    static_cast<int>(-100 * step), static_cast<int>(100 * step));
  for (int v = 0; v <= count; ++v)
  {
    for (int u = 0; u <= count; ++u)
    {
      const double a = u == 0 ? low : u == count ? high : low + u * step + move(random) / 256.0;
      const double b = v == 0 ? low : v == count ? high : low + v * step + move(random) / 256.0;
      points.push_back(plane(a, b));
    }
  }
  std::vector<Sheet::Triangle> triangles;
  const auto add = [&](std::int64_t a, std::int64_t b, std::int64_t c)
  {
    triangles.push_back({ { a, b, c } });
    std::shuffle(triangles.back().begin(), triangles.back().end(), random);
  };
  for (int v = 0; v < count; ++v)
  {
    for (int u = 0; u < count; ++u)
    {
      const std::int64_t p = v * (count + 1) + u;
      const std::int64_t q = p + count + 1;
      if (random() % 2)
      {
        add(p, p + 1, q + 1);
        add(p, q + 1, q);
      }
      else
      {
        add(p, p + 1, q);
        add(p + 1, q + 1, q);
      }
    }
  }
  std::shuffle(triangles.begin(), triangles.end(), random);
  return Sheet(points, triangles);
}

// Checks that no part has tetrahedra of both lists.
void ExpectSeparate(const std::vector<int>& pieces, const std::vector<std::size_t>& some,
  const std::vector<std::size_t>& others)
{
  std::vector<int> both[2];
  const std::vector<std::size_t>* const lists[2] = { &some, &others };
  for (int k = 0; k < 2; ++k)
  {
    for (const std::size_t tetrahedron : *lists[k])
    {
      if (pieces[tetrahedron] >= 0)
      {
        both[k].push_back(pieces[tetrahedron]);
      }
    }
    EXPECT_FALSE(both[k].empty());
    std::sort(both[k].begin(), both[k].end());
  }
  std::vector<int> common;
  std::set_intersection(
    both[0].begin(), both[0].end(), both[1].begin(), both[1].end(), std::back_inserter(common));
  EXPECT_TRUE(common.empty());
}

} // namespace

TEST(Cutting, MisuseIsAnError)
{
  const std::vector<glm::dvec3> points{ glm::dvec3(0.0), glm::dvec3(1.0, 0.0, 0.0),
    glm::dvec3(0.0, 1.0, 0.0), glm::dvec3(std::nan(""), 0.0, 0.0),
    glm::dvec3(0.0, std::numeric_limits<double>::infinity(), 0.0), glm::dvec3(0.0, 0.0, 3e9) };
  EXPECT_NO_THROW(Sheet(points, { { { 0, 1, 2 } } }));
  EXPECT_THROW(Sheet(points, { { { 0, 1, 6 } } }), Error);
  EXPECT_THROW(Sheet(points, { { { 0, -1, 2 } } }), Error);
  for (const std::int64_t bad : { 3, 4, 5 })
  {
    EXPECT_THROW(Sheet(points, { { { 0, 1, bad } } }), Error) << "point " << bad;
  }
  // Points without triangles are ignored. An empty sheet, triangles without area and triangles
  // outside the volume cut nothing.
  const RestPositions positions(EightCells);
  EXPECT_TRUE(FindCrossedTetrahedra(positions, Sheet()).IsEmpty());
  EXPECT_TRUE(FindCrossedTetrahedra(
    positions, Sheet({ glm::dvec3(1.5), glm::dvec3(3.5), glm::dvec3(2.5) }, { { { 0, 1, 2 } } }))
                .IsEmpty());
  EXPECT_TRUE(FindCrossedTetrahedra(positions,
    Sheet(
      { glm::dvec3(9.5, 1, 1), glm::dvec3(9.5, 7, 1), glm::dvec3(9.5, 1, 7) }, { { { 0, 1, 2 } } }))
                .IsEmpty());
  // A cell is too long for integers of 64 bits.
  reference::FreePositions wide(EightCells);
  wide.Points.back().x += 3000 * 256;
  const Sheet sheet({ glm::dvec3(7.5, -1, -1), glm::dvec3(7.5, 20, -1), glm::dvec3(7.5, -1, 20) },
    { { { 0, 1, 2 } } });
  EXPECT_THROW(FindCrossedTetrahedra(wide, sheet), Error);
}

TEST(Cutting, PlanesSwitchOffWhatTheyCrossAndSeparate)
{
  std::mt19937 random(1);
  const RestPositions positions(EightCells);
  struct Case
  {
    int Expected;
    std::function<glm::dvec3(double, double)> Plane;
  };
  const Case cases[] = {
    { 320, [](double u, double v) { return glm::dvec3(4.5, u, v); } },
    { 320, [](double u, double v) { return glm::dvec3(4.0, u, v); } },
    { 320, [](double u, double v) { return glm::dvec3(u, 3.0, v); } },
    { 320, [](double u, double v) { return glm::dvec3(u, v, 7.0); } },
    { 480, [](double u, double v) { return glm::dvec3(u, 8.0 - u, v); } },
  };
  for (const Case& plane : cases)
  {
    for (int round = 0; round < 60; ++round)
    {
      // The last sheets have triangles that are far too long to be handled undivided.
      const double far = round < 50 ? 4.0 : round < 55 ? 3000.0 : 1e6;
      const Sheet sheet = MakePlane(random, round % 7 + 1, -far, 8.0 + far, plane.Plane);
      const reference::Mask off = Cut(positions, sheet);
      ASSERT_EQ(reference::Count(off), plane.Expected) << "round " << round;
      int pieces = 0;
      reference::FindPieces(EightCells, off, pieces);
      ASSERT_EQ(pieces, 2) << "round " << round;
    }
  }
}

TEST(Cutting, EqualsTheReference)
{
  std::mt19937 random(2);
  int crossed = 0;
  for (int round = 0; round < 10000; ++round)
  {
    // With coarse units, vertices, edges and planes coincide.
    const int unit = std::array<int, 4>{ { 256, 128, 64, 1 } }[round % 4];
    std::uniform_int_distribution<int> first(-3, 3);
    Extent vertices;
    for (int axis = 0; axis < 3; ++axis)
    {
      vertices[2 * axis] = first(random);
      vertices[2 * axis + 1] =
        vertices[2 * axis] + 1 + static_cast<int>(random() % (round % 50 ? 3 : 10));
    }
    reference::FreePositions positions(vertices);
    if (round % 3)
    {
      positions.Shake(
        random, round % 5 ? 128 : 512, unit); // some tetrahedra become inverted or flat
    }
    for (int k = 0; round % 7 == 0 && k < 4; ++k)
    {
      const std::size_t vertex = random() % positions.Has.size();
      positions.Has[vertex] = false;
      // If this position were used, it would cause an overflow.
      positions.Points[vertex] = SnappedPoint(std::int64_t{ 1 } << 40);
    }
    std::vector<glm::dvec3> points;
    std::vector<Sheet::Triangle> triangles;
    const int count = 1 + static_cast<int>(random() % 4);
    for (std::int64_t i = 0; i < count; ++i)
    {
      for (int k = 0; k < 3; ++k)
      {
        glm::dvec3 point;
        for (int axis = 0; axis < 3; ++axis)
        {
          std::uniform_int_distribution<int> place(
            256 * (vertices[2 * axis] - 1) / unit, 256 * (vertices[2 * axis + 1] + 1) / unit);
          point[axis] = place(random) * unit / 256.0;
        }
        points.push_back(point);
      }
      triangles.push_back({ { 3 * i, 3 * i + 1, 3 * i + 2 } });
    }
    const Sheet sheet(points, triangles);
    const reference::Mask expected = reference::Cut(positions, sheet.GetTriangles());
    ASSERT_EQ(Cut(positions, sheet), expected) << "round " << round;
    crossed += reference::Count(expected);
  }
  EXPECT_GT(crossed, 100000);
}

// Tests sheets across the whole volume that go up and down, also through nodes and along edges.
TEST(Cutting, SheetsAcrossTheVolumeSeparate)
{
  std::mt19937 random(3);
  for (int round = 0; round < GetNumberOfCases(400); ++round)
  {
    const Extent vertices{ { -1, 5, 2, 8, 0, 9 } };
    reference::FreePositions positions(vertices);
    if (round % 2)
    {
      positions.Shake(random, 80, round % 4 == 1 ? 1 : 40);
    }
    const int unit = std::array<int, 3>{ { 256, 64, 1 } }[round % 3];
    std::uniform_int_distribution<int> height(256 * 3 / unit, 256 * 6 / unit);
    const Sheet sheet = MakePlane(random, 1 + round % 9, -4.0, 12.0,
      [&](double u, double v) { return glm::dvec3(u, v, height(random) * unit / 256.0); });
    int count = 0;
    const std::vector<int> pieces = reference::FindPieces(vertices, Cut(positions, sheet), count);
    const std::size_t layer = 5 * 6 * 6;
    std::vector<std::size_t> bottom;
    std::vector<std::size_t> top;
    for (std::size_t i = 0; i < layer; ++i)
    {
      bottom.push_back(i);
      top.push_back(pieces.size() - 1 - i);
    }
    ExpectSeparate(pieces, bottom, top);
    ASSERT_FALSE(HasFailure()) << "round " << round;
  }
}

TEST(Cutting, ClosedSheetsSeparate)
{
  std::mt19937 random(4);
  const Extent vertices{ { 0, 12, 0, 12, 0, 12 } };
  for (int round = 0; round < GetNumberOfCases(200); ++round)
  {
    reference::FreePositions positions(vertices);
    if (round % 2)
    {
      positions.Shake(random, 80, round % 4 == 1 ? 1 : 40);
    }
    // An octahedron around the center. Some of its faces are dented.
    std::uniform_int_distribution<int> reach(round % 3 ? 3 * 256 : 3, round % 3 ? 5 * 256 : 5);
    const double unit = round % 3 ? 256.0 : 1.0;
    std::vector<glm::dvec3> points;
    for (int k = 0; k < 6; ++k)
    {
      glm::dvec3 point(6.0);
      point[k / 2] += (k % 2 ? 1 : -1) * reach(random) / unit;
      points.push_back(point);
    }
    std::vector<Sheet::Triangle> triangles;
    for (int face = 0; face < 8; ++face)
    {
      triangles.push_back({ { face & 1, 2 + (face >> 1 & 1), 4 + (face >> 2 & 1) } });
      std::shuffle(triangles.back().begin(), triangles.back().end(), random);
    }
    const Sheet sheet(points, triangles);
    EXPECT_TRUE(sheet.IsClosed());
    int count = 0;
    const std::vector<int> pieces = reference::FindPieces(vertices, Cut(positions, sheet), count);
    std::vector<std::size_t> inside;
    std::vector<std::size_t> outside;
    for (std::size_t t = 0; t < 5; ++t)
    {
      outside.push_back(t);
      for (const std::size_t cell : { 5, 6 })
      {
        inside.push_back(5 * ((cell * 12 + cell) * 12 + cell) + t);
      }
    }
    ExpectSeparate(pieces, inside, outside);
    ASSERT_FALSE(HasFailure()) << "round " << round;
    triangles.pop_back();
    EXPECT_FALSE(Sheet(points, triangles).IsClosed());
  }
}
