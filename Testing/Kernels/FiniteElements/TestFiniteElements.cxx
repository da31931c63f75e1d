// SPDX-License-Identifier: BSD-3-Clause
// Finite elements: misuse, aborts, frozen pieces, sequences of frames, and inverted tetrahedra.
#include "FiniteElementCase.h"
#include "FiniteElements.h"
#include "Measured.h"
#include "ParallelFor.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <random>
#include <utility>

using namespace deformvolume;

namespace
{

using Place = LatticeBody::Place;

// A block of linear tetrahedra that is fixed at one end. nodes: number of nodes on each axis.
LatticeBody MakeLinearBlock(const Place& nodes, double poissonRatio = 0.3)
{
  LatticeBody lattice(nodes, 0.01, MakeMaterial(1e4, poissonRatio));
  lattice.Fix([](const Place& place) { return place[2] == 0; });
  return lattice;
}

// The same block with mid-side nodes.
LatticeBody MakeBlock(const Place& nodes, double poissonRatio = 0.3)
{
  LatticeBody lattice = MakeLinearBlock(nodes, poissonRatio);
  AddMidSideNodes(lattice.Body);
  return lattice;
}

// Returns handles at the other end.
std::vector<HeldNode> PullEnd(const LatticeBody& lattice, const glm::dvec3& displacement)
{
  const double end = lattice.Spacing * (lattice.Nodes[2] - 1);
  const double width = 1.001 * lattice.Spacing;
  std::vector<HeldNode> held;
  for (const std::int32_t node : FindNodes(lattice.Body,
         [&](const glm::dvec3& point)
         { return point.z > end - 1e-9 && point.x < width && point.y < width; }))
  {
    held.push_back({ node, displacement });
  }
  return held;
}

// Two separate blocks of 3 x 3 x 3 nodes. The first block is held.
LatticeBody MakeTwoPieces()
{
  LatticeBody lattice = MakeLinearBlock({ 3, 3, 3 });
  ElasticBody& body = lattice.Body;
  const std::size_t nodes = body.Points.size();
  const std::size_t tetrahedra = body.Tetrahedra.size();
  for (std::size_t node = 0; node < nodes; ++node)
  {
    body.Points.push_back(body.Points[node] + glm::dvec3(1.0, 0.0, 0.0));
    body.Fixed.push_back(0);
  }
  for (std::size_t t = 0; t < tetrahedra; ++t)
  {
    Tetrahedron tetrahedron = body.Tetrahedra[t];
    for (std::int32_t& node : tetrahedron)
    {
      node += static_cast<std::int32_t>(nodes);
    }
    body.Tetrahedra.push_back(tetrahedron);
  }
  AddMidSideNodes(body);
  return lattice;
}

} // namespace

TEST(FiniteElements, Misuse)
{
  FiniteElementModel model;
  EXPECT_EQ(GetError([&] { model.Solve({}); }), "There is no body. Call SetBody first.");
  EXPECT_EQ(GetError([&] { model.Reset(); }), "There is no body. Call SetBody first.");
  EXPECT_EQ(GetError([&] { model.SetBody({}); }),
    "The mesh at rest has no tetrahedra, or all of them are hidden.");
  EXPECT_EQ(GetError(
              [&] {
                model.SetBody(MakeLinearBlock({ 3, 3, 3 }).Body);
              }),
    "The tetrahedra of the body have no mid-side nodes. Call AddMidSideNodes first.");
  const LatticeBody lattice = MakeBlock({ 3, 3, 3 });
  const auto nodes = static_cast<std::int32_t>(lattice.Body.Points.size());
  const std::string needed = std::to_string(nodes) + " are needed";
  ElasticBody bad = lattice.Body;
  bad.Materials[0].PoissonRatio = 0.495;
  EXPECT_NE(GetError([&] { model.SetBody(bad); }).find("Poisson"), std::string::npos);
  ElasticBody loose = lattice.Body;
  loose.Fixed.clear();
  model.SetBody(loose);
  EXPECT_NE(GetError([&] { model.Solve({}); }).find("No constraints"), std::string::npos);
  // Two nodes, or three nodes on a line, do not hold the body either.
  for (const int number : { 1, 2, 3 })
  {
    EquilibriumRequest request;
    for (int i = 0; i < number; ++i)
    {
      request.Held.push_back({ i, glm::dvec3(0.0) });
    }
    EXPECT_NE(GetError([&] { model.Solve(request); }).find("No constraints"), std::string::npos);
  }
  model.SetBody(lattice.Body);
  EquilibriumRequest request;
  request.Held = { { 26, glm::dvec3(NoNumber, 0.0, 0.0) } };
  EXPECT_EQ(GetError([&] { model.Solve(request); }),
    "The displacement of the handle that holds node 26 is not finite.");
  request.Held = { { nodes, glm::dvec3(0.0) } };
  EXPECT_NE(GetError([&] { model.Solve(request); }).find(std::to_string(nodes)), std::string::npos);
  request.Held = { { 0, glm::dvec3(0.0) } };
  EXPECT_NE(GetError([&] { model.Solve(request); }).find("fixed"), std::string::npos);
  request.Held.clear();
  request.Loads.Gravity.y = NoNumber;
  EXPECT_EQ(GetError([&] { model.Solve(request); }), "The gravity is not finite.");
  request.Loads = {};
  request.Loads.Forces.resize(3);
  EXPECT_NE(GetError([&] { model.Solve(request); }).find(needed), std::string::npos);
  request.Loads = {};
  request.Limits.LinearTolerance = -1.0;
  EXPECT_NE(GetError([&] { model.Solve(request); }).find("limit"), std::string::npos);
  EXPECT_NE(GetError([&] { model.SetMaterials({}); }).find("materials"), std::string::npos);
  EXPECT_NE(GetError([&] { model.SetDisplacements({}); }).find(needed), std::string::npos);
  std::vector<glm::dvec3> displacements(lattice.Body.Points.size(), glm::dvec3(0.0));
  displacements[5].z = NoNumber;
  EXPECT_EQ(GetError([&] { model.SetDisplacements(displacements); }),
    "The displacement of node 5 is not finite.");
  EXPECT_EQ(LargestOf(model.GetDisplacements()), 0.0);
}

TEST(FiniteElements, UnloadedBodyStaysAtRest)
{
  const LatticeBody lattice = MakeBlock({ 3, 3, 3 });
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  const EquilibriumReport report = model.Solve({});
  EXPECT_TRUE(report.IsConverged);
  EXPECT_EQ(report.NewtonSteps, 0);
  EXPECT_EQ(report.NumberOfFrozenPieces, 0);
  EXPECT_EQ(LargestOf(model.GetDisplacements()), 0.0);
}

TEST(FiniteElements, FrozenPiece)
{
  const LatticeBody lattice = MakeTwoPieces();
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  std::vector<glm::dvec3> displacements(lattice.Body.Points.size(), glm::dvec3(0.0));
  const std::vector<std::int32_t> second =
    FindNodes(lattice.Body, [](const glm::dvec3& point) { return point.x > 0.5; });
  for (const std::int32_t node : second)
  {
    const glm::dvec3& point = lattice.Body.Points[static_cast<std::size_t>(node)];
    displacements[static_cast<std::size_t>(node)] = glm::dvec3(0.03, point.z, 0.0);
  }
  model.SetDisplacements(displacements);
  EquilibriumRequest request = MakeConverged();
  request.Loads.Gravity = glm::dvec3(0.0, -1.0, 0.0);
  const EquilibriumReport report = model.Solve(request);
  EXPECT_TRUE(report.IsConverged);
  EXPECT_EQ(report.NumberOfFrozenPieces, 1);
  EXPECT_LT(model.GetDisplacements()[26].y, 0.0);
  // The second piece has its shape at rest, turned and moved as its nodes were on average.
  const glm::dmat3 turn = MakeRotation(-std::atan(0.5), { 1.0, 0.0, 0.0 });
  const glm::dvec3 center(1.01, 0.01, 0.01);
  const std::vector<glm::dvec3> rigid = model.GetDisplacements();
  for (const std::int32_t number : second)
  {
    const auto node = static_cast<std::size_t>(number);
    const glm::dvec3 point = lattice.Body.Points[node];
    const glm::dvec3 moved = turn * (point - center) + center + glm::dvec3(0.03, 0.01, 0.0);
    EXPECT_LT(LargestOf(point + rigid[node] - moved), 1e-12);
  }
  model.SetDisplacements(rigid);
  model.Solve(request);
  for (const std::int32_t node : second)
  {
    EXPECT_EQ(model.GetDisplacements()[static_cast<std::size_t>(node)],
      rigid[static_cast<std::size_t>(node)]);
  }
  // With three held nodes, the second piece is held as well.
  for (const std::int32_t node : { 27, 28, 30 })
  {
    request.Held.push_back({ node, glm::dvec3(0.0) });
  }
  EXPECT_EQ(model.Solve(request).NumberOfFrozenPieces, 0);
  EXPECT_LT(LargestOf(model.GetDisplacements()), 0.01);
}

namespace
{

// Checks that the edges of a tetrahedron have their rest lengths: it moves like a rigid body.
void ExpectRigid(const FiniteElementModel& model, const ElasticBody& body, std::size_t tetrahedron)
{
  const Tetrahedron& nodes = body.Tetrahedra[tetrahedron];
  for (std::size_t i = 0; i < 4; ++i)
  {
    for (std::size_t j = 0; j < i; ++j)
    {
      const auto a = static_cast<std::size_t>(nodes[i]);
      const auto b = static_cast<std::size_t>(nodes[j]);
      const glm::dvec3 edge = body.Points[a] - body.Points[b];
      const glm::dvec3 now = edge + model.GetDisplacements()[a] - model.GetDisplacements()[b];
      EXPECT_NEAR(glm::length(now), glm::length(edge), 1e-12);
    }
  }
}

// Adds a tetrahedron with some nodes of a body, and with new nodes beyond its end on z.
void AttachTetrahedron(LatticeBody& lattice, const std::vector<std::int32_t>& nodes)
{
  ElasticBody& body = lattice.Body;
  Tetrahedron tetrahedron;
  std::copy(nodes.begin(), nodes.end(), tetrahedron.begin());
  const glm::dvec3 origin = body.Points[static_cast<std::size_t>(nodes[0])];
  const glm::dvec3 places[] = { { 0.002, -0.003, 0.011 }, { -0.004, 0.009, 0.008 },
    { 0.009, 0.004, 0.009 } };
  for (std::size_t i = nodes.size(); i < 4; ++i)
  {
    tetrahedron[i] = static_cast<std::int32_t>(body.Points.size());
    body.Points.push_back(origin + places[i - 1]);
    body.Fixed.push_back(0);
  }
  const auto point = [&](std::size_t i)
  { return body.Points[static_cast<std::size_t>(tetrahedron[i])]; };
  if (glm::dot(glm::cross(point(1) - point(0), point(2) - point(0)), point(3) - point(0)) < 0.0)
  {
    std::swap(tetrahedron[2], tetrahedron[3]);
  }
  body.Tetrahedra.push_back(tetrahedron);
}

} // namespace

// A tetrahedron that shares only a node or an edge with a body. The body bends as without the
// tetrahedron, which follows its motion. Another tetrahedron that shares nodes with the first one
// follows, too.
TEST(FiniteElements, PiecesOnANodeOrAnEdge)
{
  const LatticeBody alone = MakeLinearBlock({ 3, 3, 5 });
  FiniteElementModel model;
  model.SetBody(MakeBlock({ 3, 3, 5 }).Body);
  EquilibriumRequest request = MakeConverged();
  request.Held = PullEnd(alone, glm::dvec3(0.003, -0.002, 0.001));
  model.Solve(request);
  const std::size_t nodes = alone.Body.Points.size();
  const auto corner = static_cast<std::int32_t>(nodes - 1);
  for (const std::vector<std::int32_t>& shared :
    { std::vector<std::int32_t>{ corner }, { corner - 1, corner } })
  {
    SCOPED_TRACE(shared.size());
    LatticeBody lattice = alone;
    AttachTetrahedron(lattice, shared);
    AttachTetrahedron(lattice, { static_cast<std::int32_t>(nodes) });
    AddMidSideNodes(lattice.Body);
    const std::size_t first = alone.Body.Tetrahedra.size();
    FiniteElementModel other;
    other.SetBody(lattice.Body);
    const EquilibriumReport report = other.Solve(request);
    EXPECT_TRUE(report.IsConverged);
    EXPECT_EQ(report.NumberOfFrozenPieces, 2);
    EXPECT_EQ(report.NumberOfFollowingPieces, 2);
    EXPECT_EQ(report.FrozenNodes, lattice.Body.Tetrahedra[first]);
    EXPECT_EQ(report.NumberOfInvertedTetrahedra, 0);
    for (std::size_t node = 0; node < nodes; ++node)
    {
      EXPECT_NEAR(
        glm::length(other.GetDisplacements()[node] - model.GetDisplacements()[node]), 0.0, 1e-8);
    }
    EXPECT_GT(glm::length(other.GetDisplacements()[nodes]), 0.001);
    if (shared.size() == 1)
    {
      ExpectRigid(other, lattice.Body, first);
    }
    ExpectRigid(other, lattice.Body, first + 1);
    // Also with loads, and in interactive mode.
    request.Loads.Gravity = glm::dvec3(0.0, -9.81, 0.0);
    EXPECT_TRUE(other.Solve(request).IsConverged);
    request.Mode = EquilibriumMode::Interactive;
    other.Solve(request);
    EXPECT_LT(LargestOf(other.GetDisplacements()), 0.01);
    request.Loads.Gravity = glm::dvec3(0.0);
    request.Mode = EquilibriumMode::Converged;
  }
}

// Two blocks with a common edge: a hinge. With a handle on it, the second block rotates without
// forces. Without the handle it keeps its shape.
TEST(FiniteElements, HingeWithAHandle)
{
  LatticeBody lattice = MakeLinearBlock({ 3, 3, 3 });
  ElasticBody& body = lattice.Body;
  const std::size_t nodes = body.Points.size();
  const std::size_t tetrahedra = body.Tetrahedra.size();
  std::vector<std::int32_t> copies;
  const glm::dvec3 size = body.Points.back() - body.Points.front();
  for (std::size_t node = 0; node < nodes; ++node)
  {
    const glm::dvec3 place = body.Points[node] + glm::dvec3(0.0, size.y, size.z);
    std::size_t copy = 0;
    while (copy < body.Points.size() && glm::length(body.Points[copy] - place) > 1e-9)
    {
      ++copy;
    }
    copies.push_back(static_cast<std::int32_t>(copy));
    if (copy == body.Points.size())
    {
      body.Points.push_back(place);
      body.Fixed.push_back(0);
    }
  }
  EXPECT_EQ(body.Points.size(), 2 * nodes - 3);
  for (std::size_t t = 0; t < tetrahedra; ++t)
  {
    Tetrahedron tetrahedron = body.Tetrahedra[t];
    for (std::int32_t& node : tetrahedron)
    {
      node = copies[static_cast<std::size_t>(node)];
    }
    body.Tetrahedra.push_back(tetrahedron);
  }
  const auto held = static_cast<std::int32_t>(body.Points.size() - 1);
  AddMidSideNodes(body);
  FiniteElementModel model;
  model.SetBody(body);
  EquilibriumRequest request = MakeConverged();
  request.Loads.Gravity = glm::dvec3(0.0, -9.81, 0.0);
  EquilibriumReport report = model.Solve(request);
  EXPECT_TRUE(report.IsConverged);
  EXPECT_EQ(report.NumberOfFrozenPieces, 1);
  EXPECT_EQ(report.NumberOfFollowingPieces, 1);
  EXPECT_LT(LargestOf(model.GetDisplacements()), 0.01);
  // Mid-side nodes lie beside the line of a hinge because of the rounding of floats.
  ElasticBody rounded = body;
  const glm::dvec3 line = body.Points[nodes - 1];
  for (glm::dvec3& point : rounded.Points)
  {
    const bool isInMiddle = std::abs(point.y - line.y) + std::abs(point.z - line.z) < 1e-9 &&
      std::abs(std::remainder(point.x, size.x / 2.0)) > 1e-9;
    point.y += isInMiddle ? 5e-5 * size.x : 0.0;
  }
  EXPECT_NE(rounded.Points, body.Points);
  model.SetBody(rounded);
  report = model.Solve(request);
  EXPECT_EQ(report.NumberOfFrozenPieces, 1);
  EXPECT_EQ(report.NumberOfFollowingPieces, 1);
  EXPECT_LT(LargestOf(model.GetDisplacements()), 0.01);
  model.SetBody(body);

  // The line of the hinge hardly moves, and the far edge rotates about it.
  request.Loads.Gravity = glm::dvec3(0.0);
  model.Reset();
  const glm::dvec3 hinge = body.Points[nodes - 1];
  const glm::dvec3 arm = body.Points[static_cast<std::size_t>(held)] - hinge;
  const glm::dmat3 turn = MakeRotation(0.1, glm::dvec3(1.0, 0.0, 0.0));
  request.Held.push_back({ held, turn * arm - arm });
  report = model.Solve(request);
  EXPECT_TRUE(report.IsConverged);
  EXPECT_EQ(report.NumberOfFrozenPieces, 0);
  const glm::dvec3 other =
    body.Points[static_cast<std::size_t>(held) - 2] - hinge; // on the same edge
  EXPECT_NEAR(glm::length(model.GetDisplacements()[static_cast<std::size_t>(held) - 2] -
                (turn * other - other)),
    0.0, 1e-5);
  EXPECT_LT(report.StrainEnergy, 1e-9);
}

// A bone in air of 100 Pa, and in brain: single precision cannot represent both stiffnesses.
TEST(FiniteElements, BoneInSoftTissue)
{
  for (const auto& [tissue, last] :
    { std::pair(MakeMaterial(100.0, 0.0), 12), std::pair(MakeMaterial(1600.0, 0.49), 8) })
  {
    QuadraticLattice cube({ last + 1, last + 1, last + 1 }, 0.04 / last, tissue,
      [](const Place& place) { return place[2] == 0; });
    cube.Body.Materials.assign(cube.Body.Tetrahedra.size(), tissue);
    const glm::dvec3 middle(0.02);
    for (std::size_t t = 0; t < cube.Body.Tetrahedra.size(); ++t)
    {
      glm::dvec3 center(0.0);
      for (const std::int32_t node : cube.Body.Tetrahedra[t])
      {
        center += 0.25 * cube.Body.Points[static_cast<std::size_t>(node)];
      }
      cube.Body.Materials[t].YoungModulus =
        LargestOf(center - middle) < 0.01 ? 18.6e9 : tissue.YoungModulus;
    }
    FiniteElementModel model;
    model.SetBody(cube.Body);
    EquilibriumRequest request = MakeConverged();
    for (const Place& corner :
      { Place{ 0, 0, last }, Place{ last, 0, last }, Place{ 0, last, last } })
    {
      request.Held.push_back({ cube.GetNode(corner), glm::dvec3(1e-6, 0.0, 0.0) });
    }
    const EquilibriumReport report = model.Solve(request);
    EXPECT_TRUE(report.IsConverged);
    EXPECT_LE(report.RelativeResidual, 1e-6);
    RecordMeasured("iterations", report.LinearIterations);
    EXPECT_LT(report.LinearIterations, 1500);
    // Far from rest, the rounding errors of bone are greater than a millionth of these forces.
    cube.Body.Fixed.clear();
    model.SetBody(cube.Body);
    for (const std::int32_t node :
      FindNodes(cube.Body, [](const glm::dvec3& point) { return point.z == 0.0; }))
    {
      request.Held.push_back({ node, glm::dvec3(0.0) });
    }
    for (HeldNode& held : request.Held)
    {
      held.Displacement.x += 0.1;
    }
    EXPECT_TRUE(model.Solve(request).IsConverged);
  }
}

// A rigid motion over a thousand edges, without loads, is an equilibrium up to rounding.
TEST(FiniteElements, FarTranslation)
{
  const QuadraticLattice cube({ 3, 3, 3 }, 1e-3, MakeMaterial(1e4, 0.49));
  FiniteElementModel model;
  model.SetBody(cube.Body);
  for (const EquilibriumMode mode : { EquilibriumMode::Converged, EquilibriumMode::Interactive })
  {
    EquilibriumRequest request;
    request.Mode = mode;
    for (const Place& corner : { Place{ 0, 0, 0 }, Place{ 2, 0, 0 }, Place{ 0, 2, 0 } })
    {
      request.Held.push_back({ cube.GetNode(corner), glm::dvec3(1.0, 0.3, -0.7) });
    }
    const EquilibriumReport report = model.Solve(request);
    EXPECT_TRUE(report.IsConverged) << report.Residual;
  }
}

// The body has more pieces than the coarsest level has aggregates. Each piece is held by the nodes
// of one side.
TEST(FiniteElements, MorePiecesThanAggregates)
{
  LatticeBody lattice = MakeLinearBlock({ 3, 3, 3 });
  ElasticBody body = lattice.Body;
  constexpr std::size_t pieces = 120;
  const std::size_t nodes = lattice.Body.Points.size();
  for (std::size_t piece = 1; piece < pieces; ++piece)
  {
    for (std::size_t node = 0; node < nodes; ++node)
    {
      body.Points.push_back(
        lattice.Body.Points[node] + glm::dvec3(static_cast<double>(piece), 0.0, 0.0));
      body.Fixed.push_back(lattice.Body.Fixed[node]);
    }
    for (Tetrahedron tetrahedron : lattice.Body.Tetrahedra)
    {
      for (std::int32_t& node : tetrahedron)
      {
        node += static_cast<std::int32_t>(piece * nodes);
      }
      body.Tetrahedra.push_back(tetrahedron);
    }
  }
  EquilibriumRequest request = MakeConverged();
  request.Loads.Gravity = glm::dvec3(0.0, -1.0, 0.0);
  FiniteElementModel model;
  const std::size_t corners = body.Points.size();
  AddMidSideNodes(body);
  model.SetBody(body);
  EXPECT_TRUE(model.Solve(request).IsConverged);
  FiniteElementModel single;
  AddMidSideNodes(lattice.Body);
  single.SetBody(lattice.Body);
  EXPECT_TRUE(single.Solve(request).IsConverged);
  for (std::size_t node = 0; node < corners; ++node)
  {
    EXPECT_LT(
      LargestOf(model.GetDisplacements()[node] - single.GetDisplacements()[node % nodes]), 1e-8);
  }
}

// Free nodes that are not connected to other free nodes: each aggregate is a single node, which has
// no rotations.
TEST(FiniteElements, UnconnectedFreeNodes)
{
  ElasticBody body;
  constexpr int pieces = 1100;
  for (std::int32_t piece = 0; piece < pieces; ++piece)
  {
    const glm::dvec3 origin(0.1 * piece, 0.0, 0.0);
    for (const glm::dvec3& corner : { glm::dvec3(0.0), glm::dvec3(0.01, 0.0, 0.0),
           glm::dvec3(0.0, 0.01, 0.0), glm::dvec3(0.0, 0.0, 0.01) })
    {
      body.Points.push_back(origin + corner);
      body.Fixed.push_back(corner.z > 0.0 ? 0 : 1);
    }
    body.Tetrahedra.push_back({ 4 * piece, 4 * piece + 1, 4 * piece + 2, 4 * piece + 3 });
  }
  EquilibriumRequest request = MakeConverged();
  request.Loads.Gravity = glm::dvec3(0.0, -10.0, 0.0);
  ElasticBody one = body;
  one.Points.resize(4);
  one.Fixed.resize(4);
  one.Tetrahedra.resize(1);
  FiniteElementModel model;
  // Fixes the mid-side nodes.
  const auto addMidSides = [](ElasticBody& target)
  {
    AddMidSideNodes(target);
    std::fill(target.Fixed.begin() + static_cast<std::ptrdiff_t>(4 * target.Tetrahedra.size()),
      target.Fixed.end(), static_cast<unsigned char>(1));
  };
  addMidSides(body);
  model.SetBody(body);
  EXPECT_TRUE(model.Solve(request).IsConverged);
  FiniteElementModel single;
  addMidSides(one);
  single.SetBody(one);
  EXPECT_TRUE(single.Solve(request).IsConverged);
  // A corner gets -1/20 of a weight, so it moves up.
  EXPECT_GT(single.GetDisplacements()[3].y, 0.0);
  for (std::size_t piece = 0; piece < pieces; ++piece)
  {
    EXPECT_LT(LargestOf(model.GetDisplacements()[4 * piece + 3] - single.GetDisplacements()[3]),
      1e-6 * LargestOf(single.GetDisplacements()[3]));
  }
}

TEST(FiniteElements, DivergenceKeepsTheDisplacements)
{
  const LatticeBody lattice = MakeBlock({ 4, 4, 4 });
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  EquilibriumRequest request;
  request.Held = PullEnd(lattice, glm::dvec3(0.005, 0.0, 0.0));
  model.Solve(request);
  const std::vector<glm::dvec3> before = model.GetDisplacements();
  request.Held = PullEnd(lattice, glm::dvec3(1e200, 0.0, 0.0));
  EXPECT_NE(GetError([&] { model.Solve(request); }).find("not a number"), std::string::npos);
  EXPECT_EQ(model.GetDisplacements(), before);
  // The next solution equals that of a body that starts from the same displacements.
  FiniteElementModel other;
  other.SetBody(lattice.Body);
  other.SetDisplacements(before);
  request.Held = PullEnd(lattice, glm::dvec3(0.006, 0.0, 0.0));
  const EquilibriumReport report = model.Solve(request);
  const EquilibriumReport wanted = other.Solve(request);
  EXPECT_EQ(report.NewtonSteps, wanted.NewtonSteps);
  EXPECT_EQ(report.LinearIterations, wanted.LinearIterations);
  EXPECT_EQ(model.GetDisplacements(), other.GetDisplacements());
  EXPECT_TRUE(model.Solve(request).IsConverged);
}

TEST(FiniteElements, AbortKeepsTheDisplacements)
{
  const LatticeBody lattice = MakeBlock({ 8, 8, 16 });
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  EquilibriumRequest request = MakeConverged();
  request.Loads.Gravity = glm::dvec3(0.0, -0.5, 0.0);
  for (const int allowed : { 0, 1, 3, 10 })
  {
    int calls = 0;
    request.Progress = [&] { return calls++ < allowed; };
    EXPECT_THROW(model.Solve(request), Aborted);
    EXPECT_EQ(LargestOf(model.GetDisplacements()), 0.0);
  }
  // The callback is called every few milliseconds. The median is tested, as other processes may
  // interrupt the test.
  using Clock = std::chrono::steady_clock;
  std::vector<double> pauses;
  Clock::time_point last = Clock::now();
  request.Progress = [&]
  {
    const Clock::time_point now = Clock::now();
    pauses.push_back(std::chrono::duration<double>(now - last).count());
    last = now;
    return true;
  };
  request.Limits.NewtonSteps = 3;
  model.Solve(request);
  std::sort(pauses.begin(), pauses.end());
  EXPECT_GT(pauses.size(), 10u);
  EXPECT_LT(pauses[pauses.size() / 2], 0.05);
  request.Progress = nullptr;
  const std::vector<glm::dvec3> wanted = model.GetDisplacements();
  model.Reset();
  model.Solve(request);
  EXPECT_EQ(model.GetDisplacements(), wanted);
}

namespace
{

// Loops with a given number of threads, and a loop in reverse order.
template <int Threads>
void RunOnThreads(
  std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body)
{
  RunOnOwnThreads(first, last, grain, body, Threads);
}

void RunBackwards(
  std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body)
{
  const std::int64_t step = std::max<std::int64_t>(1, grain);
  for (std::int64_t end = last; end > first; end -= step)
  {
    body(std::max(first, end - step), end);
  }
}

std::vector<glm::dvec3> RunFrames(const LatticeBody& lattice, ParallelLoop loop)
{
  SetParallelLoop(loop);
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  EquilibriumRequest request;
  for (int frame = 1; frame <= 3; ++frame)
  {
    request.Held = PullEnd(lattice, glm::dvec3(0.002 * frame, 0.001 * frame, 0.0));
    request.Loads.Gravity = glm::dvec3(0.0, -frame, 0.0);
    model.Solve(request);
  }
  SetParallelLoop(nullptr);
  return model.GetDisplacements();
}

} // namespace

TEST(FiniteElements, ResultsDoNotDependOnThreads)
{
  // The second body is large enough for several levels.
  for (const Place& nodes : { Place{ 3, 3, 3 }, Place{ 6, 7, 8 } })
  {
    const LatticeBody lattice = MakeBlock(nodes, 0.45);
    const std::vector<glm::dvec3> wanted = RunFrames(lattice, RunOnThreads<1>);
    EXPECT_EQ(RunFrames(lattice, RunOnThreads<2>), wanted);
    EXPECT_EQ(RunFrames(lattice, RunOnThreads<3>), wanted);
    EXPECT_EQ(RunFrames(lattice, RunBackwards), wanted);
    EXPECT_EQ(RunFrames(lattice, nullptr), wanted);
  }
}

TEST(FiniteElements, FramesReachTheSolutionFromRest)
{
  for (const Place& nodes : { Place{ 3, 3, 5 }, Place{ 6, 6, 8 } })
  {
    const LatticeBody lattice = MakeBlock(nodes);
    const double length = 0.01 * (nodes[2] - 1);
    FiniteElementModel warm;
    warm.SetBody(lattice.Body);
    EquilibriumRequest request;
    for (int frame = 1; frame <= 20; ++frame)
    {
      request.Held = PullEnd(lattice, glm::dvec3(0.01 * length * frame, 0.0, 0.0));
      const EquilibriumReport report = warm.Solve(request);
      EXPECT_LT(report.RelativeResidual, 1e-2);
      EXPECT_LE(report.NewtonSteps, 2);
    }
    request.Mode = EquilibriumMode::Converged;
    FiniteElementModel cold;
    cold.SetBody(lattice.Body);
    EXPECT_TRUE(cold.Solve(request).IsConverged);
    // The frames leave a residual of a hundredth of the force.
    EXPECT_LT(LargestDifference(warm.GetDisplacements(), cold.GetDisplacements()), 2e-3 * length);
    EXPECT_TRUE(warm.Solve(request).IsConverged);
    EXPECT_LT(LargestDifference(warm.GetDisplacements(), cold.GetDisplacements()), 1e-5 * length);
  }
}

// A handle that rotates and jumps. Residuals of frames are within the reported tolerance, and
// frames without motion reduce them.
TEST(FiniteElements, JumpingHandleKeepsResidualsWithinTolerance)
{
  const Place nodes{ 6, 6, 8 };
  const LatticeBody lattice = MakeBlock(nodes, 0.45);
  const double length = 0.01 * (nodes[2] - 1);
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  EquilibriumRequest request;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> jump(-0.1 * length, 0.1 * length);
  glm::dvec3 place(0.0);
  for (int frame = 0; frame < 30; ++frame)
  {
    SCOPED_TRACE(frame);
    const bool jumps = frame % 5 == 4;
    place = jumps ? glm::dvec3(jump(random), jump(random), jump(random))
                  : place + 0.05 * glm::dvec3(jump(random), jump(random), jump(random));
    request.Held = PullEnd(lattice, place);
    EquilibriumReport report = model.Solve(request);
    EXPECT_EQ(report.IsConverged, report.RelativeResidual <= 1e-2);
    for (int rest = 0; rest < 4 && !(report.RelativeResidual <= 1e-3); ++rest)
    {
      report = model.Solve(request);
    }
    EXPECT_LE(report.RelativeResidual, 1e-3);
    EXPECT_TRUE(report.IsConverged);
  }
  const std::vector<glm::dvec3> frames = model.GetDisplacements();
  request.Mode = EquilibriumMode::Converged;
  EXPECT_TRUE(model.Solve(request).IsConverged);
  EXPECT_LT(LargestDifference(frames, model.GetDisplacements()), 1e-3 * length);
}

// If the body bends far, the tangent of the previous frame cannot be reused.
TEST(FiniteElements, BendingBodyConvergesInFewFrames)
{
  const LatticeBody lattice = MakeBlock({ 3, 3, 20 });
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  EquilibriumRequest request;
  request.Loads.Gravity = glm::dvec3(0.5, 0.0, 0.0);
  int frames = 0;
  while (++frames < 50 && !model.Solve(request).IsConverged)
  {
  }
  std::cout << frames << " frames\n";
  EXPECT_LE(frames, 10);
}

// Earlier motions of a handle predict its next motion, so few iterations are needed.
TEST(FiniteElements, MovingHandleNeedsFewIterations)
{
  const Place nodes{ 6, 6, 8 };
  const LatticeBody lattice = MakeBlock(nodes, 0.45);
  const double length = 0.01 * (nodes[2] - 1);
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  EquilibriumRequest request;
  int iterations = 0;
  for (int frame = 0; frame < 30; ++frame)
  {
    SCOPED_TRACE(frame);
    const double angle = 0.05 * frame;
    request.Held =
      PullEnd(lattice, 0.1 * length * glm::dvec3(std::sin(angle), 1.0 - std::cos(angle), 0.0));
    const EquilibriumReport report = model.Solve(request);
    EXPECT_LE(report.RelativeResidual, 1.2e-2);
    iterations += frame >= 10 ? report.LinearIterations : 0;
  }
  std::cout << iterations / 20.0 << " iterations a frame\n";
  EXPECT_LT(iterations / 20.0, 6.0);
}

TEST(FiniteElements, ChangedMaterialsEqualANewBody)
{
  LatticeBody lattice = MakeBlock({ 3, 3, 5 });
  EquilibriumRequest request = MakeConverged();
  request.Loads.Gravity = glm::dvec3(0.0, -1.0, 0.0);
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  model.Solve(request);
  // Make one half stiff. A new body with these materials has the same equilibrium.
  std::vector<ElasticMaterial> materials(lattice.Body.Tetrahedra.size(), MakeMaterial(1e4, 0.4));
  for (std::size_t t = 0; t < materials.size() / 2; ++t)
  {
    materials[t] = MakeMaterial(1e6, 0.2);
  }
  model.SetMaterials(materials);
  EXPECT_TRUE(model.Solve(request).IsConverged);
  lattice.Body.Materials = materials;
  FiniteElementModel other;
  other.SetBody(lattice.Body);
  EXPECT_TRUE(other.Solve(request).IsConverged);
  EXPECT_LT(LargestDifference(model.GetDisplacements(), other.GetDisplacements()), 1e-6);
}

namespace
{

// Moves the free nodes of a block at random, within 0.6 of its thickness.
void Scramble(const LatticeBody& lattice, std::uint32_t seed, FiniteElementModel& model)
{
  const double largest = 0.6 * lattice.Spacing * (lattice.Nodes[0] - 1);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-largest, largest);
  std::vector<glm::dvec3> displacements = model.GetDisplacements();
  for (std::size_t node = 0; node < displacements.size(); ++node)
  {
    if (lattice.Body.Fixed[node] == 0)
    {
      displacements[node] += glm::dvec3(noise(random), noise(random), noise(random));
    }
  }
  model.SetDisplacements(displacements);
}

std::int64_t CountInverted(const LatticeBody& lattice, const FiniteElementModel& model)
{
  AbortCheck abortCheck(nullptr);
  const std::vector<unsigned char> isInverted =
    FindInvertedSplits(abortCheck, lattice.Body, model.GetDisplacements());
  return std::count(isInverted.begin(), isInverted.end(), 1);
}

} // namespace

// Nearly all tetrahedra are inverted at a Gauss point.
TEST(FiniteElements, RandomPlacements)
{
  const LatticeBody lattice = MakeBlock({ 3, 3, 3 });
  std::int64_t fewestInverted = std::numeric_limits<std::int64_t>::max();
  int mostSteps = 0;
  double largestError = 0.0;
  for (std::uint32_t seed = 1; seed <= 100; ++seed)
  {
    SCOPED_TRACE(seed);
    FiniteElementModel model;
    model.SetBody(lattice.Body);
    Scramble(lattice, seed, model);
    fewestInverted = std::min(fewestInverted, CountInverted(lattice, model));
    const EquilibriumReport report = model.Solve(MakeConverged());
    const double error = LargestOf(model.GetDisplacements());
    mostSteps = std::max(mostSteps, report.NewtonSteps);
    largestError = std::max(largestError, error);
    EXPECT_TRUE(report.IsConverged);
    EXPECT_LE(report.NewtonSteps, 13);
    EXPECT_EQ(report.NumberOfInvertedTetrahedra, 0);
    EXPECT_LT(error, 1e-8 * 0.04);
  }
  std::cout << fewestInverted << " inverted, " << mostSteps << " steps\n";
  EXPECT_GT(fewestInverted, 30);
  RecordMeasured("fewest inverted", static_cast<double>(fewestInverted));
  RecordMeasured("most steps", mostSteps);
  RecordMeasured("error", largestError);
}

// The body returns to a bent equilibrium. Its end is rotated by 57 degrees.
TEST(FiniteElements, RandomPlacementsOfABentBody)
{
  const LatticeBody lattice = MakeBlock({ 3, 3, 5 });
  const glm::dmat3 rotation = MakeRotation(1.0, { 1.0, 0.0, 0.0 });
  const glm::dvec3 center(0.01, 0.01, 0.04);
  EquilibriumRequest request = MakeConverged();
  for (const std::int32_t node :
    FindNodes(lattice.Body, [](const glm::dvec3& point) { return point.z > 0.0399; }))
  {
    const glm::dvec3& point = lattice.Body.Points[static_cast<std::size_t>(node)];
    request.Held.push_back(
      { node, rotation * (point - center) + center + glm::dvec3(0.0, -0.0184, -0.0063) - point });
  }
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  const EquilibriumReport wanted = model.Solve(request);
  EXPECT_TRUE(wanted.IsConverged);
  EXPECT_EQ(wanted.NumberOfInvertedTetrahedra, 0);
  const std::vector<glm::dvec3> displacements = model.GetDisplacements();
  for (std::uint32_t seed = 1; seed <= 10; ++seed)
  {
    SCOPED_TRACE(seed);
    model.SetDisplacements(displacements);
    Scramble(lattice, seed, model);
    EXPECT_GT(CountInverted(lattice, model), 60);
    const EquilibriumReport report = model.Solve(request);
    EXPECT_TRUE(report.IsConverged);
    EXPECT_EQ(report.NumberOfInvertedTetrahedra, 0);
    EXPECT_NEAR(report.StrainEnergy, wanted.StrainEnergy, 1e-6 * wanted.StrainEnergy);
    EXPECT_LT(LargestDifference(model.GetDisplacements(), displacements), 1e-5);
  }
}

// A corner that was pushed through its neighbors stays inside the body without any load: this is an
// equilibrium. Only mode Converged looks for the one with less energy.
TEST(FiniteElements, DentIsRemoved)
{
  const LatticeBody lattice = MakeBlock({ 4, 4, 5 }, 0.45);
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  std::vector<glm::dvec3> displacements = model.GetDisplacements();
  const auto move = [&](const glm::dvec3& place, const glm::dvec3& displacement)
  {
    for (const std::int32_t node : FindNodes(lattice.Body,
           [&](const glm::dvec3& point) { return glm::length(point - 0.01 * place) < 1e-9; }))
    {
      displacements[static_cast<std::size_t>(node)] = displacement;
    }
  };
  move({ 3.0, 0.0, 4.0 }, { -4.5e-3, 9e-3, -4.5e-3 });
  move({ 3.0, 0.5, 4.0 }, { -3e-3, -2e-3, -3e-3 });
  move({ 2.5, 0.0, 4.0 }, { 0.0, 3.7e-3, 1e-3 });
  move({ 3.0, 0.0, 3.5 }, { 1e-3, 3.7e-3, 0.0 });
  model.SetDisplacements(displacements);
  EquilibriumRequest request;
  request.Limits.NewtonSteps = 100;
  request.Limits.RelativeTolerance = 1e-6;
  EquilibriumReport report = model.Solve(request);
  EXPECT_TRUE(report.IsConverged);
  EXPECT_EQ(report.NumberOfInvertedTetrahedra, 1);
  EXPECT_GT(LargestOf(model.GetDisplacements()), 5e-3);
  report = model.Solve(MakeConverged());
  EXPECT_TRUE(report.IsConverged);
  EXPECT_EQ(report.NumberOfInvertedTetrahedra, 0);
  EXPECT_LT(LargestOf(model.GetDisplacements()), 1e-8);
}

// A load that is far too large ends before the 200 steps, which would take minutes, and a smaller
// load after it has the same result as without it.
TEST(FiniteElements, LoadsThatAreFarTooLargeEndSoon)
{
  const LatticeBody lattice = MakeBlock({ 3, 3, 5 }, 0.45);
  const auto solve = [&](FiniteElementModel& model, double load)
  {
    EquilibriumRequest request;
    request.Mode = EquilibriumMode::Converged;
    request.Loads.Forces.assign(lattice.Body.Points.size(), glm::dvec3(0.0));
    for (const HeldNode& end : PullEnd(lattice, glm::dvec3(0.0)))
    {
      request.Loads.Forces[static_cast<std::size_t>(end.Node)].x = load;
    }
    return model.Solve(request);
  };
  FiniteElementModel fresh;
  fresh.SetBody(lattice.Body);
  ASSERT_TRUE(solve(fresh, 0.1).IsConverged);
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  const EquilibriumReport report = solve(model, 100.0);
  EXPECT_FALSE(report.IsConverged);
  EXPECT_GT(report.NumberOfInvertedTetrahedra, 0);
  EXPECT_LT(report.NewtonSteps, 60);
  EXPECT_TRUE(solve(model, 0.1).IsConverged);
  EXPECT_EQ(model.GetDisplacements(), fresh.GetDisplacements());
}
