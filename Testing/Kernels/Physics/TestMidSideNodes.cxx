// SPDX-License-Identifier: BSD-3-Clause
// Mid-side nodes: how they are made, split and checked.
#include "Error.h"
#include "FiniteElementCase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <set>

using namespace deformvolume;

namespace
{

// Two tetrahedra that share the face of nodes 1, 2 and 3.
ElasticBody MakeNeighbors()
{
  ElasticBody body;
  body.Points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 1, 1 } };
  body.Tetrahedra = { { 0, 1, 2, 3 }, { 2, 1, 4, 3 } };
  return body;
}

glm::dvec3 GetMiddle(const ElasticBody& body, std::size_t tetrahedron, std::size_t edge)
{
  const auto at = [&](std::size_t end)
  {
    return body
      .Points[static_cast<std::size_t>(body.Tetrahedra[tetrahedron][TetrahedronEdges[edge][end]])];
  };
  return 0.5 * (at(0) + at(1));
}

} // namespace

TEST(MidSideNodes, LieInTheMiddleOfEdges)
{
  LatticeBody lattice({ 3, 3, 3 }, 0.5, MakeMaterial(1e4, 0.3));
  lattice.Fix([](const LatticeBody::Place& place) { return place[2] == 0; });
  ElasticBody& body = lattice.Body;
  const auto ends = AddMidSideNodes(body);
  // The edges along the axes, and one diagonal of each face of a cell.
  const std::size_t edges = 3 * 18 + 3 * 12;
  EXPECT_EQ(ends.size(), edges);
  EXPECT_EQ(body.Points.size(), 27 + edges);
  EXPECT_EQ(body.Fixed.size(), 27 + edges);
  EXPECT_TRUE(std::is_sorted(ends.begin(), ends.end()));
  for (std::size_t i = 0; i < edges; ++i)
  {
    const auto a = static_cast<std::size_t>(ends[i][0]);
    const auto b = static_cast<std::size_t>(ends[i][1]);
    EXPECT_LT(a, b);
    EXPECT_EQ(body.Points[27 + i], 0.5 * (body.Points[a] + body.Points[b]));
    EXPECT_EQ(body.Fixed[27 + i], body.Points[a].z == 0.0 && body.Points[b].z == 0.0 ? 1 : 0);
  }
  for (std::size_t t = 0; t < body.Tetrahedra.size(); ++t)
  {
    for (std::size_t edge = 0; edge < 6; ++edge)
    {
      EXPECT_EQ(
        body.Points[static_cast<std::size_t>(body.MidSides[t][edge])], GetMiddle(body, t, edge));
    }
  }
}

TEST(MidSideNodes, GivenOnesStay)
{
  ElasticBody body = MakeNeighbors();
  body.Points.push_back({ 0.52, 0.5, 0.0 }); // the mid-side node of the edge 1 2
  body.MidSides = { { { -1, 5, -1, -1, -1, -1 } }, { { -1, -1, -1, -1, -1, -1 } } };
  EXPECT_EQ(AddMidSideNodes(body).size(), 8u);
  EXPECT_EQ(body.MidSides[0][1], 5);
  EXPECT_EQ(body.MidSides[1][0], 5);
  EXPECT_EQ(body.Points.size(), 14u);
  // All tetrahedra have mid-side nodes now.
  EXPECT_EQ(AddMidSideNodes(body).size(), 0u);

  // A second mid-side node for the same edge.
  body.Points.push_back({ 0.5, 0.51, 0.0 });
  body.MidSides[1][0] = 14;
  const std::string error = GetError([&] { AddMidSideNodes(body); });
  EXPECT_NE(error.find("1 edge with more than one mid-side node"), std::string::npos) << error;
  EXPECT_NE(error.find("between the nodes 1 and 2"), std::string::npos) << error;
}

// Forces at the corners of boundary faces of four-node tetrahedra, by the areas of these faces.
TEST(MidSideNodes, TakeForcesOfFaces)
{
  ElasticBody body = MakeNeighbors();
  body.Points[3].z = 2.0; // the faces 0 1 3 and 0 2 3 are twice as large as the face 0 1 2
  const auto toForces = [](std::initializer_list<double> values)
  {
    std::vector<glm::dvec3> forces;
    std::transform(values.begin(), values.end(), std::back_inserter(forces),
      [](double value) { return glm::dvec3(0.0, value, 0.0); });
    return forces;
  };
  std::vector<glm::dvec3> forces = toForces({ 5.0, 3.0, 6.0, 1.0, 0.0 });
  AddMidSideNodes(body, &forces);
  ASSERT_EQ(forces.size(), body.Points.size());
  EXPECT_EQ(std::count(forces.begin(), forces.begin() + 5, glm::dvec3(0.0)), 5);
  double sum = 0.0;
  for (const glm::dvec3& force : forces)
  {
    sum += force.y;
  }
  EXPECT_NEAR(sum, 15.0, 1e-14);
  // Half of a third of each force at the ends of the edge 1 2, and of all forces at the edge 0 3.
  const auto get = [&](std::size_t edge)
  { return forces[static_cast<std::size_t>(body.MidSides[0][edge])].y; };
  EXPECT_NEAR(get(1), 0.5 * (3.0 + 6.0) / 3.0, 1e-15);
  EXPECT_NEAR(get(3), 0.5 * (5.0 * 4.0 / 5.0 + 1.0), 1e-15);

  // The face 1 2 3 is inside the body, and ten-node tetrahedra have forces of their own.
  for (const bool isTenNode : { false, true })
  {
    ElasticBody other = MakeNeighbors();
    if (isTenNode)
    {
      AddMidSideNodes(other);
    }
    forces = toForces({ isTenNode ? 1.0 : 0.0, 1.0, 1.0, 1.0, 0.0 });
    forces.resize(other.Points.size());
    std::vector<glm::dvec3> wanted = forces;
    AddMidSideNodes(other, &forces);
    wanted.resize(other.Points.size());
    EXPECT_EQ(forces, wanted);
  }
}

TEST(MidSideNodes, SplitWithTheirEdges)
{
  ElasticBody body = MakeNeighbors();
  AddMidSideNodes(body);
  const auto nodes = static_cast<std::int32_t>(body.Points.size());
  const std::vector<MidSideNodes> before = body.MidSides;

  // The second tetrahedron is separated.
  std::vector<MidSideNodes> parted = before;
  const std::vector<std::int32_t> origins =
    SplitMidSideNodes({ { 0, 1, 2, 3 }, { nodes, nodes + 1, 4, nodes + 2 } }, nodes + 3, parted);
  EXPECT_EQ(parted[0], before[0]);
  EXPECT_EQ(origins.size(), 3u);
  for (std::size_t edge = 0; edge < 6; ++edge)
  {
    const bool isShared = std::count(before[0].begin(), before[0].end(), before[1][edge]) > 0;
    EXPECT_EQ(parted[1][edge] >= nodes + 3, isShared);
    if (isShared)
    {
      EXPECT_EQ(origins[static_cast<std::size_t>(parted[1][edge] - nodes - 3)], before[1][edge]);
    }
  }

  // The tetrahedra still share the edge 1 2, like a hinge. This edge keeps one mid-side node.
  std::vector<MidSideNodes> hinged = before;
  EXPECT_EQ(
    SplitMidSideNodes({ { 0, 1, 2, 3 }, { 2, 1, 4, nodes } }, nodes + 1, hinged).size(), 2u);
  EXPECT_EQ(hinged[1][0], before[1][0]);

  // Nothing is split.
  std::vector<MidSideNodes> same = before;
  EXPECT_TRUE(SplitMidSideNodes(body.Tetrahedra, nodes, same).empty());
  EXPECT_EQ(same, before);
}

TEST(MidSideNodes, Misuse)
{
  const QuadraticLattice lattice({ 3, 3, 3 }, 0.5, MakeMaterial(1e4, 0.3));
  const auto getError = [](const ElasticBody& body) { return GetError([&] { CheckBody(body); }); };
  const auto expectFound = [](const std::string& error, const std::string& text)
  { EXPECT_NE(error.find(text), std::string::npos) << error; };
  EXPECT_EQ(getError(lattice.Body), "");

  // A mid-side node that is nearer to an end of its edge than a quarter of the length; then
  // mid-side nodes in the order of another program.
  ElasticBody body = lattice.Body;
  const auto a = static_cast<std::size_t>(body.MidSides[3][0]);
  body.Points[a] +=
    0.6 * (body.Points[static_cast<std::size_t>(body.Tetrahedra[3][0])] - body.Points[a]);
  expectFound(getError(body), " of 40 tetrahedra of the mesh at rest overlap themselves");
  body = lattice.Body;
  for (MidSideNodes& nodes : body.MidSides)
  {
    std::swap(nodes[4], nodes[5]);
  }
  expectFound(getError(body),
    "40 of 40 tetrahedra of the mesh at rest overlap themselves, as mid-side "
    "nodes are misplaced, the first one with the points " +
      ListNodes(body.Tetrahedra[0]) + ".");
  body = lattice.Body;
  body.MidSides.pop_back();
  expectFound(getError(body), "39 tetrahedra with mid-side nodes, but 40 are needed");
  body = lattice.Body;
  body.MidSides[7][2] = 1000;
  expectFound(getError(body), "Tetrahedron 7 has the node 1000");
  body = lattice.Body;
  body.Points[a].y = std::numeric_limits<double>::quiet_NaN();
  expectFound(getError(body), "The rest position of node ");

  // Flat tetrahedra are counted.
  body = lattice.Body;
  body.MidSides.clear();
  for (const std::size_t t : { 4, 9 })
  {
    const Tetrahedron& nodes = body.Tetrahedra[t];
    body.Points.push_back(body.Points[static_cast<std::size_t>(nodes[0])]);
    body.Tetrahedra[t][3] = static_cast<std::int32_t>(body.Points.size() - 1);
  }
  expectFound(getError(body),
    "2 of 40 tetrahedra of the mesh at rest are flat, the first one with the points " +
      ListNodes(body.Tetrahedra[4]) + ".");
  EXPECT_EQ(ListNodes({ { 3, 14, 5, 9 } }), "3, 14, 5 and 9");
}

// A ten-node tetrahedron is divided into linear tetrahedra. One of them is inverted, although the
// determinant at the integration points is far from 0. A volume cannot be deformed by such a mesh.
TEST(MidSideNodes, InvertedPartsAreAnError)
{
  for (const bool isMirrored : { false, true })
  {
    ElasticBody body;
    body.Points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, isMirrored ? -1 : 1 } };
    body.Tetrahedra = { { 0, 1, 2, 3 } };
    AddMidSideNodes(body);
    glm::dvec3& node = body.Points[static_cast<std::size_t>(body.MidSides[0][4])];
    const glm::dvec3 middle = node;
    const glm::dvec3 aside(-0.2, -0.3, isMirrored ? 0.2 : -0.2);
    node = middle + 0.8 * aside;
    EXPECT_EQ(GetError([&] { CheckBody(body); }), "");
    node = middle + aside;
    EXPECT_NE(
      GetError([&] { CheckBody(body); }).find("1 of 1 tetrahedra of the mesh at rest overlap"),
      std::string::npos);
  }
}

// Curved edges cause no error, and no strain in a mesh that is at rest.
TEST(MidSideNodes, MayLieOffTheMiddle)
{
  QuadraticLattice lattice({ 3, 3, 3 }, 0.5, MakeMaterial(1e4, 0.45));
  ElasticBody& body = lattice.Body;
  const std::vector<std::int32_t> inside = FindNodes(body,
    [](const glm::dvec3& point) {
      return std::min({ point.x, point.y, point.z, 1 - point.x, 1 - point.y, 1 - point.z }) > 0.1;
    });
  EXPECT_GT(inside.size(), 10u);
  for (const std::int32_t node : inside)
  {
    const double sign = node % 2 == 0 ? 1.0 : -1.0;
    body.Points[static_cast<std::size_t>(node)] += sign * glm::dvec3(0.03, -0.04, 0.02);
  }
  const std::vector<glm::dvec3> wanted = MapPoints(body,
    MakeRotation(1.0, { 1.0, -1.0, 0.3 }) *
      glm::dmat3(1.2, 0.05, 0.0, 0.1, 0.9, 0.03, -0.04, 0.02, 1.1),
    glm::dvec3(0.2, 0.1, -0.3));
  const std::set<std::int32_t> isInside(inside.begin(), inside.end());
  EquilibriumRequest request = MakeConverged();
  request.Limits.RelativeTolerance = 1e-11;
  request.Limits.LinearTolerance = 1e-10;
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    if (isInside.count(static_cast<std::int32_t>(node)) == 0)
    {
      request.Held.push_back({ static_cast<std::int32_t>(node), wanted[node] });
    }
  }
  FiniteElementModel model;
  model.SetBody(body);
  EXPECT_TRUE(model.Solve(request).IsConverged);
  EXPECT_LT(LargestDifference(model.GetDisplacements(), wanted), 1e-11);
}
