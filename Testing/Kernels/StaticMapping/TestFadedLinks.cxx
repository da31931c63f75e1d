// SPDX-License-Identifier: BSD-3-Clause
// Faded links of voxels outside a deformation mesh. The references are a search of all faces of its
// boundary, and closed forms for boxes.
#include "ClosestFace.h"
#include "DeformedBounds.h"
#include "Error.h"
#include "FadedMesh.h"
#include "StaticMapping.h"

#include "TetrahedralMeshes.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <string>

using namespace deformvolume;
using namespace tetrahedralMeshes;

namespace
{

OutsideVoxels KeepWithin(double fadeDistance)
{
  return { OutsideVoxels::Modes::Keep, fadeDistance };
}

double Fade(double s)
{
  return s < 1.0 ? (1.0 - s) * (1.0 - s) * (1.0 + 2.0 * s) : 0.0;
}

// Removes the tetrahedra whose centers are in a box.
Mesh Hollow(Mesh mesh, const glm::dvec3& min, const glm::dvec3& max)
{
  const auto isWithin = [&](const Tetrahedron& tetrahedron)
  {
    glm::dvec3 center(0.0);
    for (const std::int32_t node : tetrahedron)
    {
      center += 0.25 * mesh.Points[node];
    }
    return center.x > min.x && center.y > min.y && center.z > min.z && center.x < max.x &&
      center.y < max.y && center.z < max.z;
  };
  mesh.Tetrahedra.erase(std::remove_if(mesh.Tetrahedra.begin(), mesh.Tetrahedra.end(), isWithin),
    mesh.Tetrahedra.end());
  return mesh;
}

// The distance from a point to a triangle: to its plane if the projection of the point is inside
// the triangle, otherwise to one of its edges.
double GetDistance(const glm::dvec3& p, const std::array<glm::dvec3, 3>& t)
{
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k)
  {
    const glm::dvec3 edge = t[(k + 1) % 3] - t[k];
    const double along = std::clamp(glm::dot(p - t[k], edge) / glm::dot(edge, edge), 0.0, 1.0);
    least = std::min(least, glm::distance(p, t[k] + along * edge));
  }
  const glm::dvec3 normal = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
  const glm::dvec3 foot = p - glm::dot(p - t[0], normal) * normal;
  bool isWithin = true;
  for (int k = 0; k < 3; ++k)
  {
    isWithin = isWithin && glm::dot(glm::cross(t[(k + 1) % 3] - t[k], foot - t[k]), normal) >= 0.0;
  }
  return isWithin ? std::min(least, std::abs(glm::dot(p - t[0], normal))) : least;
}

// The faces that belong to one tetrahedron only, as sorted nodes.
std::vector<std::array<std::int32_t, 3>> FindSingle(const Mesh& mesh)
{
  std::map<std::array<std::int32_t, 3>, int> counts;
  for (const Tetrahedron& tetrahedron : mesh.Tetrahedra)
  {
    for (int opposite = 0; opposite < 4; ++opposite)
    {
      std::array<std::int32_t, 3> face;
      for (int k = 0; k < 3; ++k)
      {
        face[k] = tetrahedron[(opposite + 1 + k) % 4];
      }
      std::sort(face.begin(), face.end());
      ++counts[face];
    }
  }
  std::vector<std::array<std::int32_t, 3>> faces;
  for (const auto& [face, count] : counts)
  {
    if (count == 1)
    {
      faces.push_back(face);
    }
  }
  return faces;
}

// A mesh with the tetrahedra of faded links, as VolumeDeformer uses it, and its displacements.
struct Moved
{
  Moved(const Mesh& mesh, const StaticMapping& mapping, const std::vector<float>& displacements)
  {
    this->Faded.Set(mapping.Faded, mesh.Tetrahedra, mesh.Points.size());
    this->Faded.Move(displacements.data(), mesh.Points.size(), nullptr);
  }
  glm::dvec3 Displace(const VertexLink& link) const
  {
    const Tetrahedron& nodes = this->Faded.GetTetrahedra()[link.Tetrahedron];
    glm::dvec3 sum(0.0);
    double rest = 1.0;
    for (int k = 0; k < 4; ++k)
    {
      const double weight = k < 3 ? double{ link.Weights[k] } : rest;
      rest -= weight;
      sum += weight * GetVector(this->Faded.GetDisplacements().data(), nodes[k]);
    }
    return sum;
  }
  FadedMesh Faded;
};

std::vector<float> MakeDisplacements(
  const Mesh& mesh, const std::function<glm::dvec3(const glm::dvec3&)>& map)
{
  std::vector<float> displacements;
  for (const glm::dvec3& point : mesh.Points)
  {
    const glm::dvec3 moved = map(point);
    for (int axis = 0; axis < 3; ++axis)
    {
      displacements.push_back(static_cast<float>(moved[axis]));
    }
  }
  return displacements;
}

TEST(FadedLinks, Search)
{
  std::mt19937 random(9);
  std::uniform_real_distribution<double> coordinate(-10.0, 10.0);
  std::uniform_real_distribution<double> size(-3.0, 3.0);
  EXPECT_EQ(ClosestFace({}).Find(glm::dvec3(1.0)).Face, -1);
  for (const int count : { 1, 4, 5, 333 })
  {
    std::vector<ClosestFace::Triangle> triangles;
    for (int i = 0; i < count; ++i)
    {
      const glm::dvec3 corner(coordinate(random), coordinate(random), coordinate(random));
      const double scale = i % 5 == 0 ? 1e-4 : 1.0;
      const auto next = [&]
      { return corner + scale * glm::dvec3(size(random), size(random), size(random)); };
      triangles.push_back({ { corner, next(), next() } });
      if (i % 7 == 3)
      {
        triangles.push_back(triangles[triangles.size() - 2]); // coincides with an earlier one
      }
    }
    const ClosestFace search(triangles);
    for (int i = 0; i < 500; ++i)
    {
      const glm::dvec3 point(
        1.5 * coordinate(random), 1.5 * coordinate(random), i % 3 == 0 ? 20.0 : coordinate(random));
      const ClosestFace::Result found = search.Find(point);
      double least = std::numeric_limits<double>::infinity();
      for (const ClosestFace::Triangle& triangle : triangles)
      {
        least = std::min(least, GetDistance(point, triangle));
      }
      EXPECT_LE(std::abs(std::sqrt(found.SquaredDistance) - least), 1e-12 * (1.0 + least));
      glm::dvec3 closest(0.0);
      for (int k = 0; k < 3; ++k)
      {
        closest += found.Weights[k] * triangles[found.Face][k];
        EXPECT_GE(found.Weights[k], 0.0);
      }
      EXPECT_LE(std::abs(glm::distance(point, closest) - least), 1e-11 * (1.0 + least));
      // The result does not depend on the face at which the search begins.
      const auto nearby = static_cast<std::int32_t>(random() % triangles.size());
      const ClosestFace::Result again = search.Find(point, nearby);
      EXPECT_TRUE(again.Face == found.Face && again.SquaredDistance == found.SquaredDistance);
    }
  }
}

// Beyond the edge between two faces, FindFirst() always finds the first one.
TEST(FadedLinks, SearchBeyondAnEdge)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-10.0, 10.0);
  int seconds = 0;
  for (int i = 0; i < 500; ++i)
  {
    const auto next = [&]
    { return glm::dvec3(coordinate(random), coordinate(random), coordinate(random)); };
    const glm::dvec3 start = next();
    const glm::dvec3 edge = next();
    const glm::dvec3 out = glm::normalize(glm::cross(edge, next()));
    const glm::dvec3 up = glm::normalize(glm::cross(edge, out));
    const ClosestFace search({ { { start, start + edge, start - 20.0 * out } },
      { { start + edge, start, start - 20.0 * up } } });
    const glm::dvec3 point = start + 0.3 * edge + 3.0 * out + 4.0 * up;
    seconds += search.Find(point).Face;
    const ClosestFace::Result found = search.FindFirst(point);
    EXPECT_EQ(found.Face, 0);
    EXPECT_NEAR(found.SquaredDistance, 25.0, 1e-9);
  }
  EXPECT_GT(seconds, 0); // rounding decides
}

TEST(FadedLinks, AgainstAllFaces)
{
  std::mt19937 random(5);
  const Extent voxels{ { -6, 13, 4, 22, -3, 13 } };
  const Mesh body = MakeLattice(
    { 4, 4, 4 }, glm::dvec3(-2.2, 7.1, 0.0), glm::dvec3(7.9, 17.0, 9.2), 0.3, 0.0, random);
  const Mesh meshes[] = { body,
    // A body with a cavity, and a ring.
    Hollow(body, glm::dvec3(0.0, 9.0, 2.0), glm::dvec3(6.0, 15.0, 7.0)),
    Hollow(body, glm::dvec3(0.0, 9.0, -9.0), glm::dvec3(6.0, 15.0, 19.0)),
    // Two bodies, one of them partly outside the volume.
    Join(MakeLattice({ 2, 3, 2 }, glm::dvec3(-12.0, 6.3, -1.0), glm::dvec3(-1.5, 13.0, 4.0), 0.0,
           0.0, random),
      MakeLattice(
        { 3, 3, 3 }, glm::dvec3(4.0, 12.3, 3.0), glm::dvec3(9.5, 18.0, 9.0), 0.2, 0.0, random)) };
  for (const glm::dvec3& spacing :
    { glm::dvec3(1.0), glm::dvec3(0.7, 2.3, 1.1), glm::dvec3(-5.0, 0.4, 0.9) })
  {
    for (const Mesh& mesh : meshes)
    {
      const auto single = FindSingle(mesh);
      const StaticMapping inside = BuildStaticMapping(
        voxels, spacing, mesh.Points, mesh.Tetrahedra, false, StaticMappingForm::Links);
      for (const double fadeDistance : { 0.0, 3.3, 1000.0 })
      {
        const StaticMapping all = BuildStaticMapping(voxels, spacing, mesh.Points, mesh.Tetrahedra,
          KeepWithin(fadeDistance), StaticMappingForm::Automatic);
        EXPECT_EQ(all.NumberOfInnerVoxels, inside.NumberOfInnerVoxels);
        EXPECT_TRUE(all.Boundary.IsEmpty() && all.Runs.Runs.empty());
        EXPECT_EQ(all.Faded.GetNumberOfFadedTetrahedra(), 1 + all.Faded.GetFaces().size());
        EXPECT_TRUE(fadeDistance > 0.0 || all.Faded.GetFaces().empty());
        std::vector<bool> isUsed(all.Faded.GetFaces().size());
        for (std::int64_t i = 0; i < GetNumberOfPoints(voxels); ++i)
        {
          const VertexLink& link = all.Links[i];
          if (inside.Links[i].Tetrahedron >= 0)
          {
            EXPECT_EQ(std::memcmp(&link, &inside.Links[i], sizeof(link)), 0);
            continue;
          }
          const glm::dvec3 point = spacing * glm::dvec3(GetVoxel(voxels, i));
          double least = std::numeric_limits<double>::infinity();
          for (const auto& face : single)
          {
            least = std::min(least,
              GetDistance(point,
                { { spacing * mesh.Points[face[0]], spacing * mesh.Points[face[1]],
                  spacing * mesh.Points[face[2]] } }));
          }
          const std::int64_t faded =
            link.Tetrahedron - static_cast<std::int64_t>(mesh.Tetrahedra.size());
          EXPECT_GE(faded, 0);
          const double weight = fadeDistance > 0.0 ? Fade(least / fadeDistance) : 0.0;
          EXPECT_TRUE(weight > 0.0 || faded == 0);
          if (faded <= 0)
          {
            EXPECT_LE(weight, 1e-12); // the distance may be FadeDistance, up to rounding
            continue;
          }
          isUsed[faded - 1] = true;
          const Tetrahedron nodes = all.Faded.GetFadedTetrahedron(faded, mesh.Tetrahedra, 12345);
          std::array<std::int32_t, 3> sorted{ { nodes[0], nodes[1], nodes[2] } };
          std::sort(sorted.begin(), sorted.end());
          EXPECT_TRUE(std::binary_search(single.begin(), single.end(), sorted));
          EXPECT_EQ(nodes[3], 12345);
          double sum = 0.0;
          glm::dvec3 closest(0.0);
          for (int k = 0; k < 3; ++k)
          {
            EXPECT_GE(link.Weights[k], 0.0F);
            sum += link.Weights[k];
            closest += double{ link.Weights[k] } * spacing * mesh.Points[nodes[k]];
          }
          EXPECT_LE(std::abs(sum - weight), 1e-6);
          // Weights are floats, with relative errors of 2^-24. Coordinates are up to 60.
          EXPECT_LE(std::abs(glm::distance(closest / sum, point) - least), 2e-5);
        }
        EXPECT_TRUE(std::all_of(isUsed.begin(), isUsed.end(), [](bool used) { return used; }));
      }
    }
  }
}

// A box that is translated: the closest point of the box is the point clamped to its bounds.
TEST(FadedLinks, MovedBox)
{
  std::mt19937 random(6);
  const Extent voxels{ { 0, 30, 0, 24, 0, 20 } };
  const glm::dvec3 spacing(0.8, 1.3, 2.1);
  const glm::dvec3 min(10.3, 8.6, 7.2);
  const glm::dvec3 max(18.4, 15.5, 12.9);
  const Mesh mesh = MakeLattice({ 4, 3, 3 }, min, max, 0.2, 0.0, random);
  const glm::dvec3 shift(1.5, -2.25, 0.75);
  for (const double fadeDistance : { 1.0, 4.0, 9.5 })
  {
    const StaticMapping mapping = BuildStaticMapping(voxels, spacing, mesh.Points, mesh.Tetrahedra,
      KeepWithin(fadeDistance), StaticMappingForm::Links);
    const Moved moved(
      mesh, mapping, MakeDisplacements(mesh, [&](const glm::dvec3&) { return shift; }));
    std::int64_t near = 0;
    for (std::int64_t i = 0; i < GetNumberOfPoints(voxels); ++i)
    {
      const glm::dvec3 point(GetVoxel(voxels, i));
      const double distance = glm::length(spacing * (point - glm::clamp(point, min, max)));
      const double weight = Fade(distance / fadeDistance);
      const glm::dvec3 displacement = moved.Displace(mapping.Links[i]);
      EXPECT_LE(glm::distance(displacement, weight * shift), 1e-6);
      EXPECT_TRUE(weight > 0.0 || displacement == glm::dvec3(0.0));
      near += weight > 0.0 && weight < 1.0;
    }
    EXPECT_GT(near, 100);
  }
}

// The bounds contain all voxels with faded links, and are not much larger.
TEST(FadedLinks, Bounds)
{
  std::mt19937 random(7);
  const Extent voxels{ { -4, 30, 3, 28, 0, 33 } };
  const glm::dvec3 spacing(1.0, 0.9, 1.2);
  VoxelGrid grid;
  grid.VertexExtent = voxels;
  grid.ToOutput = std::array<double, 3>{ { 1.5, 1.0, 0.75 } };
  const Mesh mesh = MakeLattice(
    { 4, 4, 4 }, glm::dvec3(3.0, 10.0, 9.0), glm::dvec3(20.0, 22.0, 25.0), 0.2, 0.0, random);
  std::uniform_real_distribution<double> uniform(-6.0, 6.0);
  for (const double fadeDistance : { 0.0, 5.0, 40.0 })
  {
    const StaticMapping mapping = BuildStaticMapping(voxels, spacing, mesh.Points, mesh.Tetrahedra,
      KeepWithin(fadeDistance), StaticMappingForm::Links);
    for (const double factor : { 0.0, 1.0 })
    {
      const auto displacements = MakeDisplacements(mesh,
        [&](const glm::dvec3&)
        { return factor * glm::dvec3(uniform(random), uniform(random), 4.0 + uniform(random)); });
      const Moved moved(mesh, mapping, displacements);
      std::vector<VertexLink> outside = mapping.Links;
      for (VertexLink& link : outside)
      {
        link.Tetrahedron =
          link.Tetrahedron < static_cast<int>(mesh.Tetrahedra.size()) ? -1 : link.Tetrahedron;
      }
      const IndexBounds exact = ComputeDeformedBounds(
        grid, outside, moved.Faded.GetTetrahedra(), moved.Faded.GetDisplacements().data());
      const IndexBounds found =
        mapping.Faded.ComputeBounds(grid, mesh.Tetrahedra, displacements.data());
      for (int axis = 0; axis < 3; ++axis)
      {
        EXPECT_LE(found.Min[axis], exact.Min[axis] + 1e-9);
        EXPECT_GE(found.Max[axis], exact.Max[axis] - 1e-9);
        EXPECT_TRUE(factor > 0.0 || found.Min[axis] == exact.Min[axis]);
        EXPECT_TRUE(factor > 0.0 || found.Max[axis] == exact.Max[axis]);
        EXPECT_GE(found.Min[axis], exact.Min[axis] - 10.0);
        EXPECT_LE(found.Max[axis], exact.Max[axis] + 10.0);
      }
    }
  }
}

// Two of three tetrahedra count. sum: of the numbers of a tetrahedron, of its cell and vertices.
bool IsChosen(std::int64_t sum)
{
  return sum % 3 != 0;
}

// The number of tetrahedra of the sampling mesh with a vertex outside the deformation mesh whose
// vertices have displacements that differ by more than 2 voxels, and that IsChosen().
std::int64_t CountStretched(const Extent& voxels, const StaticMapping& mapping, const Moved& moved,
  std::size_t numberOfTetrahedra)
{
  std::int64_t count = 0;
  std::int64_t cell = -1;
  const std::int64_t width = GetSize(voxels, 0);
  const std::int64_t plane = width * GetSize(voxels, 1);
  for (std::int64_t z = 0; z + 1 < GetSize(voxels, 2); ++z)
  {
    for (std::int64_t y = 0; y + 1 < GetSize(voxels, 1); ++y)
    {
      for (std::int64_t x = 0; x + 1 < width; ++x)
      {
        ++cell;
        for (int number = 0; number < 5; ++number)
        {
          bool isOutside = false;
          std::int64_t sum = cell + number;
          glm::dvec3 low(1e9);
          glm::dvec3 high(-1e9);
          for (const int vertex : FiveTetrahedra[number])
          {
            const std::int64_t i = x + ((vertex ^ (voxels[0] + x)) & 1);
            const std::int64_t j = y + ((vertex >> 2 ^ (voxels[2] + y)) & 1);
            const std::int64_t k = z + ((vertex >> 1 ^ (voxels[4] + z)) & 1);
            const VertexLink& link = mapping.Links[k * plane + j * width + i];
            sum += k * plane + j * width + i;
            isOutside = isOutside || link.Tetrahedron >= static_cast<int>(numberOfTetrahedra);
            low = glm::min(low, moved.Displace(link));
            high = glm::max(high, moved.Displace(link));
          }
          const glm::dvec3 size = high - low;
          count += isOutside && IsChosen(sum) && std::max({ size.x, size.y, size.z }) > 2.0 ? 1 : 0;
        }
      }
    }
  }
  return count;
}

TEST(FadedLinks, Stretched)
{
  std::mt19937 random(8);
  const Extent voxels{ { 1, 40, -2, 20, 3, 22 } };
  const Mesh left = MakeLattice(
    { 3, 3, 3 }, glm::dvec3(8.0, 3.0, 8.0), glm::dvec3(16.5, 15.0, 17.0), 0.0, 0.0, random);
  const Mesh right = MakeLattice(
    { 3, 3, 3 }, glm::dvec3(22.5, 3.0, 8.0), glm::dvec3(31.0, 15.0, 17.0), 0.0, 0.0, random);
  const Mesh two = Join(left, right);
  const auto apart = [](double distance)
  {
    return [=](const glm::dvec3& point)
    { return glm::dvec3(point.x < 20.0 ? -distance : distance, 0.0, 0.0); };
  };
  const auto expect =
    [&](const Mesh& mesh, double fadeDistance, const auto& map, bool isAny, const Extent& extent)
  {
    const StaticMapping mapping = BuildStaticMapping(extent, glm::dvec3(1.0), mesh.Points,
      mesh.Tetrahedra, KeepWithin(fadeDistance), StaticMappingForm::Links);
    const auto displacements = MakeDisplacements(mesh, map);
    const std::int64_t expected =
      CountStretched(extent, mapping, Moved(mesh, mapping, displacements), mesh.Tetrahedra.size());
    const std::int64_t found = mapping.Faded.CountStretched(mesh.Tetrahedra, displacements.data(),
      [](const StretchedTetrahedra::Candidate& candidate)
      {
        const auto& v = candidate.Vertices;
        return IsChosen(candidate.Cell + candidate.Tetrahedron + v[0] + v[1] + v[2] + v[3]);
      });
    EXPECT_EQ(expected > 0, isAny);
    if (mapping.Faded.IsCountEstimated())
    {
      EXPECT_LT(
        std::abs(static_cast<double>(found - expected)), 0.05 * static_cast<double>(expected));
    }
    else
    {
      EXPECT_EQ(found, expected);
    }
    return mapping.Faded.IsCountEstimated();
  };
  // Two bodies that move apart: the tetrahedra between them are stretched.
  expect(two, 20.0, apart(4.0), true, voxels);
  expect(two, 20.0, apart(0.9), false, voxels);
  // With this FadeDistance the displacements of the two bodies fade out before they meet.
  expect(two, 3.0, apart(1.5), false, voxels);
  // One body that is translated.
  expect(left, 20.0, apart(4.0), false, voxels);
  // A ring that opens.
  const Mesh ring = Hollow(MakeLattice({ 5, 7, 3 }, glm::dvec3(8.0, -1.0, 8.0),
                             glm::dvec3(24.0, 19.0, 17.0), 0.0, 0.0, random),
    glm::dvec3(11.9, 2.3, -99.0), glm::dvec3(20.1, 15.7, 99.0));
  expect(
    ring, 20.0, [](const glm::dvec3& p) { return glm::dvec3(0.4 * (p.x - 16.0), 0.0, 0.0); }, true,
    voxels);
  // No fading; the second mesh has so many cells that the count is estimated from some of them.
  EXPECT_FALSE(expect(left, 0.0, apart(3.0), true, voxels));
  EXPECT_TRUE(expect(MakeLattice({ 2, 2, 2 }, glm::dvec3(3.0), glm::dvec3(60.5), 0.0, 0.0, random),
    0.0, apart(3.0), true, { { 0, 64, 0, 64, 0, 64 } }));
}

// When tetrahedra get other nodes at the same positions, the faded tetrahedra follow.
TEST(FadedLinks, Split)
{
  std::mt19937 random(10);
  const Extent voxels{ { 0, 20, 0, 20, 0, 20 } };
  Mesh mesh = MakeLattice(
    { 3, 3, 3 }, glm::dvec3(6.0, 6.2, 5.8), glm::dvec3(14.1, 13.0, 14.0), 0.1, 0.0, random);
  const StaticMapping mapping = BuildStaticMapping(voxels, glm::dvec3(1.0), mesh.Points,
    mesh.Tetrahedra, KeepWithin(5.0), StaticMappingForm::Links);
  FadedMesh faded;
  faded.Set(mapping.Faded, mesh.Tetrahedra, mesh.Points.size());
  const auto still = static_cast<std::int32_t>(faded.GetNumberOfNodes()) - 1;
  std::vector<TetrahedronChange> changes;
  for (std::size_t t = 0; t < mesh.Tetrahedra.size(); t += 3)
  {
    TetrahedronChange change;
    change.Number = static_cast<std::int32_t>(t);
    change.Before = mesh.Tetrahedra[t];
    mesh.Points.push_back(mesh.Points[mesh.Tetrahedra[t][1]]);
    mesh.Tetrahedra[t][1] = static_cast<std::int32_t>(mesh.Points.size()) - 1;
    change.After = mesh.Tetrahedra[t];
    changes.push_back(change);
  }
  const std::vector<Tetrahedron> before = faded.GetTetrahedra();
  const std::vector<TetrahedronChange> all = faded.Change(mapping.Faded, changes);
  EXPECT_GT(all.size(), changes.size());
  std::vector<Tetrahedron> followed = before;
  for (const TetrahedronChange& change : all)
  {
    EXPECT_TRUE(followed[change.Number] == change.Before && change.After != change.Before);
    followed[change.Number] = change.After;
  }
  EXPECT_EQ(followed, faded.GetTetrahedra());
  for (std::size_t i = 0; i < mapping.Faded.GetNumberOfFadedTetrahedra(); ++i)
  {
    EXPECT_EQ(followed[mesh.Tetrahedra.size() + i],
      mapping.Faded.GetFadedTetrahedron(i, mesh.Tetrahedra, still));
  }
  EXPECT_TRUE(faded.HasRoom(mesh.Points.size()));
  EXPECT_FALSE(faded.HasRoom(faded.GetNumberOfNodes()));
}

TEST(FadedLinks, Misuse)
{
  std::mt19937 random(11);
  const Mesh mesh = MakeLattice({ 2, 2, 2 }, glm::dvec3(1.0), glm::dvec3(3.0), 0.0, 0.0, random);
  bool isRefused = false;
  try
  {
    BuildStaticMapping({ { 0, 5, 0, 5, 0, 5 } }, glm::dvec3(1.0), mesh.Points, mesh.Tetrahedra,
      KeepWithin(1.0), StaticMappingForm::Runs);
  }
  catch (const Error& error)
  {
    isRefused = std::string(error.what()).find("mesh that are kept") != std::string::npos;
  }
  EXPECT_TRUE(isRefused);
  // Without tetrahedra all voxels are kept at rest.
  const StaticMapping nothing = BuildStaticMapping(
    { { 0, 2, 0, 2, 0, 2 } }, glm::dvec3(1.0), {}, {}, KeepWithin(1.0), StaticMappingForm::Links);
  EXPECT_TRUE(nothing.Links.size() == 27 && nothing.Links[13].Tetrahedron == 0);
  // The displacements of a larger mesh.
  FadedMesh faded;
  faded.Set(nothing.Faded, {}, 8);
  const std::vector<float> displacements(3 * faded.GetNumberOfNodes());
  EXPECT_THROW(faded.Move(displacements.data(), faded.GetNumberOfNodes(), nullptr), Error);
}

} // namespace
