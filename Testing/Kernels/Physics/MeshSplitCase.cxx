// SPDX-License-Identifier: BSD-3-Clause
#include "MeshSplitCase.h"

#include "BodyPieces.h"
#include "DisjointSets.h"
#include "LatticeBody.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace physicsTesting
{

using namespace deformvolume;

void SheetSurface::Add(const SheetSurface& other)
{
  const auto first = static_cast<std::int64_t>(this->Points.size());
  this->Points.insert(this->Points.end(), other.Points.begin(), other.Points.end());
  for (const auto& t : other.Triangles)
  {
    this->Triangles.push_back({ { first + t[0], first + t[1], first + t[2] } });
  }
}

SheetSurface MakeSheet(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v)
{
  return { { corner, corner + u, corner + u + v, corner + v },
    { { { 0, 1, 2 } }, { { 0, 2, 3 } } } };
}

SheetSurface MakePlaneX(double x)
{
  return MakeSheet({ x, -1.0, -1.0 }, { 0.0, 10.0, 0.0 }, { 0.0, 0.0, 10.0 });
}
SheetSurface MakePlaneY(double y)
{
  return MakeSheet({ -1.0, y, -1.0 }, { 10.0, 0.0, 0.0 }, { 0.0, 0.0, 10.0 });
}

MeshSplit Split(
  const ElasticBody& body, const SheetSurface& sheet, const std::vector<TetrahedronPair>& unparted)
{
  return SplitMesh(body.Points, body.Tetrahedra, sheet.Points, sheet.Triangles, unparted);
}

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
  EXPECT_EQ(a.StillConnected, b.StillConnected);
}

void ExpectNothing(const ElasticBody& body, const MeshSplit& split)
{
  MeshSplit nothing;
  nothing.Tetrahedra = body.Tetrahedra;
  ExpectSame(split, nothing);
}

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

std::vector<std::int32_t> FindFaceComponents(const std::vector<Tetrahedron>& tetrahedra)
{
  DisjointSets<std::size_t> sets(tetrahedra.size());
  std::map<std::array<std::int32_t, 3>, std::size_t> owners;
  for (std::size_t t = 0; t < tetrahedra.size(); ++t)
  {
    for (std::size_t k = 0; k < 4; ++k)
    {
      std::array<std::int32_t, 3> face{ { tetrahedra[t][(k + 1) % 4], tetrahedra[t][(k + 2) % 4],
        tetrahedra[t][(k + 3) % 4] } };
      std::sort(face.begin(), face.end());
      sets.Unite(t, owners.try_emplace(face, t).first->second);
    }
  }
  std::vector<std::int32_t> components(tetrahedra.size());
  std::int32_t count = 0;
  for (std::size_t t = 0; t < tetrahedra.size(); ++t)
  {
    const std::size_t lowest = sets.Find(t);
    components[t] = lowest == t ? count++ : components[lowest];
  }
  return components;
}

std::size_t CountComponents(const std::vector<std::int32_t>& components)
{
  return components.empty()
    ? 0
    : static_cast<std::size_t>(*std::max_element(components.begin(), components.end())) + 1;
}

std::vector<double> ExpectPieces(const ElasticBody& body, std::size_t count)
{
  const std::vector<std::int32_t> components = FindFaceComponents(body.Tetrahedra);
  EXPECT_EQ(CountComponents(components), count);
  EXPECT_EQ(FindBodyPieces(body).NumberOfPieces, static_cast<std::int32_t>(count));
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
  return MakeLatticeBody({ { 9, 9, 9 } }, glm::dvec3(1.0));
}

ElasticBody MakePair()
{
  ElasticBody body;
  body.Points = { { 0.0, 0.0, -1.0 }, { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { -1.0, -1.0, 0.0 },
    { 0.0, 0.0, 1.0 } };
  body.Tetrahedra = { { { 0, 1, 2, 3 } }, { { 4, 1, 3, 2 } } };
  return body;
}

} // namespace physicsTesting
