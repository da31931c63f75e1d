// SPDX-License-Identifier: BSD-3-Clause
// Compares the bounds of the deformed volume with those of all of its possible corners, or of all
// voxels.
#include "DeformedBounds.h"
#include "MeshBounds.h"
#include "StaticMapping.h"

#include "LoopThreads.h"
#include "TetrahedralMeshes.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cstdlib>
#include <limits>

using namespace deformvolume;
using namespace tetrahedralMeshes;

namespace
{

const float NotANumber = std::numeric_limits<float>::quiet_NaN();

VoxelGrid MakeVolume(const Extent& extent, const glm::dvec3& scale)
{
  VoxelGrid voxelGrid;
  voxelGrid.VertexExtent = extent;
  voxelGrid.ToOutput = std::array<double, 3>{ { scale.x, scale.y, scale.z } };
  return voxelGrid;
}

glm::dvec3 GetRatio(const VoxelGrid& voxelGrid)
{
  return glm::dvec3(
    voxelGrid.ToOutput.Get(0, 0), voxelGrid.ToOutput.Get(1, 1), voxelGrid.ToOutput.Get(2, 2));
}

std::vector<float> MakeVectors(std::size_t count, double size, std::mt19937& random)
{
  std::normal_distribution<float> normal(0.0F, static_cast<float>(size));
  std::vector<float> vectors(3 * count);
  for (float& value : vectors)
  {
    value = normal(random);
  }
  return vectors;
}

glm::dvec3 GetVector(const std::vector<float>& vectors, std::int64_t index)
{
  return glm::dvec3(vectors[3 * index], vectors[3 * index + 1], vectors[3 * index + 2]);
}

bool AreClose(const IndexBounds& a, const IndexBounds& b, double tolerance)
{
  return a.IsEmpty() == b.IsEmpty() &&
    (a.IsEmpty() ||
      (glm::length(a.Min - b.Min) <= tolerance && glm::length(a.Max - b.Max) <= tolerance));
}

bool Contains(const IndexBounds& outer, const IndexBounds& inner, double tolerance)
{
  bool contains = !outer.IsEmpty() || inner.IsEmpty();
  for (int axis = 0; axis < 3 && !inner.IsEmpty(); ++axis)
  {
    contains = contains && outer.Min[axis] <= inner.Min[axis] + tolerance &&
      outer.Max[axis] >= inner.Max[axis] - tolerance;
  }
  return contains;
}

// Adds the deformed corners of the part of a tetrahedron that is inside the volume. Each corner is
// an intersection of three of the ten planes.
void AddCorners(const VoxelGrid& voxelGrid, const Mesh& mesh, const Tetrahedron& nodes,
  const std::vector<float>& displacements, IndexBounds& bounds)
{
  glm::dvec3 rest[4];
  glm::dvec3 moved[4];
  for (int node = 0; node < 4; ++node)
  {
    rest[node] = mesh.Points[nodes[node]];
    moved[node] = GetRatio(voxelGrid) * rest[node] + GetVector(displacements, nodes[node]);
  }
  const glm::dmat3 sides(rest[1] - rest[0], rest[2] - rest[0], rest[3] - rest[0]);
  if (std::abs(glm::determinant(sides)) < 1e-9)
  {
    return;
  }
  // Planes as (normal, offset). A point x is inside if normal . x >= offset.
  std::vector<glm::dvec4> planes;
  for (int axis = 0; axis < 3; ++axis)
  {
    glm::dvec4 plane(0.0, 0.0, 0.0, voxelGrid.VertexExtent[2 * axis]);
    plane[axis] = 1.0;
    planes.push_back(plane);
    plane[axis] = -1.0;
    plane.w = -voxelGrid.VertexExtent[2 * axis + 1];
    planes.push_back(plane);
  }
  for (int node = 0; node < 4; ++node)
  {
    const glm::dvec3& a = rest[(node + 1) % 4];
    glm::dvec3 normal =
      glm::normalize(glm::cross(rest[(node + 2) % 4] - a, rest[(node + 3) % 4] - a));
    normal *= glm::dot(normal, rest[node] - a) > 0.0 ? 1.0 : -1.0;
    planes.emplace_back(normal, glm::dot(normal, a));
  }
  const int count = static_cast<int>(planes.size());
  for (int i = 0; i < count; ++i)
  {
    for (int j = i + 1; j < count; ++j)
    {
      for (int k = j + 1; k < count; ++k)
      {
        const glm::dmat3 rows = glm::transpose(
          glm::dmat3(glm::dvec3(planes[i]), glm::dvec3(planes[j]), glm::dvec3(planes[k])));
        if (std::abs(glm::determinant(rows)) < 1e-9)
        {
          continue;
        }
        const glm::dvec3 point =
          glm::inverse(rows) * glm::dvec3(planes[i].w, planes[j].w, planes[k].w);
        if (std::all_of(planes.begin(), planes.end(),
              [&](const glm::dvec4& plane)
              { return glm::dot(glm::dvec3(plane), point) >= plane.w - 1e-9; }))
        {
          const glm::dvec3 weights = glm::inverse(sides) * (point - rest[0]);
          bounds.Add((1.0 - weights.x - weights.y - weights.z) * moved[0] + weights.x * moved[1] +
            weights.y * moved[2] + weights.z * moved[3]);
        }
      }
    }
  }
}

TEST(DeformedBounds, Mesh)
{
  std::mt19937 random(11);
  const VoxelGrid voxelGrid = MakeVolume({ { -4, 9, 2, 14, -20, -9 } }, glm::dvec3(1.0, 0.7, 2.5));
  const glm::dvec3 min(-4.0, 2.0, -20.0);
  const glm::dvec3 max(9.0, 14.0, -9.0);
  for (int trial = 0; trial < 20; ++trial)
  {
    for (const Mesh& mesh : { MakeLattice({ 3, 4, 3 }, min, max, 0.4, 0.0, random),
           MakeLattice({ 3, 3, 3 }, min - 8.1, max + 5.7, 0.4, 0.0, random),
           MakeLattice({ 3, 2, 3 }, min + 1.1, max - 2.8, 0.4, 0.0, random),
           MakeLattice({ 2, 2, 2 }, min - 50.0, max + 70.0, 0.0, 0.0, random),
           MakeSoup(30, 8, -25.0, 20.0, 1.0, random) })
    {
      const std::vector<float> displacements = MakeVectors(mesh.Points.size(), 6.0, random);
      IndexBounds expected;
      for (const Tetrahedron& nodes : mesh.Tetrahedra)
      {
        AddCorners(voxelGrid, mesh, nodes, displacements, expected);
      }
      EXPECT_TRUE(AreClose(
        ComputeDeformedBounds(voxelGrid, mesh.Points, mesh.Tetrahedra, displacements.data()),
        expected, 1e-6));
    }
  }

  // Without displacements the bounds are those of the intersection of mesh and volume.
  const VoxelGrid plain = MakeVolume(voxelGrid.VertexExtent, glm::dvec3(1.0));
  const Mesh mesh =
    MakeLattice({ 4, 4, 4 }, glm::dvec3(-1.0, 0.0, -30.0), glm::dvec3(20.0), 0.3, 0.0, random);
  std::vector<float> displacements(3 * mesh.Points.size(), 0.0F);
  const IndexBounds bounds =
    ComputeDeformedBounds(plain, mesh.Points, mesh.Tetrahedra, displacements.data());
  EXPECT_LT(glm::length(bounds.Min - glm::dvec3(-1.0, 2.0, -20.0)), 1e-12);
  EXPECT_LT(glm::length(bounds.Max - glm::dvec3(9.0, 14.0, -9.0)), 1e-12);

  // No mesh, a mesh outside the volume, flat tetrahedra only, and displacements that are not
  // finite.
  EXPECT_TRUE(ComputeDeformedBounds(plain, std::vector<glm::dvec3>(), {}, nullptr).IsEmpty());
  std::vector<glm::dvec3> apart = mesh.Points;
  for (glm::dvec3& point : apart)
  {
    point.x += 11.0;
  }
  EXPECT_TRUE(ComputeDeformedBounds(plain, apart, mesh.Tetrahedra, displacements.data()).IsEmpty());
  const std::vector<Tetrahedron> flat = { { { 0, 1, 2, 3 } }, { { 4, 4, 20, 30 } } };
  EXPECT_TRUE(ComputeDeformedBounds(plain, mesh.Points, flat, displacements.data()).IsEmpty());
  displacements[3 * 21 + 1] = NotANumber;
  IndexBounds expected;
  for (const Tetrahedron& nodes : mesh.Tetrahedra)
  {
    if (std::find(nodes.begin(), nodes.end(), 21) == nodes.end())
    {
      AddCorners(plain, mesh, nodes, displacements, expected);
    }
  }
  EXPECT_TRUE(
    AreClose(ComputeDeformedBounds(plain, mesh.Points, mesh.Tetrahedra, displacements.data()),
      expected, 1e-6));
  std::fill(displacements.begin(), displacements.end(), NotANumber);
  EXPECT_TRUE(
    ComputeDeformedBounds(plain, mesh.Points, mesh.Tetrahedra, displacements.data()).IsEmpty());
}

// Changes of some displacements, logged as ranges of nodes. The reference is the bounds of all
// nodes.
TEST(DeformedBounds, Changes)
{
  std::mt19937 random(23);
  const VoxelGrid voxelGrid = MakeVolume({ { -4, 9, 2, 14, -20, -9 } }, glm::dvec3(1.0, 0.7, 2.5));
  const glm::dvec3 min(-4.0, 2.0, -20.0);
  const glm::dvec3 max(9.0, 14.0, -9.0);
  // The meshes have several blocks of nodes. The volume clips many tetrahedra of the second mesh.
  for (const Mesh& mesh : { MakeLattice({ 12, 12, 12 }, min, max, 0.2, 0.0, random),
         MakeLattice({ 12, 12, 12 }, min - 8.1, max + 5.7, 0.2, 0.0, random) })
  {
    std::vector<float> displacements = MakeVectors(mesh.Points.size(), 2.0, random);
    MeshBounds bounds;
    bounds.SetMesh(voxelGrid, mesh.Points, mesh.Tetrahedra);
    const PointRanges none;
    int changes = 0;
    IndexBounds last;
    for (int edit = 0; edit < 60; ++edit)
    {
      PointRanges ranges;
      const std::size_t end = random() % mesh.Points.size() + 1;
      const std::size_t begin = random() % end;
      if (edit > 0)
      {
        ranges.push_back({ { begin, end } });
        // Every other change sets small displacements, so that bounds shrink as well.
        const double size = edit % 2 ? 30.0 : 2.0;
        const std::vector<float> moved = MakeVectors(mesh.Points.size(), size, random);
        std::copy(
          moved.begin() + 3 * begin, moved.begin() + 3 * end, displacements.begin() + 3 * begin);
      }
      // The first call reads all nodes, although no range is logged.
      const IndexBounds found =
        bounds.Compute(mesh.Points, mesh.Tetrahedra, displacements.data(), &ranges);
      const IndexBounds expected =
        ComputeDeformedBounds(voxelGrid, mesh.Points, mesh.Tetrahedra, displacements.data());
      EXPECT_TRUE(found.Min == expected.Min && found.Max == expected.Max);
      changes += found.Min != last.Min || found.Max != last.Max ? 1 : 0;
      last = found;
    }
    EXPECT_GT(changes, 30);
    // Displacements that are not logged are not read.
    std::fill(displacements.begin(), displacements.end(), 1000.0F);
    EXPECT_EQ(
      bounds.Compute(mesh.Points, mesh.Tetrahedra, displacements.data(), &none).Max, last.Max);
    EXPECT_GT(bounds.Compute(mesh.Points, mesh.Tetrahedra, displacements.data()).Max.x, 900.0);
  }
}

TEST(DeformedBounds, Links)
{
  std::mt19937 random(12);
  const VoxelGrid voxelGrid = MakeVolume({ { -4, 9, 2, 14, -20, -9 } }, glm::dvec3(1.5, 0.7, 2.5));
  const Extent& extent = voxelGrid.VertexExtent;
  const Mesh mesh = MakeLattice(
    { 3, 3, 3 }, glm::dvec3(0.0, 4.0, -18.0), glm::dvec3(5.0, 12.0, -11.0), 0.3, 0.0, random);
  const std::vector<float> displacements = MakeVectors(mesh.Points.size(), 5.0, random);
  for (const bool extrapolate : { false, true })
  {
    const StaticMapping mapping = BuildStaticMapping(
      extent, glm::dvec3(1.0), mesh.Points, mesh.Tetrahedra, extrapolate, StaticMappingForm::Links);
    IndexBounds expected;
    std::size_t i = 0;
    for (int z = extent[4]; z <= extent[5]; ++z)
    {
      for (int y = extent[2]; y <= extent[3]; ++y)
      {
        for (int x = extent[0]; x <= extent[1]; ++x, ++i)
        {
          const VertexLink& link = mapping.Links[i];
          if (link.Tetrahedron >= 0)
          {
            const Tetrahedron& nodes = mesh.Tetrahedra[link.Tetrahedron];
            const double a = link.Weights[0];
            const double b = link.Weights[1];
            const double c = link.Weights[2];
            expected.Add(GetRatio(voxelGrid) * glm::dvec3(x, y, z) +
              a * GetVector(displacements, nodes[0]) + b * GetVector(displacements, nodes[1]) +
              c * GetVector(displacements, nodes[2]) +
              (1.0 - a - b - c) * GetVector(displacements, nodes[3]));
          }
        }
      }
    }
    EXPECT_TRUE(AreClose(
      ComputeDeformedBounds(voxelGrid, mapping.Links, mesh.Tetrahedra, displacements.data()),
      expected, 1e-9));
  }
  EXPECT_TRUE(ComputeDeformedBounds(voxelGrid,
    std::vector<VertexLink>(static_cast<std::size_t>(GetNumberOfPoints(extent))), mesh.Tetrahedra,
    displacements.data())
                .IsEmpty());
}

// The bounds of the deformed positions of all points of a lattice over the volume. density: the
// number of its points per voxel on each axis.
IndexBounds SearchPoints(const VoxelGrid& voxelGrid, const DisplacementField& field, int density)
{
  const Extent& extent = voxelGrid.VertexExtent;
  const auto& m = field.IndexToField;
  IndexBounds bounds;
  for (int k = density * extent[4]; k <= density * extent[5]; ++k)
  {
    for (int j = density * extent[2]; j <= density * extent[3]; ++j)
    {
      for (int i = density * extent[0]; i <= density * extent[1]; ++i)
      {
        const glm::dvec3 point = glm::dvec3(i, j, k) / static_cast<double>(density);
        bool inside = true;
        glm::dvec3 sum(0.0);
        int low[3];
        double t[3];
        for (int axis = 0; axis < 3; ++axis)
        {
          const int last = field.Dimensions[axis] - 1;
          double f = m[4 * axis] * point.x + m[4 * axis + 1] * point.y + m[4 * axis + 2] * point.z +
            m[4 * axis + 3];
          inside = inside && f >= -1e-9 && f <= last + 1e-9;
          // Field indices have errors of up to 1e-12. Round them, since otherwise a neighboring
          // point that is not finite would get a small weight.
          f = std::abs(f - std::round(f)) < 1e-9 ? std::round(f) : f;
          f = std::clamp(f, 0.0, static_cast<double>(last));
          low[axis] = std::max(0, std::min(static_cast<int>(std::floor(f)), last - 1));
          t[axis] = f - low[axis];
        }
        for (int corner = 0; corner < 8; ++corner)
        {
          double weight = 1.0;
          std::int64_t index = 0;
          for (int axis = 2; axis >= 0; --axis)
          {
            const int upper = corner >> axis & 1;
            weight *= upper ? t[axis] : 1.0 - t[axis];
            index = index * field.Dimensions[axis] +
              std::min(low[axis] + upper, field.Dimensions[axis] - 1);
          }
          if (weight != 0.0)
          {
            sum += weight *
              glm::dvec3(field.Vectors[3 * index], field.Vectors[3 * index + 1],
                field.Vectors[3 * index + 2]);
          }
        }
        if ((inside || field.Extrapolate) && std::isfinite(sum.x + sum.y + sum.z))
        {
          bounds.Add(GetRatio(voxelGrid) * point + sum);
        }
      }
    }
  }
  return bounds;
}

TEST(DeformedBounds, Field)
{
  std::mt19937 random(13);
  const VoxelGrid voxelGrid = MakeVolume({ { -4, 9, 2, 14, -20, -9 } }, glm::dvec3(1.0, 0.7, 2.5));
  const glm::dvec3 center(2.5, 8.0, -14.5);
  struct Case
  {
    std::array<int, 3> Dimensions;
    glm::dvec3 Step;   // of the field, in voxels
    glm::dvec3 Center; // of the field, as an index of the volume
    double Angle;
    bool Exact;
    bool ExactIfConstant;
    bool EndsBetween; // the field ends between voxels, inside the volume
  };
  const Case cases[] = {
    // Fields whose points are at voxels: at all, at some, and beyond the volume.
    { { { 14, 13, 12 } }, glm::dvec3(1.0), center, 0.0, true, true, false },
    { { { 6, 5, 4 } }, glm::dvec3(1.0), center, 0.0, true, true, false },
    { { { 10, 3, 24 } }, glm::dvec3(1.0), center, 0.0, true, true, false },
    // A field that is finer than the volume.
    { { { 40, 41, 42 } }, glm::dvec3(0.4), center, 0.5, true, true, true },
    // Coarser fields: over the whole volume, over a part, rotated, outside the volume, and one
    // point
    // thick.
    { { { 7, 7, 7 } }, glm::dvec3(2.6, 2.3, 2.7), center, 0.0, false, true, false },
    { { { 4, 4, 4 } }, glm::dvec3(2.15, 1.7, 3.3), center + 1.3, 0.0, false, true, true },
    { { { 9, 9, 9 } }, glm::dvec3(3.0), center, 0.6, false, true, false },
    { { { 5, 6, 5 } }, glm::dvec3(1.7, 2.1, 2.3), center + 2.0, 0.6, false, false, true },
    { { { 2, 2, 2 } }, glm::dvec3(16.0), center + glm::dvec3(0.0, 14.0, 0.0), 0.8, false, false,
      true },
    { { { 5, 6, 5 } }, glm::dvec3(1.7, 2.1, 2.3), center + 60.0, 0.6, false, true, false },
    { { { 4, 1, 4 } }, glm::dvec3(2.0), center, 0.0, false, true, true },
    { { { 1, 1, 1 } }, glm::dvec3(2.0), center, 0.0, false, true, true },
  };
  for (const Case& item : cases)
  {
    DisplacementField field;
    field.Dimensions = item.Dimensions;
    const double c = std::cos(item.Angle);
    const double s = std::sin(item.Angle);
    const glm::dvec3 rows[3] = { glm::dvec3(c, s, 0.0) / item.Step.x,
      glm::dvec3(-s, c, 0.0) / item.Step.y, glm::dvec3(0.0, 0.0, 1.0) / item.Step.z };
    for (int row = 0; row < 3; ++row)
    {
      for (int column = 0; column < 3; ++column)
      {
        field.IndexToField[4 * row + column] = rows[row][column];
      }
      field.IndexToField[4 * row + 3] =
        0.5 * (item.Dimensions[row] - 1) - glm::dot(rows[row], item.Center);
      if (item.Step == glm::dvec3(1.0))
      {
        field.IndexToField[4 * row + 3] = std::floor(field.IndexToField[4 * row + 3]) + 1e-12;
      }
    }
    const std::size_t points =
      static_cast<std::size_t>(item.Dimensions[0]) * item.Dimensions[1] * item.Dimensions[2];
    for (const bool extrapolate : { false, true })
    {
      field.Extrapolate = extrapolate;
      std::vector<float> vectors(3 * points);
      for (std::size_t i = 0; i < vectors.size(); ++i)
      {
        vectors[i] = i % 3 == 0 ? 3.25F : (i % 3 == 1 ? -7.5F : 100.0F);
      }
      field.Vectors = vectors.data();
      const bool endsBetween = item.EndsBetween && !extrapolate;
      const int density = endsBetween ? 4 : 1;
      IndexBounds expected = SearchPoints(voxelGrid, field, density);
      IndexBounds found = ComputeDeformedBounds(voxelGrid, field);
      EXPECT_TRUE(Contains(found, expected, 1e-9));
      EXPECT_TRUE(
        !(item.ExactIfConstant || extrapolate) || endsBetween || AreClose(found, expected, 1e-9));
      // The corners of the deformed volume need not be points of the lattice, but are near such
      // points.
      const double distance = endsBetween && item.Angle == 0.0 ? 0.25 : 1.0;
      IndexBounds grown = expected;
      grown.Min -= distance * GetRatio(voxelGrid);
      grown.Max += distance * GetRatio(voxelGrid);
      EXPECT_TRUE(expected.IsEmpty() || Contains(grown, found, 1e-9));
      // The bounds are not larger than the shifted volume.
      const glm::dvec3 shift(3.25, -7.5, 100.0);
      EXPECT_TRUE(found.IsEmpty() ||
        Contains({ GetRatio(voxelGrid) * glm::dvec3(-4.0, 2.0, -20.0) + shift,
                   GetRatio(voxelGrid) * glm::dvec3(9.0, 14.0, -9.0) + shift },
          found, 1e-9));

      for (const bool broken : { false, true })
      {
        vectors = MakeVectors(points, 4.0, random);
        vectors[0] = broken ? NotANumber : vectors[0];
        vectors[vectors.size() - 1] =
          broken ? std::numeric_limits<float>::infinity() : vectors[vectors.size() - 1];
        field.Vectors = vectors.data();
        expected = SearchPoints(voxelGrid, field, density);
        found = ComputeDeformedBounds(voxelGrid, field);
        EXPECT_TRUE(Contains(found, expected, 1e-4));
        EXPECT_TRUE(!item.Exact || endsBetween || AreClose(found, expected, 1e-4));
        // The bounds are within those of the volume, extended by the least and largest component of
        // all vectors.
        IndexBounds widest;
        for (const float value : vectors)
        {
          if (std::isfinite(value))
          {
            widest.Add(glm::dvec3(value));
          }
        }
        widest.Min += GetRatio(voxelGrid) * glm::dvec3(-4.0, 2.0, -20.0);
        widest.Max += GetRatio(voxelGrid) * glm::dvec3(9.0, 14.0, -9.0);
        EXPECT_TRUE(found.IsEmpty() || Contains(widest, found, 1e-9));
      }
    }
  }

  DisplacementField empty;
  EXPECT_TRUE(ComputeDeformedBounds(voxelGrid, empty).IsEmpty());
}

TEST(DeformedBounds, Threads)
{
  std::mt19937 random(14);
  const VoxelGrid voxelGrid = MakeVolume({ { 0, 30, 0, 30, 0, 30 } }, glm::dvec3(1.0));
  const Mesh mesh = MakeLattice({ 9, 9, 9 }, glm::dvec3(-3.0), glm::dvec3(35.0), 0.3, 0.0, random);
  const std::vector<float> displacements = MakeVectors(mesh.Points.size(), 3.0, random);
  const auto compute = [&]()
  { return ComputeDeformedBounds(voxelGrid, mesh.Points, mesh.Tetrahedra, displacements.data()); };
  const IndexBounds one = CallOnThreads<1>(compute);
  const IndexBounds two = CallOnThreads<2>(compute);
  EXPECT_TRUE(one.Min == two.Min && one.Max == two.Max && !one.IsEmpty());
}

} // namespace
