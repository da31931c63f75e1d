// SPDX-License-Identifier: BSD-3-Clause
// The static mapping by links. The reference is a search of every voxel in every tetrahedron.
#include "StaticMapping.h"

#include "LoopThreads.h"
#include "TetrahedralMeshes.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <numeric>

using namespace deformvolume;
using namespace tetrahedralMeshes;

namespace
{

__extension__ typedef __int128 WideInteger;

// Six times the volume of a tetrahedron, in units of 1/256 voxel. It is exact for points whose
// coordinates are multiples of 1/256.
WideInteger GetExactVolume(
  const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d)
{
  const glm::dvec3 points[3] = { b - a, c - a, d - a };
  WideInteger m[3][3];
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      m[row][column] = static_cast<std::int64_t>(std::llround(256.0 * points[row][column]));
    }
  }
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
    m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
    m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

bool IsInsideExactly(const Mesh& mesh, const Tetrahedron& nodes, const glm::dvec3& point)
{
  const glm::dvec3 p[4] = { mesh.Points[nodes[0]], mesh.Points[nodes[1]], mesh.Points[nodes[2]],
    mesh.Points[nodes[3]] };
  const WideInteger volumes[4] = { GetExactVolume(point, p[1], p[2], p[3]),
    GetExactVolume(p[0], point, p[2], p[3]), GetExactVolume(p[0], p[1], point, p[3]),
    GetExactVolume(p[0], p[1], p[2], point) };
  return std::all_of(volumes, volumes + 4, [](WideInteger v) { return v >= 0; }) ||
    std::all_of(volumes, volumes + 4, [](WideInteger v) { return v <= 0; });
}

// Finds the volumes of the bodies: parts of the mesh without a common node. Returns the volume of
// its body for each node. No two nodes may have one position, and no two bodies the same volume.
std::vector<double> FindBodyVolumes(const Mesh& mesh)
{
  std::vector<std::size_t> bodies(mesh.Points.size());
  std::iota(bodies.begin(), bodies.end(), 0);
  for (bool isChanged = true; isChanged;)
  {
    isChanged = false;
    for (const Tetrahedron& nodes : mesh.Tetrahedra)
    {
      for (int node = 0; node < 4; ++node)
      {
        std::size_t& body = bodies[nodes[node]];
        const std::size_t other = bodies[nodes[(node + 1) % 4]];
        isChanged = isChanged || other < body;
        body = std::min(body, other);
      }
    }
  }
  std::vector<double> volumes(mesh.Points.size(), 0.0);
  for (const Tetrahedron& nodes : mesh.Tetrahedra)
  {
    volumes[bodies[nodes[0]]] += std::abs(glm::determinant(glm::dmat3(
      mesh.Points[nodes[0]] - mesh.Points[nodes[3]], mesh.Points[nodes[1]] - mesh.Points[nodes[3]],
      mesh.Points[nodes[2]] - mesh.Points[nodes[3]])));
  }
  std::vector<double> all;
  std::transform(bodies.begin(), bodies.end(), std::back_inserter(all),
    [&](std::size_t body) { return volumes[body]; });
  return all;
}

// Sorts tetrahedra by the volumes of their bodies, then by the positions of their nodes. A voxel is
// linked to the first tetrahedron in this order that contains it.
Mesh Sort(Mesh mesh)
{
  const std::vector<double> volumes = FindBodyVolumes(mesh);
  const auto getKey = [&](const Tetrahedron& nodes)
  {
    std::array<double, 13> key;
    key[0] = volumes[nodes[0]];
    for (int i = 0; i < 12; ++i)
    {
      key[i + 1] = mesh.Points[nodes[i / 3]][i % 3];
    }
    return key;
  };
  std::stable_sort(mesh.Tetrahedra.begin(), mesh.Tetrahedra.end(),
    [&](const Tetrahedron& a, const Tetrahedron& b) { return getKey(a) < getKey(b); });
  return mesh;
}

// For meshes whose coordinates are multiples of 1/256 voxel, which are not rounded: all links must
// be equal to those of an exact search.
void CheckExactly(const Mesh& unsorted, const Extent& voxels)
{
  const Mesh mesh = Sort(unsorted);
  const StaticMapping mapping = BuildStaticMapping(
    voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, false, StaticMappingForm::Links);
  std::int64_t flat = 0;
  std::vector<bool> isFlat;
  for (const Tetrahedron& nodes : mesh.Tetrahedra)
  {
    isFlat.push_back(GetExactVolume(mesh.Points[nodes[0]], mesh.Points[nodes[1]],
                       mesh.Points[nodes[2]], mesh.Points[nodes[3]]) == 0);
    flat += isFlat.back() ? 1 : 0;
  }
  EXPECT_EQ(mapping.NumberOfFlatTetrahedra, flat);
  EXPECT_EQ(static_cast<std::int64_t>(mapping.Links.size()), GetNumberOfPoints(voxels));
  std::int64_t inner = 0;
  for (std::int64_t i = 0; i < GetNumberOfPoints(voxels); ++i)
  {
    const glm::dvec3 voxel(GetVoxel(voxels, i));
    std::int32_t expected = -1;
    for (std::size_t id = 0; id < mesh.Tetrahedra.size() && expected < 0; ++id)
    {
      if (!isFlat[id] && IsInsideExactly(mesh, mesh.Tetrahedra[id], voxel))
      {
        expected = static_cast<std::int32_t>(id);
      }
    }
    EXPECT_EQ(mapping.Links[i].Tetrahedron, expected);
    inner += expected >= 0 ? 1 : 0;
    if (mapping.Links[i].Tetrahedron >= 0)
    {
      CheckWeights(mesh, mapping.Links[i], voxel);
    }
  }
  EXPECT_EQ(mapping.NumberOfInnerVoxels, inner);
}

// The depth of a point in a tetrahedron, negative outside; -infinity for flat ones.
double GetDepth(const Mesh& mesh, const Tetrahedron& nodes, const glm::dvec3& point)
{
  double depth = std::numeric_limits<double>::infinity();
  for (int node = 0; node < 4; ++node)
  {
    const glm::dvec3& apex = mesh.Points[nodes[node]];
    const glm::dvec3& a = mesh.Points[nodes[(node + 1) % 4]];
    const glm::dvec3 normal =
      glm::cross(mesh.Points[nodes[(node + 2) % 4]] - a, mesh.Points[nodes[(node + 3) % 4]] - a);
    const double height = glm::dot(normal, apex - a) / glm::length(normal);
    if (!(std::abs(height) > 1e-9))
    {
      return -std::numeric_limits<double>::infinity();
    }
    const double distance = glm::dot(normal, point - a) / glm::length(normal);
    depth = std::min(depth, height > 0.0 ? distance : -distance);
  }
  return depth;
}

// For meshes with any coordinates: links are right up to rounding, and there are no holes.
void CheckRounded(const Mesh& unsorted, const Extent& voxels)
{
  const Mesh mesh = Sort(unsorted);
  // Rounding moves a node by up to sqrt(3) 2^-9 voxel.
  const double tolerance = std::sqrt(3.0) / 256.0;
  const StaticMapping mapping = BuildStaticMapping(
    voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, false, StaticMappingForm::Links);
  for (std::int64_t i = 0; i < GetNumberOfPoints(voxels); ++i)
  {
    const glm::dvec3 voxel(GetVoxel(voxels, i));
    const std::int32_t found = mapping.Links[i].Tetrahedron;
    for (std::size_t id = 0; id < mesh.Tetrahedra.size(); ++id)
    {
      const double depth = GetDepth(mesh, mesh.Tetrahedra[id], voxel);
      if (depth > tolerance)
      {
        EXPECT_TRUE(found >= 0 && found <= static_cast<std::int32_t>(id));
        break;
      }
    }
    if (found >= 0)
    {
      EXPECT_GE(GetDepth(mesh, mesh.Tetrahedra[found], voxel), -tolerance);
      CheckWeights(mesh, mapping.Links[i], voxel);
    }
  }
}

TEST(StaticMapping, Misuse)
{
  std::mt19937 random(1);
  const Mesh mesh = MakeLattice({ 3, 3, 3 }, glm::dvec3(0.0), glm::dvec3(4.0), 0.0, 0.0, random);
  const Extent voxels{ { 0, 4, 0, 4, 0, 4 } };

  const StaticMapping nothing = BuildStaticMapping(Extent{ { 0, -1, 0, 4, 0, 4 } }, UnitSpacing,
    mesh.Points, mesh.Tetrahedra, true, StaticMappingForm::Links);
  EXPECT_TRUE(nothing.Links.empty() && nothing.NumberOfInnerVoxels == 0);

  for (const bool extrapolate : { false, true })
  {
    const StaticMapping empty =
      BuildStaticMapping(voxels, UnitSpacing, {}, {}, extrapolate, StaticMappingForm::Links);
    EXPECT_TRUE(empty.Links.size() == 125 && empty.NumberOfInnerVoxels == 0);
    EXPECT_TRUE(std::all_of(empty.Links.begin(), empty.Links.end(),
      [](const VertexLink& link) { return link.Tetrahedron == -1; }));
    const StaticMapping apart = BuildStaticMapping(Extent{ { 10, 12, 0, 4, 0, 4 } }, UnitSpacing,
      mesh.Points, mesh.Tetrahedra, extrapolate, StaticMappingForm::Links);
    EXPECT_TRUE(apart.NumberOfInnerVoxels == 0 && apart.Links[0].Tetrahedron == -1);
  }

  bool refused = false;
  try
  {
    Mesh far = mesh;
    far.Points[13].y = 1e10;
    BuildStaticMapping(
      voxels, UnitSpacing, far.Points, far.Tetrahedra, false, StaticMappingForm::Links);
  }
  catch (const Error& error)
  {
    refused = std::string(error.what()).find("units") != std::string::npos;
  }
  EXPECT_TRUE(refused);

  for (const bool extrapolate : { false, true })
  {
    const Extent larger{ { -2, 6, 0, 4, 0, 4 } };
    CheckProgress(
      [&](const std::function<bool(double)>& progress)
      {
        BuildStaticMapping(larger, UnitSpacing, mesh.Points, mesh.Tetrahedra, extrapolate,
          StaticMappingForm::Links, progress);
      });
  }
}

TEST(StaticMapping, Exact)
{
  std::mt19937 random(2);
  const double unit = 1.0 / 256.0;
  const Extent voxels{ { -5, 12, 3, 21, -20, -2 } };
  const glm::dvec3 min(-5.0, 3.0, -20.0);
  const glm::dvec3 max(12.0, 21.0, -2.0);

  // The mesh and the volume have the same bounds: no voxel may be missed.
  for (const double jitter : { 0.0, 0.2, 0.45 })
  {
    const Mesh mesh = MakeLattice({ 5, 4, 6 }, min, max, jitter, unit, random);
    CheckExactly(mesh, voxels);
    const StaticMapping mapping = BuildStaticMapping(
      voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, false, StaticMappingForm::Links);
    EXPECT_EQ(mapping.NumberOfInnerVoxels, GetNumberOfPoints(voxels));
  }
  // Meshes that are larger than the volume, smaller, and with tetrahedra that are smaller than a
  // voxel.
  CheckExactly(MakeLattice({ 4, 5, 4 }, min - 7.3, max + 5.1, 0.3, unit, random), voxels);
  CheckExactly(MakeLattice({ 4, 5, 4 }, min + 2.6, max - 4.9, 0.3, unit, random), voxels);
  CheckExactly(MakeLattice({ 9, 9, 9 }, min + 5.5, min + 8.0, 0.3, unit, random), voxels);
  // Nodes at voxels, so that many voxels are on faces, edges and nodes; meshes that are folded,
  // flat or overlapping.
  CheckExactly(MakeLattice({ 6, 6, 6 }, min, max, 1.4, 1.0, random), voxels);
  CheckExactly(MakeSoup(40, 120, -8.0, 24.0, 1.0, random), voxels);
  CheckExactly(MakeSoup(200, 60, -12.0, 14.0, 0.5, random), voxels);
  CheckExactly(MakeSoup(200, 60, -30.0, 30.0, unit, random), voxels);
  // Coordinates whose products exceed 64 bits.
  CheckExactly(MakeSoup(200, 80, -3100.0, 3100.0, unit, random), voxels);
  CheckExactly(MakeSoup(200, 80, -2.0e9, 2.0e9, 1.0, random), voxels);
  // Several tiles on the axes y and z, and a volume of two planes.
  CheckExactly(
    MakeLattice({ 3, 3, 3 }, glm::dvec3(0.0), glm::dvec3(5.0, 40.0, 37.0), 0.4, unit, random),
    Extent{ { 0, 4, 0, 40, 0, 37 } });
  CheckExactly(MakeSoup(50, 60, -4.0, 36.0, 0.25, random), Extent{ { 0, 33, 0, 34, 7, 8 } });
}

TEST(StaticMapping, Rounded)
{
  std::mt19937 random(3);
  const Extent voxels{ { -7, 8, -9, 4, 2, 15 } };
  const glm::dvec3 min(-7.0, -9.0, 2.0);
  const glm::dvec3 max(8.0, 4.0, 15.0);
  for (int trial = 0; trial < 4; ++trial)
  {
    CheckRounded(MakeLattice({ 5, 6, 5 }, min, max, 0.3, 0.0, random), voxels);
    CheckRounded(MakeLattice({ 4, 4, 4 }, min + 1.7, max - 2.2, 0.3, 0.0, random), voxels);
    CheckRounded(MakeSoup(150, 60, -15.0, 20.0, 0.0, random), voxels);
  }
  // Mesh bounds that are inside the volume by 1e-12, as after a transform of coordinates.
  const Mesh mesh = MakeLattice({ 6, 5, 4 }, min + 1e-12, max - 1e-12, 0.3, 0.0, random);
  EXPECT_EQ(BuildStaticMapping(
              voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, false, StaticMappingForm::Links)
              .NumberOfInnerVoxels,
    GetNumberOfPoints(voxels));
  // Tetrahedra that are much smaller than a voxel. Many of them are flat after rounding.
  const Mesh fine =
    MakeLattice({ 13, 13, 13 }, glm::dvec3(-0.05), glm::dvec3(1.07), 0.3, 0.0, random);
  const Extent corner{ { 0, 1, 0, 1, 0, 1 } };
  CheckRounded(fine, corner);
  EXPECT_EQ(BuildStaticMapping(
              corner, UnitSpacing, fine.Points, fine.Tetrahedra, false, StaticMappingForm::Links)
              .NumberOfInnerVoxels,
    8);
}

// Two pyramids whose common base is divided along different diagonals, and a flat tetrahedron
// between them. Rounding opens a gap there, in which no voxel may be lost.
TEST(StaticMapping, FlatBetweenOthers)
{
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  const Extent voxels{ { -3, 3, -3, 3, -3, 3 } };
  for (int trial = 0; trial < 300; ++trial)
  {
    const glm::dvec3 u = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const glm::dvec3 v =
      glm::normalize(glm::cross(u, glm::dvec3(normal(random), normal(random), normal(random))));
    const glm::dvec3 w = glm::cross(u, v);
    for (const double height : { 9.0, 1e-7 })
    {
      Mesh mesh;
      mesh.Points = std::vector<glm::dvec3>{ -10.0 * u - 9.0 * v, 11.0 * u - 10.0 * v,
        10.0 * u + 11.0 * v, -10.0 * u + 10.0 * v, 9.0 * w, -9.0 * w };
      // With this height the tetrahedron in between is a sliver that is not exactly flat.
      mesh.Points[0] += height < 1.0 ? height * w : glm::dvec3(0.0);
      mesh.Tetrahedra = { { { 0, 1, 2, 3 } }, { { 0, 1, 2, 4 } }, { { 0, 2, 3, 4 } },
        { { 0, 1, 3, 5 } }, { { 1, 2, 3, 5 } } };
      const StaticMapping mapping = BuildStaticMapping(
        voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, false, StaticMappingForm::Links);
      EXPECT_EQ(mapping.NumberOfInnerVoxels, GetNumberOfPoints(voxels));
      EXPECT_EQ(mapping.NumberOfFlatTetrahedra, height < 1.0 ? 0 : 1);
      for (std::int64_t i = 0; i < GetNumberOfPoints(voxels); ++i)
      {
        const VertexLink& link = mapping.Links[i];
        const float last = 1.0F - link.Weights[0] - link.Weights[1] - link.Weights[2];
        EXPECT_GE(link.Tetrahedron, 0);
        EXPECT_GE(std::min({ link.Weights[0], link.Weights[1], link.Weights[2], last }), -0.13F);
      }
    }
  }
  // A mesh of one flat tetrahedron contains no voxel.
  Mesh mesh;
  mesh.Points = std::vector<glm::dvec3>{ { -10.0, -9.0, 0.1 }, { 11.0, -10.0, 0.1 },
    { 10.0, 11.0, 0.1 }, { -10.0, 10.0, 0.1 } };
  for (glm::dvec3& point : mesh.Points)
  {
    point.z += 0.37 * point.x + 0.21 * point.y;
  }
  mesh.Tetrahedra = { { { 0, 1, 2, 3 } } };
  const StaticMapping mapping = BuildStaticMapping(
    voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, true, StaticMappingForm::Links);
  EXPECT_TRUE(mapping.NumberOfInnerVoxels == 0 && mapping.NumberOfFlatTetrahedra == 1);
}

// The same mesh with nodes and tetrahedra in another order gives the same links, to the last bit.
TEST(StaticMapping, Numbering)
{
  std::mt19937 random(8);
  const Extent voxels{ { 0, 20, -3, 25, 5, 24 } };
  const glm::dvec3 min(0.0, -3.0, 5.0);
  const glm::dvec3 max(20.0, 25.0, 24.0);
  for (const Mesh& mesh : { MakeLattice({ 5, 5, 5 }, min, max, 0.0, 1.0, random),
         MakeLattice({ 9, 8, 7 }, min - 1.0, max + 2.0, 0.3, 0.0, random),
         MakeSoup(60, 90, -5.0, 30.0, 1.0, random), MakeSoup(60, 90, -5.0, 30.0, 0.0, random) })
  {
    std::vector<std::int32_t> nodes(mesh.Points.size());
    std::vector<std::int32_t> tetrahedra(mesh.Tetrahedra.size());
    for (std::vector<std::int32_t>* numbers : { &nodes, &tetrahedra })
    {
      std::iota(numbers->begin(), numbers->end(), 0);
      std::shuffle(numbers->begin(), numbers->end(), random);
    }
    Mesh other = mesh;
    for (std::size_t node = 0; node < nodes.size(); ++node)
    {
      other.Points[nodes[node]] = mesh.Points[node];
    }
    for (std::size_t t = 0; t < tetrahedra.size(); ++t)
    {
      std::transform(mesh.Tetrahedra[t].begin(), mesh.Tetrahedra[t].end(),
        other.Tetrahedra[tetrahedra[t]].begin(), [&](std::int32_t node) { return nodes[node]; });
    }
    for (const bool extrapolate : { false, true })
    {
      const StaticMapping expected = BuildStaticMapping(
        voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, extrapolate, StaticMappingForm::Links);
      const StaticMapping found = BuildStaticMapping(
        voxels, UnitSpacing, other.Points, other.Tetrahedra, extrapolate, StaticMappingForm::Links);
      for (std::size_t i = 0; i < expected.Links.size(); ++i)
      {
        const VertexLink& link = expected.Links[i];
        EXPECT_EQ(
          found.Links[i].Tetrahedron, link.Tetrahedron < 0 ? -1 : tetrahedra[link.Tetrahedron]);
        EXPECT_EQ(std::memcmp(found.Links[i].Weights, link.Weights, sizeof(link.Weights)), 0);
      }
    }
    const StaticMapping expected = BuildStaticMapping(
      voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, false, StaticMappingForm::Runs);
    const StaticMapping found = BuildStaticMapping(
      voxels, UnitSpacing, other.Points, other.Tetrahedra, false, StaticMappingForm::Runs);
    EXPECT_EQ(found.Runs.RowBegins, expected.Runs.RowBegins);
    EXPECT_EQ(std::memcmp(found.Runs.Runs.data(), expected.Runs.Runs.data(),
                expected.Runs.Runs.size() * sizeof(VertexRun)),
      0);
    EXPECT_EQ(found.Runs.Tetrahedra.size(), expected.Runs.Tetrahedra.size());
    for (std::size_t i = 0; i < expected.Runs.Tetrahedra.size(); ++i)
    {
      const RestTetrahedron& a = expected.Runs.Tetrahedra[i];
      const RestTetrahedron& b = found.Runs.Tetrahedra[i];
      EXPECT_TRUE(b.Tetrahedron == tetrahedra[a.Tetrahedron] && b.Origin == a.Origin &&
        b.Weights == a.Weights && b.Gradients == a.Gradients);
    }
  }
}

// Of two bodies that overlap at rest, the smaller one has all voxels of the overlap, whatever their
// numbers are. Of equal bodies it is the one with the lowest position.
TEST(StaticMapping, Bodies)
{
  std::mt19937 random(9);
  const Extent voxels{ { 0, 30, 0, 20, 0, 20 } };
  const glm::dvec3 min(9.3, 4.3, 4.3);
  const glm::dvec3 max(28.6, 14.7, 14.4);
  const auto isWithin = [&](const glm::dvec3& voxel)
  { return glm::all(glm::greaterThan(voxel, min)) && glm::all(glm::lessThan(voxel, max)); };
  const auto check = [&](const Mesh& first, const Mesh& second, bool secondWins)
  {
    for (const bool swap : { false, true })
    {
      const Mesh both = swap ? Join(second, first) : Join(first, second);
      const StaticMapping mapping = BuildStaticMapping(
        voxels, UnitSpacing, both.Points, both.Tetrahedra, false, StaticMappingForm::Links);
      const auto firstCount = static_cast<std::int32_t>((swap ? second : first).Tetrahedra.size());
      int shared = 0;
      for (std::int64_t i = 0; i < GetNumberOfPoints(voxels); ++i)
      {
        if (isWithin(GetVoxel(voxels, i)))
        {
          const bool isSecond = (mapping.Links[i].Tetrahedron < firstCount) == swap;
          EXPECT_EQ(isSecond, secondWins || GetVoxel(voxels, i).x > 20);
          ++shared;
        }
      }
      EXPECT_GT(shared, 1000);
      EXPECT_TRUE(mapping.SharedVoxel && isWithin(glm::dvec3(*mapping.SharedVoxel)));
      const StaticMapping runs = BuildStaticMapping(
        voxels, UnitSpacing, both.Points, both.Tetrahedra, false, StaticMappingForm::Runs);
      EXPECT_EQ(runs.SharedVoxel, mapping.SharedVoxel);
    }
  };
  const Mesh small = MakeLattice({ 6, 4, 4 }, min, max, 0.0, 0.0, random);
  check(MakeLattice({ 5, 5, 5 }, glm::dvec3(2.3), glm::dvec3(20.6, 19.7, 19.4), 0.0, 0.0, random),
    small, true);
  Mesh equal = small;
  for (glm::dvec3& point : equal.Points)
  {
    point.x -= 8.0;
  }
  check(equal, small, false);
  // Bodies that touch do not overlap, also if voxels lie on the faces of both.
  const Mesh touching =
    Join(MakeLattice({ 4, 4, 4 }, glm::dvec3(0.0), glm::dvec3(12.0, 20.0, 20.0), 0.0, 0.0, random),
      MakeLattice(
        { 4, 5, 6 }, glm::dvec3(12.0, 0.5, 0.5), glm::dvec3(30.0, 20.0, 20.0), 0.0, 0.0, random));
  EXPECT_FALSE(BuildStaticMapping(
    voxels, UnitSpacing, touching.Points, touching.Tetrahedra, false, StaticMappingForm::Links)
                 .SharedVoxel);
}

TEST(StaticMapping, Threads)
{
  std::mt19937 random(6);
  const Extent voxels{ { 0, 40, -50, 9, 5, 70 } };
  Mesh mesh = MakeSoup(400, 300, -20.0, 60.0, 0.0, random);
  const auto build = [&]()
  {
    return BuildStaticMapping(voxels, glm::dvec3(0.5, 1.0, 2.0), mesh.Points, mesh.Tetrahedra, true,
      StaticMappingForm::Links);
  };
  const StaticMapping expected = CallOnThreads<1>(build);
  EXPECT_GT(expected.NumberOfInnerVoxels, 0);
  const StaticMapping mapping = CallOnThreads<2>(build);
  EXPECT_EQ(mapping.NumberOfInnerVoxels, expected.NumberOfInnerVoxels);
  EXPECT_EQ(mapping.NumberOfFlatTetrahedra, expected.NumberOfFlatTetrahedra);
  EXPECT_EQ(std::memcmp(mapping.Links.data(), expected.Links.data(),
              expected.Links.size() * sizeof(VertexLink)),
    0);
}

TEST(StaticMapping, Large)
{
  std::mt19937 random(7);
  const Extent voxels{ { 0, 127, 0, 127, 0, 127 } };
  const Mesh mesh =
    MakeLattice({ 33, 33, 33 }, glm::dvec3(0.0), glm::dvec3(127.0), 0.25, 0.0, random);
  const auto start = std::chrono::steady_clock::now();
  const StaticMapping mapping = BuildStaticMapping(
    voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, false, StaticMappingForm::Links);
  const double seconds =
    std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::cout << mapping.Links.size() << " voxels, " << mesh.Points.size() << " nodes: " << seconds
            << " s\n";
  EXPECT_EQ(mapping.NumberOfInnerVoxels, GetNumberOfPoints(voxels));
}

} // namespace
