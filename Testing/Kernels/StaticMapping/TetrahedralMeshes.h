// SPDX-License-Identifier: BSD-3-Clause
// Deformation meshes and checks for tests that call classes of the engine directly.
#ifndef DeformVolumeTetrahedralMeshes_h
#define DeformVolumeTetrahedralMeshes_h

#include "Error.h"
#include "FiveTetrahedra.h"
#include "VolumeDeformer.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <thread>
#include <vector>

namespace tetrahedralMeshes
{

inline const glm::dvec3 UnitSpacing(1.0);

struct Mesh
{
  std::vector<glm::dvec3> Points;
  std::vector<deformvolume::Tetrahedron> Tetrahedra;
};

/// A lattice between two corners. Inner nodes are moved at random, by at most jitter times the
/// distance between nodes. unit: coordinates are rounded to multiples of it; 0: they are not
/// rounded.
inline Mesh MakeLattice(const glm::ivec3& nodes, const glm::dvec3& min, const glm::dvec3& max,
  double jitter, double unit, std::mt19937& random)
{
  std::uniform_real_distribution<double> between(-1.0, 1.0);
  Mesh mesh;
  for (int z = 0; z < nodes.z; ++z)
  {
    for (int y = 0; y < nodes.y; ++y)
    {
      for (int x = 0; x < nodes.x; ++x)
      {
        const glm::ivec3 node(x, y, z);
        glm::dvec3 point;
        for (int axis = 0; axis < 3; ++axis)
        {
          const double step = (max[axis] - min[axis]) / (nodes[axis] - 1);
          const bool within = node[axis] > 0 && node[axis] < nodes[axis] - 1;
          point[axis] = within ? min[axis] + step * (node[axis] + jitter * between(random))
                               : (node[axis] == 0 ? min[axis] : max[axis]);
          point[axis] = unit > 0.0 ? unit * std::round(point[axis] / unit) : point[axis];
        }
        mesh.Points.push_back(point);
      }
    }
  }
  for (int z = 0; z + 1 < nodes.z; ++z)
  {
    for (int y = 0; y + 1 < nodes.y; ++y)
    {
      for (int x = 0; x + 1 < nodes.x; ++x)
      {
        for (const auto& corners : deformvolume::FiveTetrahedra)
        {
          deformvolume::Tetrahedron tetrahedron;
          for (int node = 0; node < 4; ++node)
          {
            const int corner = corners[node];
            const int i = x + ((corner & 1) ^ (x & 1));
            const int j = y + ((corner >> 2 & 1) ^ (y & 1));
            const int k = z + ((corner >> 1 & 1) ^ (z & 1));
            tetrahedron[node] = (k * nodes.y + j) * nodes.x + i;
          }
          mesh.Tetrahedra.push_back(tetrahedron);
        }
      }
    }
  }
  return mesh;
}

/// Tetrahedra of random points. They overlap, and some of them are flat.
inline Mesh MakeSoup(
  int points, int tetrahedra, double min, double max, double unit, std::mt19937& random)
{
  std::uniform_real_distribution<double> position(min, max);
  std::uniform_int_distribution<std::int32_t> node(0, points - 1);
  Mesh mesh;
  for (int i = 0; i < points; ++i)
  {
    glm::dvec3 point;
    for (int axis = 0; axis < 3; ++axis)
    {
      point[axis] = position(random);
      point[axis] = unit > 0.0 ? unit * std::round(point[axis] / unit) : point[axis];
    }
    mesh.Points.push_back(point);
  }
  for (int i = 0; i < tetrahedra; ++i)
  {
    mesh.Tetrahedra.push_back({ { node(random), node(random), node(random), node(random) } });
  }
  return mesh;
}

/// A mesh of two bodies.
inline Mesh Join(const Mesh& first, const Mesh& second)
{
  Mesh mesh = first;
  const auto offset = static_cast<std::int32_t>(first.Points.size());
  mesh.Points.insert(mesh.Points.end(), second.Points.begin(), second.Points.end());
  for (deformvolume::Tetrahedron tetrahedron : second.Tetrahedra)
  {
    for (std::int32_t& node : tetrahedron)
    {
      node += offset;
    }
    mesh.Tetrahedra.push_back(tetrahedron);
  }
  return mesh;
}

/// The structured indices of a voxel.
inline glm::ivec3 GetVoxel(const deformvolume::Extent& voxels, std::int64_t index)
{
  const std::int64_t x = deformvolume::GetSize(voxels, 0);
  const std::int64_t y = deformvolume::GetSize(voxels, 1);
  return glm::ivec3(voxels[0] + static_cast<int>(index % x),
    voxels[2] + static_cast<int>(index / x % y), voxels[4] + static_cast<int>(index / (x * y)));
}

/// Checks that the weights of a link reproduce the position of the voxel.
inline void CheckWeights(
  const Mesh& mesh, const deformvolume::VertexLink& link, const glm::dvec3& voxel)
{
  const deformvolume::Tetrahedron& nodes = mesh.Tetrahedra[link.Tetrahedron];
  glm::dvec3 sum = mesh.Points[nodes[3]];
  double rounding = 1e-9;
  for (int node = 0; node < 3; ++node)
  {
    const glm::dvec3 side = mesh.Points[nodes[node]] - mesh.Points[nodes[3]];
    const double weight = link.Weights[node];
    sum += weight * side;
    // The rounding error of a float is half of its last bit.
    rounding += std::ldexp(std::abs(weight), -24) * glm::length(side);
  }
  EXPECT_LE(glm::length(sum - voxel), 1.01 * rounding);
}

/// Checks that a function reports its progress in order, in the calling thread and up to 1, and
/// that it can be aborted.
inline void CheckProgress(
  const std::function<void(const std::function<bool(double)>& progress)>& build)
{
  double last = -1.0;
  bool ordered = true;
  const std::thread::id caller = std::this_thread::get_id();
  build(
    [&](double done)
    {
      ordered = ordered && done >= last && done <= 1.0 && std::this_thread::get_id() == caller;
      last = done;
      return true;
    });
  EXPECT_TRUE(ordered && std::abs(last - 1.0) < 1e-12);
  for (const double end : { 0.0, 0.3, 0.9 })
  {
    EXPECT_THROW(build([&](double done) { return done < end; }), deformvolume::Aborted);
  }
}

} // namespace tetrahedralMeshes

#endif
