// SPDX-License-Identifier: BSD-3-Clause
// Supports of finite elements: prescribed displacements, planes in which nodes slide, and which
// supports suffice.
#include "Error.h"
#include "FiniteElementCase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

using namespace deformvolume;

namespace
{

using Place = LatticeBody::Place;

// A cube of size 1 m.
QuadraticLattice MakeCube(const std::function<bool(const Place&)>& isFixed = nullptr)
{
  return QuadraticLattice({ 3, 3, 3 }, 0.5, MakeMaterial(1e4, 0.45), isFixed);
}

// Makes the nodes of a face slide in its plane. Nodes of two faces slide along their common edge.
void SlideFace(ElasticBody& body, int axis)
{
  body.SlidingNormals.resize(body.Points.size(), glm::dvec3(0.0));
  body.SecondSlidingNormals.resize(body.Points.size(), glm::dvec3(0.0));
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    const bool isFirst = body.SlidingNormals[node] == glm::dvec3(0.0);
    if (body.Points[node][axis] == 0.0)
    {
      (isFirst ? body.SlidingNormals : body.SecondSlidingNormals)[node][axis] = -3.0;
    }
  }
}

} // namespace

TEST(ElementConditions, Misuse)
{
  ElasticBody body = MakeCube([](const Place& place) { return place[2] == 0; }).Body;
  const auto getError = [&] { return GetError([&] { CheckBody(body); }); };
  body.SlidingNormals.resize(5);
  EXPECT_NE(getError().find("5 normals of sliding nodes, but "), std::string::npos);
  body.SlidingNormals.assign(body.Points.size(), glm::dvec3(0.0));
  body.SlidingNormals[26].y = NoNumber;
  EXPECT_EQ(getError(), "The sliding normal of node 26 is not finite.");
  body.SlidingNormals[26].y = 1.0;
  EXPECT_EQ(getError(), "");
  body.SlidingNormals[3].x = 1.0;
  body.SlidingNormals[4].x = 1.0;
  EXPECT_EQ(getError(),
    "2 nodes have contradictory conditions: they are fixed, and have a sliding normal. The first "
    "of them is node 3. Set one of the two to 0.");
  // A node with two normals counts once.
  body.SecondSlidingNormals.assign(body.Points.size(), glm::dvec3(0.0));
  body.SecondSlidingNormals[2].y = 1.0;
  body.SecondSlidingNormals[4].y = 1.0;
  EXPECT_EQ(getError().rfind("3 nodes have contradictory conditions", 0), 0u);
  EXPECT_NE(getError().find("them is node 2."), std::string::npos);
  body.SecondSlidingNormals.clear();

  body.SlidingNormals.clear();
  FiniteElementModel model;
  model.SetBody(body);
  EquilibriumRequest request = MakeConverged();
  request.Loads.FixedDisplacements.resize(3);
  EXPECT_NE(GetError([&] { model.Solve(request); }).find("displacements of fixed nodes, but "),
    std::string::npos);
  request.Loads.FixedDisplacements.assign(body.Points.size(), glm::dvec3(0.0));
  request.Loads.FixedDisplacements[7].z = NoNumber;
  EXPECT_EQ(GetError([&] { model.Solve(request); }),
    "The prescribed displacement of node 7 is not finite.");
}

// Fixed nodes move to prescribed displacements, and back.
TEST(ElementConditions, FixedNodesAreDisplaced)
{
  ElasticBody body = MakeCube().Body;
  body.Fixed.assign(body.Points.size(), 0);
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    const glm::dvec3& p = body.Points[node];
    body.Fixed[node] = std::min({ p.x, p.y, p.z, 1 - p.x, 1 - p.y, 1 - p.z }) < 1e-9 ? 1 : 0;
  }
  const std::vector<glm::dvec3> wanted =
    MapPoints(body, glm::dmat3(1.2, 0.1, 0, 0, 0.9, 0.1, 0, 0, 1.1), glm::dvec3(0.5, 0.0, 0.0));
  FiniteElementModel model;
  model.SetBody(body);
  EquilibriumRequest request = MakeConverged();
  request.Limits.RelativeTolerance = 1e-11;
  request.Loads.FixedDisplacements = wanted;
  EXPECT_TRUE(model.Solve(request).IsConverged);
  EXPECT_LT(LargestDifference(model.GetDisplacements(), wanted), 1e-10);
  request.Loads.FixedDisplacements.clear();
  EXPECT_TRUE(model.Solve(request).IsConverged);
  EXPECT_LT(LargestOf(model.GetDisplacements()), 1e-10);
}

// Nodes on a line do not hold a body, also if their coordinates were rounded to floats far from the
// origin. Those of a thin face do, whatever their numbers.
TEST(ElementConditions, LinesAndThinFaces)
{
  const auto holds = [](const ElasticBody& body)
  {
    FiniteElementModel model;
    model.SetBody(body);
    return GetError([&] { model.Solve({}); }).find("No constraints") == std::string::npos;
  };
  QuadraticLattice bar({ 3, 3, 60 }, 1e-3, MakeMaterial(1e4, 0.3),
    [](const Place& place) { return place[0] + place[1] == 0; });
  const glm::dmat3 turn = MakeRotation(0.7, { 1.0, 0.5, -0.8 });
  for (glm::dvec3& point : bar.Body.Points)
  {
    point = glm::dvec3(glm::vec3(turn * point + glm::dvec3(0.0, 0.0, -1.2)));
  }
  EXPECT_FALSE(holds(bar.Body));

  LatticeBody sheet({ 61, 2, 3 }, 1.0, MakeMaterial(1e4, 0.3));
  sheet.Fix([](const Place& place) { return place[2] == 0; });
  for (glm::dvec3& point : sheet.Body.Points)
  {
    point *= glm::dvec3(5e-3, 2.5e-4, 2.5e-4);
  }
  // The ends of an edge that is 1200 times as long as the face is thick have the lowest numbers.
  const std::int32_t end = sheet.GetNode({ 60, 0, 0 });
  std::swap(sheet.Body.Points[1], sheet.Body.Points[static_cast<std::size_t>(end)]);
  for (Tetrahedron& tetrahedron : sheet.Body.Tetrahedra)
  {
    for (std::int32_t& node : tetrahedron)
    {
      node = node == 1 ? end : node == end ? 1 : node;
    }
  }
  AddMidSideNodes(sheet.Body);
  EXPECT_TRUE(holds(sheet.Body));
}

// Three planes hold a body without fixed nodes; two planes do not.
TEST(ElementConditions, ThreePlanesHoldABody)
{
  QuadraticLattice cube = MakeCube();
  ElasticBody& body = cube.Body;
  SlideFace(body, 0);
  SlideFace(body, 1);
  FiniteElementModel model;
  model.SetBody(body);
  EXPECT_NE(GetError([&] { model.Solve({}); }).find("No constraints"), std::string::npos);
  // Two planes do not suffice either if the remaining motion is not along an axis.
  ElasticBody turned = body;
  const glm::dmat3 turn = MakeRotation(0.7, { 1.0, 0.5, -0.8 });
  for (auto* vectors : { &turned.Points, &turned.SlidingNormals, &turned.SecondSlidingNormals })
  {
    for (glm::dvec3& vector : *vectors)
    {
      vector = turn * vector;
    }
  }
  model.SetBody(turned);
  EXPECT_NE(GetError([&] { model.Solve({}); }).find("No constraints"), std::string::npos);
  SlideFace(body, 2);
  model.SetBody(body);
  EquilibriumRequest request = MakeConverged();
  request.Limits.RelativeTolerance = 1e-10;
  // Uniaxial tension of 1e-3 Pa, small enough for linear elasticity.
  request.Loads.Forces = LoadFaces(
    body, [](const glm::dvec3& point) { return point.z > 1.0 - 1e-9; }, glm::dvec3(0, 0, 1e-3));
  const EquilibriumReport report = model.Solve(request);
  EXPECT_TRUE(report.IsConverged);
  EXPECT_EQ(report.NumberOfFrozenPieces, 0);
  const std::vector<glm::dvec3> wanted = MapPoints(
    body, glm::dmat3(1 - 0.45e-7, 0, 0, 0, 1 - 0.45e-7, 0, 0, 0, 1 + 1e-7), glm::dvec3(0.0));
  EXPECT_LT(LargestDifference(model.GetDisplacements(), wanted), 1e-7 * 1e-5);
  // Reactions of planes act along their normals only, and balance the load.
  glm::dvec3 sum(0.0);
  double friction = 0.0;
  const std::vector<glm::dvec3> forces = model.GetForces();
  for (std::size_t node = 0; node < forces.size(); ++node)
  {
    const glm::dvec3 reaction = forces[node] - request.Loads.Forces[node];
    sum += reaction;
    for (int axis = 0; axis < 3; ++axis)
    {
      friction =
        body.Points[node][axis] != 0.0 ? std::max(friction, std::abs(reaction[axis])) : friction;
    }
  }
  EXPECT_LT(friction, 1e-9);
  EXPECT_LT(LargestOf(sum - glm::dvec3(0, 0, -1e-3)), 1e-9);
}

// Normals that were computed from rounded coordinates prevent no further motions. Few nodes beside
// many prevent them, and so does the short side of a slender body.
TEST(ElementConditions, RoundedNormalsAndSlenderBodies)
{
  const auto holds = [](const ElasticBody& body)
  {
    FiniteElementModel model;
    model.SetBody(body);
    return GetError([&] { model.Solve({}); }).find("No constraints") == std::string::npos;
  };
  std::mt19937 random(1);
  for (const double noise : { 1e-16, 1e-8, 1e-7, 1e-5, 1e-4 })
  {
    SCOPED_TRACE(noise);
    std::uniform_real_distribution<double> any(-3.0 * noise, 3.0 * noise);
    for (const int planes : { 2, 3 })
    {
      QuadraticLattice cube = MakeCube();
      for (int axis = 0; axis < planes; ++axis)
      {
        SlideFace(cube.Body, axis);
      }
      for (auto* normals : { &cube.Body.SlidingNormals, &cube.Body.SecondSlidingNormals })
      {
        for (glm::dvec3& normal : *normals)
        {
          normal +=
            normal == glm::dvec3(0.0) ? normal : glm::dvec3(any(random), any(random), any(random));
        }
      }
      EXPECT_EQ(holds(cube.Body), planes == 3);
    }
  }
  // A quarter of a rod that is a hundred times as long as thick. Its third plane, or a single node,
  // holds it along its length.
  QuadraticLattice rod({ 2, 2, 201 }, 0.01, MakeMaterial(1e4, 0.3));
  rod.Body.Fixed.assign(rod.Body.Points.size(), 0);
  SlideFace(rod.Body, 0);
  SlideFace(rod.Body, 1);
  EXPECT_FALSE(holds(rod.Body));
  ElasticBody pinned = rod.Body;
  const auto end = static_cast<std::size_t>(rod.GetNode({ 0, 0, 100 }));
  pinned.SlidingNormals[end] = pinned.SecondSlidingNormals[end] = glm::dvec3(0.0);
  pinned.Fixed[end] = 1;
  EXPECT_TRUE(holds(pinned));
  SlideFace(rod.Body, 2);
  EXPECT_TRUE(holds(rod.Body));
}

// The length of normals does not matter.
TEST(ElementConditions, NormalsOfAnyLength)
{
  QuadraticLattice cube = MakeCube();
  for (int axis = 0; axis < 3; ++axis)
  {
    SlideFace(cube.Body, axis);
  }
  EquilibriumRequest request = MakeConverged();
  request.Loads.Gravity = glm::dvec3(-1.0, -2.0, -3.0);
  FiniteElementModel model;
  model.SetBody(cube.Body);
  EXPECT_TRUE(model.Solve(request).IsConverged);
  const std::vector<glm::dvec3> wanted = model.GetDisplacements();
  EXPECT_GT(LargestOf(wanted), 0.01);
  // The squares of these lengths underflow to 0, or overflow.
  for (const double length : { std::numeric_limits<double>::denorm_min(), 1e-200, -1e200, 1e308 })
  {
    SCOPED_TRACE(length);
    ElasticBody body = cube.Body;
    for (auto* normals : { &body.SlidingNormals, &body.SecondSlidingNormals })
    {
      for (glm::dvec3& normal : *normals)
      {
        normal = glm::sign(normal) * length;
      }
    }
    model.SetBody(body);
    EXPECT_EQ(GetError([&] { EXPECT_TRUE(model.Solve(request).IsConverged); }), "");
    EXPECT_LT(LargestDifference(model.GetDisplacements(), wanted), 1e-12);
  }
}

// Two planes that are parallel up to the rounding of coordinates count as one.
TEST(ElementConditions, NearlyParallelPlanes)
{
  QuadraticLattice cube = MakeCube([](const Place& place) { return place[2] == 0; });
  ElasticBody& body = cube.Body;
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    const bool slides = body.Points[node].x == 0.0 && !body.IsFixed(node);
    body.SlidingNormals.push_back(glm::dvec3(slides, 0.0, 0.0));
  }
  EquilibriumRequest request = MakeConverged();
  request.Loads.Gravity = glm::dvec3(0.0, 0.4, 0.0);
  FiniteElementModel model;
  model.SetBody(body);
  EXPECT_TRUE(model.Solve(request).IsConverged);
  const std::vector<glm::dvec3> wanted = model.GetDisplacements();
  for (const glm::dvec3& normal : body.SlidingNormals)
  {
    body.SecondSlidingNormals.push_back(normal + glm::dvec3(0.0, 1e-5 * normal.x, 0.0));
  }
  model.SetBody(body);
  EXPECT_TRUE(model.Solve(request).IsConverged);
  EXPECT_LT(LargestDifference(model.GetDisplacements(), wanted), 1e-12);
}

// Nodes that have left a plane before they slide in it return to it.
TEST(ElementConditions, PlanesAddedLater)
{
  const auto isFixed = [](const Place& place) { return place[2] == 0; };
  QuadraticLattice cube = MakeCube(isFixed);
  EquilibriumRequest request = MakeConverged();
  request.Loads.Gravity = glm::dvec3(0.4, 0.0, -0.4);
  FiniteElementModel model;
  model.SetBody(cube.Body);
  EXPECT_TRUE(model.Solve(request).IsConverged);
  const std::vector<glm::dvec3> without = model.GetDisplacements();
  ElasticBody body = cube.Body;
  SlideFace(body, 0);
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    body.SlidingNormals[node] *= body.IsFixed(node) ? 0.0 : 1.0;
  }
  model.SetBody(body);
  EXPECT_TRUE(model.Solve(request).IsConverged);
  const std::vector<glm::dvec3> wanted = model.GetDisplacements();
  EXPECT_GT(LargestDifference(wanted, without), 0.005);
  model.SetDisplacements(without);
  EXPECT_TRUE(model.Solve(request).IsConverged);
  EXPECT_LT(LargestDifference(model.GetDisplacements(), wanted), 1e-5);
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    EXPECT_LT(std::abs(glm::dot(model.GetDisplacements()[node], body.SlidingNormals[node])), 1e-12);
  }
}

// An oblique plane at large strain. Nodes stay in the plane, a handle moves them within it, and
// forces act only along the normal. Bodies with and without a multigrid hierarchy, which ignores
// planes.
TEST(ElementConditions, NodesSlideInAnObliquePlane)
{
  for (const std::int32_t cells : { 2, 6 })
  {
    const double spacing = 1.0 / cells;
    QuadraticLattice cube({ cells + 1, cells + 1, cells + 1 }, spacing, MakeMaterial(1e4, 0.3),
      [&](const Place& place) { return place[2] == cells; });
    ElasticBody& body = cube.Body;
    const glm::dmat3 turn = MakeRotation(0.6, { 1.0, 0.4, 0.2 });
    const glm::dvec3 normal = turn[2];
    body.SlidingNormals.assign(body.Points.size(), glm::dvec3(0.0));
    std::int32_t handle = -1;
    for (std::size_t node = 0; node < body.Points.size(); ++node)
    {
      glm::dvec3& point = body.Points[node];
      body.SlidingNormals[node] = point.z == 0.0 ? normal : glm::dvec3(0.0);
      handle = point == glm::dvec3(0.0) ? static_cast<std::int32_t>(node) : handle;
      point = turn * point;
    }
    EquilibriumRequest request = MakeConverged();
    const glm::dvec3 pull = turn * glm::dvec3(-0.1, 0.05, 0.3);
    request.Held = { { handle, pull } };
    request.Loads.Gravity = turn * glm::dvec3(0.5, 0.0, 0.0);
    FiniteElementModel model;
    model.SetBody(body);
    EXPECT_TRUE(model.Solve(request).IsConverged);
    const std::vector<glm::dvec3>& displacements = model.GetDisplacements();
    const std::vector<glm::dvec3> forces = model.GetForces();
    const glm::dvec3 within = pull - glm::dot(pull, normal) * normal;
    EXPECT_LT(LargestOf(displacements[static_cast<std::size_t>(handle)] - within), 1e-12);
    double largest = 0.0;
    for (std::size_t node = 0; node < forces.size(); ++node)
    {
      if (body.SlidingNormals[node] == glm::dvec3(0.0))
      {
        continue;
      }
      EXPECT_NEAR(glm::dot(displacements[node], normal), 0.0, 1e-12);
      largest = std::max(largest, glm::length(displacements[node]));
    }
    EXPECT_GT(largest, 0.09);
  }
}

// A body of two pieces. Planes hold one of them, and nothing holds the other.
TEST(ElementConditions, PiecesThatSlide)
{
  QuadraticLattice cube = MakeCube();
  ElasticBody body = cube.Body;
  for (int axis = 0; axis < 3; ++axis)
  {
    SlideFace(body, axis);
  }
  const std::size_t nodes = cube.Body.Points.size();
  for (const glm::dvec3& point : cube.Body.Points)
  {
    body.Points.push_back(point + glm::dvec3(2.0, 0.0, 0.0));
    body.SlidingNormals.push_back(glm::dvec3(0.0, 0.0, point.z == 0.0 ? 1.0 : 0.0));
    body.SecondSlidingNormals.push_back(glm::dvec3(0.0));
  }
  const std::size_t tetrahedra = cube.Body.Tetrahedra.size();
  const auto add = [&](auto all)
  {
    for (std::int32_t& node : all)
    {
      node += static_cast<std::int32_t>(nodes);
    }
    return all;
  };
  for (std::size_t t = 0; t < tetrahedra; ++t)
  {
    body.Tetrahedra.push_back(add(cube.Body.Tetrahedra[t]));
    body.MidSides.push_back(add(cube.Body.MidSides[t]));
  }
  FiniteElementModel model;
  model.SetBody(body);
  EquilibriumRequest request = MakeConverged();
  request.Loads.Gravity = glm::dvec3(0.0, 0.0, -1.0);
  const EquilibriumReport report = model.Solve(request);
  EXPECT_TRUE(report.IsConverged);
  EXPECT_EQ(report.NumberOfFrozenPieces, 1);
  EXPECT_EQ(report.FrozenNodes, body.Tetrahedra[tetrahedra]);
  EXPECT_GT(LargestOf(model.GetDisplacements()), 0.01);
}
