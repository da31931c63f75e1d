// SPDX-License-Identifier: BSD-3-Clause
// Cuts of a deformation mesh along its faces: the faces that are split.
#include "BodyPieces.h"
#include "LatticeBody.h"
#include "MeshSplitCase.h"
#include "ParallelFor.h"

#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace deformvolume;
using namespace physicsTesting;

TEST(SplitFaces, NoPieceOnBothSides)
{
  constexpr std::array<int, 3> nodes{ { 5, 5, 5 } };
  const ElasticBody body = MakeLatticeBody(nodes, glm::dvec3(1.0));
  std::mt19937 random(1);
  const auto draw = [&](int least, int greatest)
  { return static_cast<double>(std::uniform_int_distribution<>(least, greatest)(random)); };
  for (int i = 0; i < 200; ++i)
  {
    const glm::dvec3 center(draw(2, 14) / 4.0, draw(2, 14) / 4.0, draw(2, 14) / 4.0);
    const glm::dvec3 u(draw(-2, 2), draw(-2, 2), draw(-2, 2));
    const glm::dvec3 v(draw(-2, 2), draw(-2, 2), draw(-2, 2));
    const glm::dvec3 normal = glm::cross(u, v);
    if (normal == glm::dvec3(0.0))
    {
      continue;
    }
    // The sheet extends far beyond the mesh at any angle.
    const MeshSplit split = Split(body, MakeSheet(center - 32.0 * (u + v), 64.0 * u, 64.0 * v));
    ExpectSound(body, split);
    EXPECT_GT(split.NumberOfFaces, 0);
    const ElasticBody after = Apply(body, split);
    const BodyPieces pieces = FindBodyPieces(after);
    std::vector<int> sides(static_cast<std::size_t>(pieces.NumberOfPieces), 0);
    for (const Tetrahedron& t : after.Tetrahedra)
    {
      glm::dvec3 sum(0.0);
      for (const std::int32_t node : t)
      {
        sum += after.Points[static_cast<std::size_t>(node)];
      }
      const double height = glm::dot(normal, sum - 4.0 * center);
      sides[static_cast<std::size_t>(pieces.PieceOfNode[static_cast<std::size_t>(t[0])])] |=
        height > 0.0   ? 1
        : height < 0.0 ? 2
                       : 0;
    }
    EXPECT_EQ(std::count(sides.begin(), sides.end(), 3), 0);
  }
}

TEST(SplitFaces, EvenNumbersOfCrossingsDoNotSplit)
{
  const ElasticBody body = MakeLattice();
  SheetSurface twice = MakePlaneX(4.0);
  twice.Add(MakePlaneX(4.0));
  ExpectNothing(body, Split(body, twice));
  // A folded sheet between two layers of centroids.
  SheetSurface fold = MakePlaneX(3.95);
  fold.Add(MakePlaneX(4.05));
  fold.Add(MakeSheet({ 3.95, 9.0, -1.0 }, { 0.1, 0.0, 0.0 }, { 0.0, 0.0, 10.0 }));
  ExpectNothing(body, Split(body, fold));
  SheetSurface thrice = twice;
  thrice.Add(MakePlaneX(4.0));
  ExpectSame(Split(body, thrice), Split(body, MakePlaneX(4.0)));
  // At the line where a sheet crosses itself, some segments cross it twice and connect the regions
  // above and below it. Two separate cuts instead give four components.
  const SheetSurface up = MakeSheet({ -1.0, -1.0, 2.1 }, { 10.0, 0.0, 4.0 }, { 0.0, 10.0, 0.0 });
  const SheetSurface down = MakeSheet({ -1.0, -1.0, 6.1 }, { 10.0, 0.0, -4.0 }, { 0.0, 10.0, 0.0 });
  SheetSurface crossing = up;
  crossing.Add(down);
  const MeshSplit split = Split(body, crossing);
  ExpectSound(body, split);
  ExpectPieces(Apply(body, split), 3);
  const ElasticBody first = Apply(body, Split(body, up));
  ExpectPieces(Apply(first, Split(first, down)), 4);
}

TEST(SplitFaces, OrderAndOrientationOfTrianglesDoNotMatter)
{
  const ElasticBody body = MakeLattice();
  SheetSurface sheet = MakeSheet({ -1.0, -1.0, 4.5 }, { 10.0, 0.0, 1.5 }, { 0.0, 10.0, -1.5 });
  sheet.Add(MakePlaneX(4.5));
  const MeshSplit expected = Split(body, sheet);
  EXPECT_GT(expected.NumberOfFaces, 128);
  std::mt19937 random(1);
  for (int i = 0; i < 10; ++i)
  {
    std::shuffle(sheet.Triangles.begin(), sheet.Triangles.end(), random);
    for (auto& triangle : sheet.Triangles)
    {
      std::shuffle(triangle.begin(), triangle.end(), random);
    }
    ExpectSame(Split(body, sheet), expected);
  }
  ElasticBody moved = body;
  SheetSurface movedSheet = sheet;
  for (std::vector<glm::dvec3>* points : { &moved.Points, &movedSheet.Points })
  {
    for (glm::dvec3& point : *points)
    {
      point = point / 1024.0 + glm::dvec3(-16.0, 2.0, 0.5);
    }
  }
  ExpectSame(Split(moved, movedSheet), expected);
  SetParallelLoop(
    [](std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& loopBody)
    { RunOnOwnThreads(first, last, grain, loopBody, 1); });
  const MeshSplit alone = Split(body, sheet);
  SetParallelLoop(nullptr);
  ExpectSame(alone, expected);
}

TEST(SplitFaces, SegmentsBetweenCentroidsOutsideTetrahedra)
{
  ElasticBody body;
  body.Points = { { 0.0, 0.0, 0.0 }, { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 10.0, 1.0, 1.0 },
    { 1.0, 10.0, -1.0 } };
  body.Tetrahedra = { { { 0, 1, 2, 3 } }, { { 0, 2, 1, 4 } } };
  // The centroids are (2.75, 0.5, 0.25) and (0.5, 2.75, -0.25).
  const auto cut = [&](const glm::dvec3& at)
  {
    return Split(
      body, MakeSheet(at - glm::dvec3(0.05, 0.0, 0.05), { 0.1, 0.01, 0.0 }, { 0.0, 0.01, 0.1 }));
  };
  const auto cutAcross = [&](double x) {
    return Split(body, MakeSheet({ x, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 }));
  };
  for (int turn = 0; turn < 2; ++turn)
  {
    EXPECT_EQ(cut({ 1.625, 1.62, 0.0 }).NumberOfFaces, 1);
    EXPECT_EQ(cut({ 1.425, 1.62, 0.0 }).NumberOfFaces, 0);
    std::swap(body.Tetrahedra[0], body.Tetrahedra[1]);
  }
  body.Points[3] = { 40.0, 1.0, 1.0 };
  body.Points[4] = { 0.3, 0.3, -0.3 };
  // The centroids are (10.25, 0.5, 0.25) and (0.325, 0.325, -0.075).
  for (int turn = 0; turn < 2; ++turn)
  {
    EXPECT_EQ(cutAcross(8.0).NumberOfFaces, 1);
    EXPECT_EQ(cutAcross(10.5).NumberOfFaces, 0);
    std::swap(body.Tetrahedra[0], body.Tetrahedra[1]);
  }
}

TEST(SplitFaces, FacesOfSeveralTetrahedra)
{
  ElasticBody body = MakePair();
  body.Points.emplace_back(0.1, 0.1, 2.0);
  body.Tetrahedra.push_back({ { 5, 1, 3, 2 } });
  body.Tetrahedra.push_back(body.Tetrahedra[2]);
  const SheetSurface sheet = MakeSheet({ -2.0, -2.0, 0.1 }, { 4.0, 0.0, 0.0 }, { 0.0, 4.0, 0.0 });
  ExpectNothing(body, Split(body, sheet));
  body.Tetrahedra.push_back({ { 4, 4, 3, 2 } });
  ExpectNothing(body, Split(body, sheet));
  EXPECT_EQ(CountComponents(FindFaceComponents(body.Tetrahedra)), 1U);
}

TEST(SplitFaces, RandomSheetsEqualTheReference)
{
  constexpr std::array<int, 3> nodes{ { 4, 5, 4 } };
  int compared = 0;
  int copies = 0;
  int unparted = 0;
  for (unsigned int seed = 1; seed <= 300; ++seed)
  {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto draw = [&](double low, double high, double step)
    { return std::floor(std::uniform_real_distribution<>(low, high)(random) / step) * step; };
    ElasticBody body = MakeLatticeBody(nodes, glm::dvec3(2.0));
    const auto last = static_cast<std::int32_t>(body.Points.size() - 1);
    // Points are multiples of 2^-14, so that centroids are multiples of 2^-16. The longest side
    // remains 8.
    for (glm::dvec3& point : body.Points)
    {
      const glm::dvec3 offset(
        draw(-0.6, 0.6, 0x1p-14), draw(-0.6, 0.6, 0x1p-14), draw(-0.6, 0.6, 0x1p-14));
      const bool isEnd = point.y == 0.0 || point.y == 8.0;
      point += isEnd ? offset * glm::dvec3(1.0, 0.0, 1.0) : offset;
    }
    const double kept = draw(0.6, 1.05, 0.01);
    body.Tetrahedra.erase(std::remove_if(body.Tetrahedra.begin(), body.Tetrahedra.end(),
                            [&](const Tetrahedron& t)
                            {
                              return *std::min_element(t.begin(), t.end()) != 0 &&
                                *std::max_element(t.begin(), t.end()) != last &&
                                draw(0.0, 1.0, 0.001) > kept;
                            }),
      body.Tetrahedra.end());
    std::shuffle(body.Tetrahedra.begin(), body.Tetrahedra.end(), random);
    std::vector<TetrahedronPair> pairs;
    for (int cut = 0; cut < 2; ++cut)
    {
      // Points are multiples of 2^-9, so that dividing a triangle is exact.
      SheetSurface sheet;
      for (int i = 0; i < 8; ++i)
      {
        sheet.Points.emplace_back(
          draw(-2.0, 8.0, 0x1p-9), draw(-2.0, 10.0, 0x1p-9), draw(-2.0, 8.0, 0x1p-9));
      }
      for (std::int64_t i = 0; i < 6; ++i)
      {
        const auto at = [&](std::int64_t k)
        { return seed % 2 == 0 ? i + k : static_cast<std::int64_t>(random() % 8); };
        sheet.Triangles.push_back({ { at(0), at(1), at(2) } });
      }
      sheet.Triangles.resize(1 + random() % 6);
      const auto expected =
        SplitMeshSlowly(body.Points, body.Tetrahedra, sheet.Points, sheet.Triangles, pairs);
      if (!expected)
      {
        break;
      }
      const MeshSplit split = Split(body, sheet, pairs);
      ExpectSame(split, *expected);
      ++compared;
      copies += static_cast<int>(split.Origins.size());
      unparted += static_cast<int>(split.StillConnected.size());
      pairs = split.StillConnected;
      body = Apply(body, split);
    }
  }
  // Few cases are left out because the reference cannot decide them.
  EXPECT_GT(compared, 400);
  EXPECT_GT(copies, 4000);
  EXPECT_GT(unparted, 100);
}
