// SPDX-License-Identifier: BSD-3-Clause
// Cuts of a deformation mesh along its faces.
#include "Error.h"
#include "LatticeBody.h"
#include "MeshSplit.h"
#include "MeshSplitReference.h"
#include "ParallelFor.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

using namespace deformvolume;
using namespace physicsTesting;

namespace
{

constexpr std::array<int, 3> Nodes{ { 9, 9, 9 } };

struct SheetSurface
{
  std::vector<glm::dvec3> Points;
  SheetTriangles Triangles;

  void Add(const SheetSurface& other)
  {
    const auto first = static_cast<std::int64_t>(this->Points.size());
    this->Points.insert(this->Points.end(), other.Points.begin(), other.Points.end());
    for (const auto& t : other.Triangles)
    {
      this->Triangles.push_back({ { first + t[0], first + t[1], first + t[2] } });
    }
  }
};

// A parallelogram.
SheetSurface MakeSheet(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v)
{
  return { { corner, corner + u, corner + u + v, corner + v },
    { { { 0, 1, 2 } }, { { 0, 2, 3 } } } };
}

// Across a lattice of 9^3 nodes.
SheetSurface MakePlaneX(double x)
{
  return MakeSheet({ x, -1.0, -1.0 }, { 0.0, 10.0, 0.0 }, { 0.0, 0.0, 10.0 });
}
SheetSurface MakePlaneY(double y)
{
  return MakeSheet({ -1.0, y, -1.0 }, { 10.0, 0.0, 0.0 }, { 0.0, 0.0, 10.0 });
}

MeshSplit Split(const ElasticBody& body, const SheetSurface& sheet,
  const std::vector<TetrahedronPair>& unparted = {})
{
  return SplitMesh(body.Points, body.Tetrahedra, sheet.Points, sheet.Triangles, unparted);
}

// The body after a cut: copies lie where their nodes do.
ElasticBody Apply(ElasticBody body, const MeshSplit& split)
{
  body.Tetrahedra = split.Tetrahedra;
  for (const std::int32_t origin : split.Origins)
  {
    body.Points.push_back(body.Points[static_cast<std::size_t>(origin)]);
  }
  return body;
}

void ExpectSame(const MeshSplit& a, const MeshSplit& b)
{
  EXPECT_EQ(a.Tetrahedra, b.Tetrahedra);
  EXPECT_EQ(a.Origins, b.Origins);
  EXPECT_EQ(a.Changed, b.Changed);
  EXPECT_EQ(a.NumberOfFaces, b.NumberOfFaces);
  EXPECT_EQ(a.Unparted, b.Unparted);
}

void ExpectNothing(const ElasticBody& body, const MeshSplit& split)
{
  MeshSplit nothing;
  nothing.Tetrahedra = body.Tetrahedra;
  ExpectSame(split, nothing);
}

// What holds for every cut, whatever the sheet.
void ExpectSound(const ElasticBody& body, const MeshSplit& split)
{
  const auto before = static_cast<std::int32_t>(body.Points.size());
  ASSERT_EQ(split.Tetrahedra.size(), body.Tetrahedra.size());
  std::vector<std::size_t> changed;
  std::set<std::int32_t> used;
  for (std::size_t t = 0; t < body.Tetrahedra.size(); ++t)
  {
    for (std::size_t k = 0; k < 4; ++k)
    {
      const std::int32_t node = split.Tetrahedra[t][k];
      used.insert(node);
      ASSERT_LT(node, before + static_cast<std::int32_t>(split.Origins.size()));
      EXPECT_EQ(body.Tetrahedra[t][k],
        node < before ? node : split.Origins[static_cast<std::size_t>(node - before)]);
    }
    if (split.Tetrahedra[t] != body.Tetrahedra[t])
    {
      changed.push_back(t);
    }
  }
  EXPECT_EQ(split.Changed, changed);
  EXPECT_TRUE(std::is_sorted(split.Origins.begin(), split.Origins.end()));
  for (std::size_t copy = 0; copy < split.Origins.size(); ++copy)
  {
    EXPECT_EQ(used.count(before + static_cast<std::int32_t>(copy)), 1U);
    EXPECT_EQ(used.count(split.Origins[copy]), 1U);
  }
}

std::size_t CountComponents(const std::vector<std::int32_t>& components)
{
  return components.empty()
    ? 0
    : static_cast<std::size_t>(*std::max_element(components.begin(), components.end())) + 1;
}

// Expects pieces that have no node in common. Returns their volumes.
std::vector<double> ExpectPieces(const ElasticBody& body, std::size_t count)
{
  const std::vector<std::int32_t> components = FindFaceComponents(body.Tetrahedra);
  EXPECT_EQ(CountComponents(components), count);
  EXPECT_EQ(FindPieces(body).NumberOfPieces, static_cast<std::int32_t>(count));
  std::vector<double> volumes(count, 0.0);
  const std::vector<double> all = GetVolumes(body);
  for (std::size_t t = 0; t < all.size(); ++t)
  {
    const auto component = static_cast<std::size_t>(components[t]);
    if (component < count)
    {
      volumes[component] += all[t];
    }
  }
  return volumes;
}

ElasticBody MakeLattice()
{
  return MakeLatticeBody(Nodes, glm::dvec3(1.0));
}

ElasticBody MakePair()
{
  ElasticBody body;
  body.Points = { { 0.0, 0.0, -1.0 }, { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { -1.0, -1.0, 0.0 },
    { 0.0, 0.0, 1.0 } };
  body.Tetrahedra = { { { 0, 1, 2, 3 } }, { { 4, 1, 3, 2 } } };
  return body;
}

template <typename Function>
void ExpectError(Function&& function, const std::string& words)
{
  try
  {
    function();
    ADD_FAILURE() << "no error: " << words;
  }
  catch (const Error& error)
  {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

} // namespace

TEST(MeshSplit, Misuse)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const ElasticBody body = MakePair();
  const SheetSurface sheet = MakeSheet({ -2.0, -2.0, 0.1 }, { 4.0, 0.0, 0.0 }, { 0.0, 4.0, 0.0 });
  for (const std::int64_t bad : { std::int64_t{ -1 }, std::int64_t{ 4 }, std::int64_t{ 1 } << 40 })
  {
    SheetSurface wrong = sheet;
    wrong.Triangles[1][2] = bad;
    ExpectError([&] { Split(body, wrong); },
      "Triangle 1 of the sheet has the point " + std::to_string(bad) + ", but there are 4");
  }
  for (const double bad : { nan, infinity, -infinity })
  {
    SheetSurface wrong = sheet;
    wrong.Points[2].y = bad;
    ExpectError([&] { Split(body, wrong); }, "Point 2 of the sheet is not finite");
    ElasticBody broken = body;
    broken.Points[3].z = bad;
    ExpectError([&] { Split(broken, sheet); }, "node 3 of the deformation mesh is not finite");
  }
  SheetSurface far = sheet;
  far.Points[1].x = 1e7;
  ExpectError([&] { Split(body, far); }, "Point 1 of the sheet is more than a million times");
  for (const std::int32_t bad : { -1, 5 })
  {
    ElasticBody broken = body;
    broken.Tetrahedra[1][3] = bad;
    ExpectError([&] { Split(broken, sheet); },
      "Tetrahedron 1 of the deformation mesh has the node " + std::to_string(bad));
  }
  for (const std::int32_t bad : { -1, 2 })
  {
    ExpectError(
      [&] {
        Split(body, sheet, { { { 0, bad } } });
      },
      "tetrahedron " + std::to_string(bad));
  }
  ExpectError([] { FindFaceComponents({ { { 0, 1, -2, 3 } } }); }, "the node -2");
}

TEST(MeshSplit, NothingToDo)
{
  const SheetSurface sheet = MakePlaneX(4.5);
  ExpectNothing({}, Split({}, sheet));
  EXPECT_TRUE(FindFaceComponents({}).empty());
  const ElasticBody body = MakeLattice();
  ExpectNothing(body, Split(body, {}));
  ExpectNothing(body, Split(body, MakePlaneX(8.5)));
  ExpectNothing(body, Split(body, MakePlaneX(1e6)));
  // Within the mesh, but between no two centroids.
  ExpectNothing(
    body, Split(body, MakeSheet({ 4.5, 4.5, 4.6 }, { 0.01, 0.0, 0.0 }, { 0.0, 0.01, 0.0 })));
  // Without area.
  ExpectNothing(
    body, Split(body, MakeSheet({ 4.5, -1.0, 4.0 }, { 0.0, 9.0, 0.0 }, { 0.0, 2.0, 0.0 })));
  // Pairs that have parted, or never had a face in common, are dropped.
  ExpectNothing(body, Split(body, {}, { { { 0, 1 } }, { { 3, 3 } } }));
  // A mesh without a size, and one without a thickness.
  ElasticBody flat = MakePair();
  flat.Points.assign(5, glm::dvec3(1.0));
  ExpectNothing(flat, Split(flat, sheet));
  // Points and nodes that nothing has do not matter.
  ElasticBody more = MakePair();
  SheetSurface moreSheet = MakeSheet({ -2.0, -2.0, 0.1 }, { 4.0, 0.0, 0.0 }, { 0.0, 4.0, 0.0 });
  const MeshSplit split = Split(more, moreSheet);
  more.Points.emplace_back(std::numeric_limits<double>::quiet_NaN());
  more.Points.emplace_back(1e9);
  moreSheet.Points.emplace_back(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(Split(more, moreSheet).Origins, split.Origins);
}

TEST(MeshSplit, Pair)
{
  const ElasticBody body = MakePair();
  for (const double height : { 0.1, 0.0, -0.1, 0.25, -0.25 })
  {
    // A sheet through the upper centroid leaves both on one side, or below and above: the mesh
    // counts as moved upwards along all axes.
    const MeshSplit split =
      Split(body, MakeSheet({ -2.0, -2.0, height }, { 4.0, 0.0, 0.0 }, { 0.0, 4.0, 0.0 }));
    if (height == -0.25)
    {
      ExpectNothing(body, split);
      continue;
    }
    EXPECT_EQ(split.NumberOfFaces, 1);
    EXPECT_EQ(split.Origins, (std::vector<std::int32_t>{ 1, 2, 3 }));
    EXPECT_EQ(split.Changed, std::vector<std::size_t>{ 1 });
    EXPECT_EQ(split.Tetrahedra[0], body.Tetrahedra[0]);
    EXPECT_EQ(split.Tetrahedra[1], (Tetrahedron{ { 4, 5, 7, 6 } }));
    EXPECT_TRUE(split.Unparted.empty());
    const ElasticBody after = Apply(body, split);
    ExpectNothing(
      after, Split(after, MakeSheet({ -2.0, -2.0, height }, { 4.0, 0.0, 0.0 }, { 0.0, 4.0, 0.0 })));
  }
}

TEST(MeshSplit, Planes)
{
  const ElasticBody body = MakeLattice();
  const auto cut = [&](const SheetSurface& sheet)
  {
    const MeshSplit split = Split(body, sheet);
    ExpectSound(body, split);
    EXPECT_TRUE(split.Unparted.empty());
    return ExpectPieces(Apply(body, split), 2);
  };
  // Along faces: two triangles a cell.
  EXPECT_EQ(Split(body, MakePlaneX(4.0)).NumberOfFaces, 128);
  EXPECT_EQ(Split(body, MakePlaneX(4.0)).Origins.size(), 81U);
  std::vector<double> volumes = cut(MakePlaneX(4.0));
  EXPECT_NEAR(volumes[0], 256.0, 1e-9);
  EXPECT_NEAR(volumes[1], 256.0, 1e-9);
  // Through the centroids of the tetrahedra in the middle of cells, which are a third of them and
  // count as moved to higher x. Two of the others, a sixth each, lie on either side.
  volumes = cut(MakePlaneX(4.5));
  EXPECT_NEAR(volumes[0], 256.0 + 64.0 / 3.0, 1e-9);
  EXPECT_NEAR(volumes[1], 256.0 - 64.0 / 3.0, 1e-9);
  volumes = cut(MakeSheet({ -1.0, 9.0, -1.0 }, { 10.0, -10.0, 0.0 }, { 0.0, 0.0, 10.0 }));
  EXPECT_NEAR(volumes[0] + volumes[1], 512.0, 1e-9);
  // A cell has a cross-section less than sqrt(2), and there are 8 by 8 on the way.
  EXPECT_NEAR(volumes[0], 256.0, 64.0);
  volumes = cut(MakeSheet({ -1.0, -1.0, 4.0 }, { 10.0, 0.0, 1.7 }, { 0.0, 10.0, -0.9 }));
  EXPECT_NEAR(volumes[0] + volumes[1], 512.0, 1e-9);
  // The middle of the box lies 0.4 below the sheet, or so: 256 and 25.6 more.
  EXPECT_NEAR(volumes[0], 281.6, 10.0);
}

// Where a sheet is closed, what is inside comes out whole.
TEST(MeshSplit, ClosedSheet)
{
  const ElasticBody body = MakeLattice();
  SheetSurface sheet;
  for (const double at : { 2.0, 6.0 })
  {
    sheet.Add(MakeSheet({ at, 2.0, 2.0 }, { 0.0, 4.0, 0.0 }, { 0.0, 0.0, 4.0 }));
    sheet.Add(MakeSheet({ 2.0, at, 2.0 }, { 4.0, 0.0, 0.0 }, { 0.0, 0.0, 4.0 }));
    sheet.Add(MakeSheet({ 2.0, 2.0, at }, { 4.0, 0.0, 0.0 }, { 0.0, 4.0, 0.0 }));
  }
  const MeshSplit split = Split(body, sheet);
  ExpectSound(body, split);
  const std::vector<double> volumes = ExpectPieces(Apply(body, split), 2);
  EXPECT_NEAR(volumes[0], 448.0, 1e-9);
  EXPECT_NEAR(volumes[1], 64.0, 1e-9);
}

TEST(MeshSplit, EndInside)
{
  const ElasticBody body = MakeLattice();
  const SheetSurface sheet = MakeSheet({ 4.0, -1.0, -1.0 }, { 0.0, 5.0, 0.0 }, { 0.0, 0.0, 10.0 });
  const MeshSplit split = Split(body, sheet);
  ExpectSound(body, split);
  const ElasticBody after = Apply(body, split);
  ExpectPieces(after, 1);
  // It ends at y = 4, along edges of the mesh: the nodes there remain.
  EXPECT_EQ(split.NumberOfFaces, 64);
  EXPECT_TRUE(split.Unparted.empty());
  EXPECT_EQ(split.Origins.size(), 36U);
  for (const std::int32_t origin : split.Origins)
  {
    EXPECT_EQ(body.Points[static_cast<std::size_t>(origin)].x, 4.0);
    EXPECT_LT(body.Points[static_cast<std::size_t>(origin)].y, 4.0);
  }
  // The rest of the way.
  const MeshSplit rest =
    Split(after, MakeSheet({ 4.0, 4.0, -1.0 }, { 0.0, 5.0, 0.0 }, { 0.0, 0.0, 10.0 }));
  ExpectSound(after, rest);
  EXPECT_EQ(rest.Origins.size(), 45U);
  const std::vector<double> volumes = ExpectPieces(Apply(after, rest), 2);
  EXPECT_NEAR(volumes[0], 256.0, 1e-9);
}

// Cuts that are shorter than the tetrahedra: each on its own opens nothing.
TEST(MeshSplit, ManyShortCuts)
{
  ElasticBody body = MakeLattice();
  std::vector<TetrahedronPair> unparted;
  std::size_t most = 0;
  std::int64_t faces = 0;
  constexpr double length = 0.21;
  for (double y = -0.1; y < 8.0; y += length)
  {
    for (double z = -0.1; z < 8.0; z += length)
    {
      const MeshSplit split = Split(body,
        MakeSheet({ 4.0, y, z }, { 0.0, length + 0.01, 0.0 }, { 0.0, 0.0, length + 0.01 }),
        unparted);
      unparted = split.Unparted;
      most = std::max(most, unparted.size());
      faces += split.NumberOfFaces;
      body = Apply(body, split);
    }
  }
  EXPECT_GT(most, 0U);
  EXPECT_TRUE(unparted.empty());
  EXPECT_EQ(faces, 128);
  const std::vector<double> volumes = ExpectPieces(body, 2);
  EXPECT_NEAR(volumes[0], 256.0, 1e-9);
}

TEST(MeshSplit, CrossingCuts)
{
  const ElasticBody body = MakeLattice();
  SheetSurface both = MakePlaneX(4.5);
  both.Add(MakePlaneY(3.25));
  const ElasticBody once = Apply(body, Split(body, both));
  ExpectPieces(once, 4);
  // One after the other: the same pieces.
  const ElasticBody first = Apply(body, Split(body, MakePlaneX(4.5)));
  const MeshSplit second = Split(first, MakePlaneY(3.25));
  ExpectSound(first, second);
  const ElasticBody twice = Apply(first, second);
  ExpectPieces(twice, 4);
  EXPECT_EQ(FindFaceComponents(once.Tetrahedra), FindFaceComponents(twice.Tetrahedra));
  // A third, oblique.
  const ElasticBody third = Apply(
    twice, Split(twice, MakeSheet({ -1.0, -1.0, 4.0 }, { 10.0, 0.0, 0.3 }, { 0.0, 10.0, 0.4 })));
  ExpectPieces(third, 8);
}

TEST(MeshSplit, EvenCrossings)
{
  const ElasticBody body = MakeLattice();
  SheetSurface twice = MakePlaneX(4.0);
  twice.Add(MakePlaneX(4.0));
  ExpectNothing(body, Split(body, twice));
  // A fold between two layers of centroids.
  SheetSurface fold = MakePlaneX(3.95);
  fold.Add(MakePlaneX(4.05));
  fold.Add(MakeSheet({ 3.95, 9.0, -1.0 }, { 0.1, 0.0, 0.0 }, { 0.0, 0.0, 10.0 }));
  ExpectNothing(body, Split(body, fold));
  SheetSurface thrice = twice;
  thrice.Add(MakePlaneX(4.0));
  ExpectSame(Split(body, thrice), Split(body, MakePlaneX(4.0)));
  // Segments through the line where a sheet crosses itself lead from above it to below it, and hold
  // these together; two cuts have all four sides apart.
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

// Neither does it matter where in space, and how large, the mesh is.
TEST(MeshSplit, OrderAndOrientation)
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

// A sheet is where the mesh is now.
TEST(MeshSplit, DeformedPositions)
{
  const ElasticBody rest = MakeLattice();
  ElasticBody bent = rest;
  SheetSurface sheet;
  const auto bend = [](const glm::dvec3& p)
  { return glm::dvec3(p.x + 0.1 * p.y * p.y, p.y, p.z + 3.0); };
  std::transform(rest.Points.begin(), rest.Points.end(), bent.Points.begin(), bend);
  for (int row = -1; row < 9; ++row)
  {
    const glm::dvec3 begin = bend({ 4.0, row, -1.0 });
    sheet.Add(MakeSheet(begin, bend({ 4.0, row + 1, -1.0 }) - begin, { 0.0, 0.0, 10.0 }));
  }
  ExpectSame(Split(bent, sheet), Split(rest, MakePlaneX(4.0)));
}

// Tetrahedra that touch at an edge only.
TEST(MeshSplit, ContactsPart)
{
  ElasticBody body = MakePair();
  body.Points.emplace_back(2.0, 2.0, -1.0);
  body.Points.emplace_back(3.0, 2.0, -1.0);
  // The edge of nodes 1 and 2, and a pair with a node in common that is not touched.
  body.Tetrahedra.push_back({ { 1, 2, 5, 6 } });
  body.Points.emplace_back(5.0, 2.0, -1.0);
  body.Points.emplace_back(5.0, 2.0, -2.0);
  body.Points.emplace_back(5.0, 3.0, -2.0);
  body.Tetrahedra.push_back({ { 6, 7, 8, 9 } });
  const MeshSplit split =
    Split(body, MakeSheet({ -2.0, -2.0, 0.0 }, { 9.0, 0.0, 0.0 }, { 0.0, 9.0, 0.0 }));
  ExpectSound(body, split);
  EXPECT_EQ(split.NumberOfFaces, 1);
  EXPECT_EQ(split.Origins, (std::vector<std::int32_t>{ 1, 1, 2, 2, 3 }));
  EXPECT_EQ(split.Tetrahedra[0], body.Tetrahedra[0]);
  EXPECT_EQ(split.Tetrahedra[1], (Tetrahedron{ { 4, 10, 14, 12 } }));
  EXPECT_EQ(split.Tetrahedra[2], (Tetrahedron{ { 11, 13, 5, 6 } }));
  EXPECT_EQ(split.Tetrahedra[3], body.Tetrahedra[3]);
  EXPECT_EQ(FindFaceComponents(split.Tetrahedra), (std::vector<std::int32_t>{ 0, 1, 2, 3 }));
}

// Three tetrahedra at one face, and one that is there twice: no mesh, but no reason to fail.
TEST(MeshSplit, FacesOfMany)
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

// Lattices without some of their tetrahedra, shaken; triangles at random and strips, twice.
TEST(MeshSplit, Random)
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
    // Multiples of 2^-14, as centroids are of 2^-16. The longest side remains 8.
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
      // Multiples of 2^-9: where a triangle is divided, it is divided exactly.
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
      unparted += static_cast<int>(split.Unparted.size());
      pairs = split.Unparted;
      body = Apply(body, split);
    }
  }
  // Few have triangles that are segments, and edges that meet.
  EXPECT_GT(compared, 400);
  EXPECT_GT(copies, 4000);
  EXPECT_GT(unparted, 100);
}
