// SPDX-License-Identifier: BSD-3-Clause
// Cuts of a deformation mesh along its faces: the components after the cuts.
#include "Error.h"
#include "MeshSplitCase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

using namespace deformvolume;
using namespace physicsTesting;

namespace
{

template <typename Function>
void ExpectError(Function&& function, const std::string& words)
{
  try
  {
    function();
    ADD_FAILURE() << "expected the error \"" << words << "\", but none was thrown";
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
      "Tetrahedron 1 of the deformation mesh refers to node " + std::to_string(bad));
  }
  for (const std::int32_t bad : { -1, 2 })
  {
    ExpectError(
      [&] {
        Split(body, sheet, { { { 0, bad } } });
      },
      "tetrahedron " + std::to_string(bad));
  }
}

TEST(MeshSplit, NothingToDo)
{
  const SheetSurface sheet = MakePlaneX(4.5);
  ExpectNothing({}, Split({}, sheet));
  const ElasticBody body = MakeLattice();
  ExpectNothing(body, Split(body, {}));
  ExpectNothing(body, Split(body, MakePlaneX(8.5)));
  ExpectNothing(body, Split(body, MakePlaneX(1e6)));
  // A sheet within the mesh that separates no two centroids.
  ExpectNothing(
    body, Split(body, MakeSheet({ 4.5, 4.5, 4.6 }, { 0.01, 0.0, 0.0 }, { 0.0, 0.01, 0.0 })));
  // A sheet without area.
  ExpectNothing(
    body, Split(body, MakeSheet({ 4.5, -1.0, 4.0 }, { 0.0, 9.0, 0.0 }, { 0.0, 2.0, 0.0 })));
  // Pairs that are already separate, or never shared a face, are removed from the list.
  ExpectNothing(body, Split(body, {}, { { { 0, 1 } }, { { 3, 3 } } }));
  // A mesh whose nodes all coincide.
  ElasticBody flat = MakePair();
  flat.Points.assign(5, glm::dvec3(1.0));
  ExpectNothing(flat, Split(flat, sheet));
  // Unused points of the sheet and unused nodes are ignored.
  ElasticBody more = MakePair();
  SheetSurface moreSheet = MakeSheet({ -2.0, -2.0, 0.1 }, { 4.0, 0.0, 0.0 }, { 0.0, 4.0, 0.0 });
  const MeshSplit split = Split(more, moreSheet);
  more.Points.emplace_back(std::numeric_limits<double>::quiet_NaN());
  more.Points.emplace_back(1e9);
  moreSheet.Points.emplace_back(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(Split(more, moreSheet).Origins, split.Origins);
}

TEST(MeshSplit, TwoTetrahedra)
{
  const ElasticBody body = MakePair();
  for (const double height : { 0.1, 0.0, -0.1, 0.25, -0.25 })
  {
    // The mesh counts as moved slightly upwards along all axes. A centroid on the sheet is
    // therefore above it: a sheet through the upper centroid separates the tetrahedra, and a sheet
    // through the lower centroid does not.
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
    EXPECT_TRUE(split.StillConnected.empty());
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
    EXPECT_TRUE(split.StillConnected.empty());
    return ExpectPieces(Apply(body, split), 2);
  };
  // Cuts along faces, with two triangles per cell.
  EXPECT_EQ(Split(body, MakePlaneX(4.0)).NumberOfFaces, 128);
  EXPECT_EQ(Split(body, MakePlaneX(4.0)).Origins.size(), 81U);
  std::vector<double> volumes = cut(MakePlaneX(4.0));
  EXPECT_NEAR(volumes[0], 256.0, 1e-9);
  EXPECT_NEAR(volumes[1], 256.0, 1e-9);
  // The sheet passes through the centroids of the central tetrahedra, which have a third of the
  // volume of the cells and count as moved to higher x. Two of the other tetrahedra, with a sixth
  // of the volume each, lie on either side.
  volumes = cut(MakePlaneX(4.5));
  EXPECT_NEAR(volumes[0], 256.0 + 64.0 / 3.0, 1e-9);
  EXPECT_NEAR(volumes[1], 256.0 - 64.0 / 3.0, 1e-9);
  volumes = cut(MakeSheet({ -1.0, 9.0, -1.0 }, { 10.0, -10.0, 0.0 }, { 0.0, 0.0, 10.0 }));
  EXPECT_NEAR(volumes[0] + volumes[1], 512.0, 1e-9);
  // The cross-section of a cell is less than sqrt(2), and the sheet passes through 8 x 8 cells.
  EXPECT_NEAR(volumes[0], 256.0, 64.0);
  volumes = cut(MakeSheet({ -1.0, -1.0, 4.0 }, { 10.0, 0.0, 1.7 }, { 0.0, 10.0, -0.9 }));
  EXPECT_NEAR(volumes[0] + volumes[1], 512.0, 1e-9);
  // The center of the box lies about 0.4 below the sheet: 25.6 more than half of the volume of 512.
  EXPECT_NEAR(volumes[0], 281.6, 10.0);
}

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

TEST(MeshSplit, SheetThatEndsInside)
{
  const ElasticBody body = MakeLattice();
  const SheetSurface sheet = MakeSheet({ 4.0, -1.0, -1.0 }, { 0.0, 5.0, 0.0 }, { 0.0, 0.0, 10.0 });
  const MeshSplit split = Split(body, sheet);
  ExpectSound(body, split);
  const ElasticBody after = Apply(body, split);
  ExpectPieces(after, 1);
  // The sheet ends at y = 4, along edges of the mesh. The nodes on these edges are not split.
  EXPECT_EQ(split.NumberOfFaces, 64);
  EXPECT_TRUE(split.StillConnected.empty());
  EXPECT_EQ(split.Origins.size(), 36U);
  for (const std::int32_t origin : split.Origins)
  {
    EXPECT_EQ(body.Points[static_cast<std::size_t>(origin)].x, 4.0);
    EXPECT_LT(body.Points[static_cast<std::size_t>(origin)].y, 4.0);
  }
  // A second sheet continues the cut to the end of the mesh.
  const MeshSplit rest =
    Split(after, MakeSheet({ 4.0, 4.0, -1.0 }, { 0.0, 5.0, 0.0 }, { 0.0, 0.0, 10.0 }));
  ExpectSound(after, rest);
  EXPECT_EQ(rest.Origins.size(), 45U);
  const std::vector<double> volumes = ExpectPieces(Apply(after, rest), 2);
  EXPECT_NEAR(volumes[0], 256.0, 1e-9);
}

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
      unparted = split.StillConnected;
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
  // One cut after the other gives the same components.
  const ElasticBody first = Apply(body, Split(body, MakePlaneX(4.5)));
  const MeshSplit second = Split(first, MakePlaneY(3.25));
  ExpectSound(first, second);
  const ElasticBody twice = Apply(first, second);
  ExpectPieces(twice, 4);
  EXPECT_EQ(FindFaceComponents(once.Tetrahedra), FindFaceComponents(twice.Tetrahedra));
  // A third, oblique cut.
  const ElasticBody third = Apply(
    twice, Split(twice, MakeSheet({ -1.0, -1.0, 4.0 }, { 10.0, 0.0, 0.3 }, { 0.0, 10.0, 0.4 })));
  ExpectPieces(third, 8);
}

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

TEST(MeshSplit, ContactsSeparate)
{
  ElasticBody body = MakePair();
  body.Points.emplace_back(2.0, 2.0, -1.0);
  body.Points.emplace_back(3.0, 2.0, -1.0);
  // The third tetrahedron shares the edge of nodes 1 and 2. The fourth one shares a node with the
  // third one, which the cut does not split.
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
