// SPDX-License-Identifier: BSD-3-Clause
#include "TightMesh.h"

#include "OutputPlace.h"

#include <glm/matrix.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <random>

using namespace deformvolume;

namespace
{

// Rounding moves corners by up to 1/512 output voxel on each axis.
constexpr double Margin = 1.0 / 128.0;

// The five tetrahedra of a cell of even index, as offsets x, y, z of their vertices: four corner
// tetrahedra and the central one. Taken from the figure of the publication.
constexpr int Split[5][4][3] = {
  { { 0, 0, 0 }, { 0, 0, 1 }, { 1, 0, 1 }, { 0, 1, 1 } },
  { { 0, 1, 1 }, { 1, 1, 1 }, { 1, 0, 1 }, { 1, 1, 0 } },
  { { 1, 0, 1 }, { 1, 0, 0 }, { 0, 0, 0 }, { 1, 1, 0 } },
  { { 0, 0, 0 }, { 0, 1, 0 }, { 0, 1, 1 }, { 1, 1, 0 } },
  { { 0, 1, 1 }, { 1, 0, 1 }, { 1, 1, 0 }, { 0, 0, 0 } },
};

// Finds barycentric weights. Returns false for a flat tetrahedron.
bool FindWeights(const std::array<glm::dvec3, 4>& q, const glm::dvec3& point, double* weights)
{
  const glm::dmat3 sides(q[0] - q[3], q[1] - q[3], q[2] - q[3]);
  if (std::abs(glm::determinant(sides)) < 1e-12)
  {
    return false;
  }
  const glm::dvec3 first = glm::inverse(sides) * (point - q[3]);
  for (int k = 0; k < 3; ++k)
  {
    weights[k] = first[k];
  }
  weights[3] = 1.0 - first.x - first.y - first.z;
  return true;
}

// The depth of a point in a tetrahedron; negative outside.
double FindDepth(const std::array<glm::dvec3, 4>& q, const glm::dvec3& point)
{
  double depth = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 4; ++k)
  {
    const glm::dvec3& a = q[(k + 1) % 4];
    const glm::dvec3 normal = glm::normalize(glm::cross(q[(k + 2) % 4] - a, q[(k + 3) % 4] - a));
    const double side = glm::dot(normal, q[k] - a) > 0.0 ? 1.0 : -1.0;
    depth = std::min(depth, side * glm::dot(normal, point - a));
  }
  return depth;
}

std::int64_t GetVoxel(const Extent& e, int x, int y, int z)
{
  return ((z - e[4]) * GetSize(e, 1) + y - e[2]) * GetSize(e, 0) + x - e[0];
}

// Whether the volume exists at a rest coordinate: 1, 0, or -1 near a boundary. Finds the
// tetrahedron and its weights.
int FindSource(const TightMesh& mesh, const glm::dvec3& rest, TightVoxel& voxel)
{
  const Extent& e = mesh.Grid.VertexExtent;
  int cell[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    const double low = rest[axis] - e[2 * axis];
    const double high = e[2 * axis + 1] - rest[axis];
    if (std::min(low, high) < -Margin)
    {
      return 0;
    }
    if (std::min(low, high) < Margin)
    {
      return -1;
    }
    cell[axis] = static_cast<int>(std::floor(rest[axis]));
  }
  const std::int64_t number =
    ((cell[2] - e[4]) * (GetSize(e, 1) - 1) + cell[1] - e[2]) * (GetSize(e, 0) - 1) + cell[0] -
    e[0];
  const bool hasMasks = !mesh.Active.empty() || !mesh.Blanked.empty() || !mesh.Distances.empty();
  for (int t = 0; t < 5; ++t)
  {
    std::array<glm::dvec3, 4> corners;
    std::array<std::int64_t, 4> voxels;
    for (int k = 0; k < 4; ++k)
    {
      int corner[3];
      for (int axis = 0; axis < 3; ++axis)
      {
        const int offset = Split[t][k][axis];
        corner[axis] = cell[axis] + (cell[axis] & 1 ? 1 - offset : offset);
      }
      corners[static_cast<std::size_t>(k)] = glm::dvec3(corner[0], corner[1], corner[2]);
      voxels[static_cast<std::size_t>(k)] = GetVoxel(e, corner[0], corner[1], corner[2]);
    }
    double weights[4];
    FindWeights(corners, rest, weights);
    if (*std::min_element(weights, weights + 4) < 0.0)
    {
      continue;
    }
    if (hasMasks && FindDepth(corners, rest) < 2 * Margin)
    {
      return -1;
    }
    double distance = 1.0;
    bool isBlanked = false;
    if (!mesh.Distances.empty())
    {
      distance = 0.0;
    }
    for (std::size_t k = 0; k < 4; ++k)
    {
      const auto v = static_cast<std::size_t>(voxels[k]);
      isBlanked = isBlanked || (!mesh.Blanked.empty() && mesh.Blanked[v]);
      distance += mesh.Distances.empty() ? 0.0 : weights[k] * mesh.Distances[v];
      voxel.Voxels[k] = voxels[k];
      voxel.Weights[k] = weights[k];
    }
    if (isBlanked ||
      (!mesh.Active.empty() && !(mesh.Active[static_cast<std::size_t>(number)] >> t & 1)))
    {
      return 0;
    }
    return std::abs(distance) < 4 * Margin ? -1 : distance > 0.0 ? 1 : 0;
  }
  return -1;
}

} // namespace

glm::dvec3 TightMesh::GetDeformed(std::int32_t node) const
{
  const auto i = static_cast<std::size_t>(node);
  glm::dvec3 place = PlaceInOutput(this->Grid.ToOutput, this->Points[i]);
  for (int axis = 0; axis < 3; ++axis)
  {
    place[axis] += static_cast<double>(this->Displacements[3 * i + static_cast<std::size_t>(axis)]);
  }
  return place;
}

void TightMesh::Move(const std::function<glm::dvec3(const glm::dvec3&)>& displacement)
{
  this->Displacements.clear();
  for (const glm::dvec3& point : this->Points)
  {
    const glm::dvec3 d = displacement(point);
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Displacements.push_back(static_cast<float>(d[axis]));
    }
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t node = 0; node < this->Points.size(); ++node)
    {
      const double place = this->GetDeformed(static_cast<std::int32_t>(node))[axis];
      low = std::min(low, place);
      high = std::max(high, place);
    }
    this->Output[static_cast<std::size_t>(2 * axis)] = static_cast<int>(std::floor(low)) - 1;
    this->Output[static_cast<std::size_t>(2 * axis + 1)] = static_cast<int>(std::ceil(high)) + 1;
  }
}

TightMesh MakeTightMesh(const Extent& volume, double edge, const glm::dmat3& turn,
  const glm::dvec3& middle, const std::function<bool(const glm::dvec3&)>& isInside)
{
  TightMesh mesh;
  mesh.Grid.VertexExtent = volume;
  double size = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    size = std::max(size, static_cast<double>(GetSize(volume, axis)));
  }
  const int steps = static_cast<int>(std::ceil(size / edge)) + 1;
  std::map<std::array<int, 3>, std::int32_t> nodes;
  const auto place = [&](double x, double y, double z)
  { return middle + turn * (edge * glm::dvec3(x, y, z)); };
  const auto getNode = [&](int x, int y, int z)
  {
    const auto found = nodes.try_emplace({ { x, y, z } }, static_cast<std::int32_t>(nodes.size()));
    if (found.second)
    {
      mesh.Points.push_back(place(x, y, z));
    }
    return found.first->second;
  };
  static constexpr int paths[6][2] = { { 1, 3 }, { 1, 5 }, { 2, 3 }, { 2, 6 }, { 4, 5 }, { 4, 6 } };
  for (int z = -steps; z < steps; ++z)
  {
    for (int y = -steps; y < steps; ++y)
    {
      for (int x = -steps; x < steps; ++x)
      {
        if (!isInside(place(x + 0.5, y + 0.5, z + 0.5)))
        {
          continue;
        }
        // The edges from corner 0 to corner 7 over two other corners.
        for (const auto& path : paths)
        {
          Tetrahedron tetrahedron;
          const int corners[4] = { 0, path[0], path[1], 7 };
          for (std::size_t k = 0; k < 4; ++k)
          {
            tetrahedron[k] =
              getNode(x + (corners[k] & 1), y + (corners[k] >> 1 & 1), z + (corners[k] >> 2));
          }
          mesh.Tetrahedra.push_back(tetrahedron);
        }
      }
    }
  }
  mesh.Move([](const glm::dvec3&) { return glm::dvec3(0.0); });
  return mesh;
}

std::vector<TightVoxel> FindTightVoxels(const TightMesh& mesh)
{
  const Extent& e = mesh.Output;
  std::vector<TightVoxel> voxels(static_cast<std::size_t>(GetNumberOfPoints(e)));
  std::vector<double> deepest(voxels.size(), -std::numeric_limits<double>::infinity());
  std::vector<int> holding(voxels.size(), 0);
  std::vector<std::array<glm::dvec3, 4>> deformed;
  for (const Tetrahedron& tetrahedron : mesh.Tetrahedra)
  {
    std::array<glm::dvec3, 4> q;
    std::array<glm::dvec3, 4> rest;
    for (std::size_t k = 0; k < 4; ++k)
    {
      q[k] = mesh.GetDeformed(tetrahedron[k]);
      rest[k] = mesh.Points[static_cast<std::size_t>(tetrahedron[k])];
    }
    deformed.push_back(q);
    int first[3];
    int last[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      const auto ends = std::minmax({ q[0][axis], q[1][axis], q[2][axis], q[3][axis] });
      first[axis] = std::max(static_cast<int>(std::ceil(ends.first - 1.0)), e[2 * axis]);
      last[axis] = std::min(static_cast<int>(std::floor(ends.second + 1.0)), e[2 * axis + 1]);
    }
    for (int z = first[2]; z <= last[2]; ++z)
    {
      for (int y = first[1]; y <= last[1]; ++y)
      {
        for (int x = first[0]; x <= last[0]; ++x)
        {
          const auto i = static_cast<std::size_t>(GetVoxel(e, x, y, z));
          const glm::dvec3 point(x, y, z);
          double weights[4];
          if (!FindWeights(q, point, weights))
          {
            continue;
          }
          const double depth = FindDepth(q, point);
          holding[i] += depth > Margin ? 1 : 0;
          if (depth <= deepest[i])
          {
            continue;
          }
          deepest[i] = depth;
          if (depth >= -1e-9)
          {
            glm::dvec3 at(0.0);
            for (int k = 0; k < 4; ++k)
            {
              at += weights[k] * rest[static_cast<std::size_t>(k)];
            }
            voxels[i].Covered = FindSource(mesh, at, voxels[i]);
          }
        }
      }
    }
  }
  // Voxels on a face between tetrahedra are inside. Voxels on the surface of the mesh have nearby
  // points outside.
  for (std::size_t i = 0; i < voxels.size(); ++i)
  {
    if (deepest[i] < -Margin)
    {
      voxels[i].Covered = 0;
    }
    else if (holding[i] > 1)
    {
      voxels[i].Covered = -1;
    }
    else if (deepest[i] < Margin && voxels[i].Covered != 0)
    {
      voxels[i].Covered = deepest[i] >= -1e-9 ? voxels[i].Covered : -1;
    }
  }
  // Points around a voxel near a face decide whether it is near the surface of the mesh.
  const auto isHeld = [&](const glm::dvec3& point)
  {
    return std::any_of(deformed.begin(), deformed.end(),
      [&](const std::array<glm::dvec3, 4>& q)
      {
        for (int axis = 0; axis < 3; ++axis) // most tetrahedra are far away
        {
          const auto ends = std::minmax({ q[0][axis], q[1][axis], q[2][axis], q[3][axis] });
          if (point[axis] < ends.first - Margin || point[axis] > ends.second + Margin)
          {
            return false;
          }
        }
        double weights[4];
        return FindWeights(q, point, weights) && *std::min_element(weights, weights + 4) >= -1e-9;
      });
  };
  std::size_t i = 0;
  for (int z = e[4]; z <= e[5]; ++z)
  {
    for (int y = e[2]; y <= e[3]; ++y)
    {
      for (int x = e[0]; x <= e[1]; ++x, ++i)
      {
        if (voxels[i].Covered == 1 && deepest[i] < Margin)
        {
          for (int k = 0; k < 8; ++k)
          {
            const glm::dvec3 step(
              k & 1 ? Margin : -Margin, k & 2 ? Margin : -Margin, k & 4 ? Margin : -Margin);
            voxels[i].Covered = isHeld(glm::dvec3(x, y, z) + step) ? voxels[i].Covered : -1;
          }
        }
      }
    }
  }
  return voxels;
}

UsualArrays MakeTightArrays(const TightMesh& mesh)
{
  std::mt19937 random(5);
  UsualArrays arrays(static_cast<std::size_t>(mesh.GetNumberOfVoxels()));
  for (float& value : arrays.Floats)
  {
    value = std::uniform_real_distribution<float>(0.0F, 1.0F)(random);
  }
  return arrays;
}

void SetMasks(VolumeDeformer& deformer, const TightMesh& mesh)
{
  deformer.SetBlanked(mesh.Blanked.empty() ? nullptr : mesh.Blanked.data());
  deformer.SetActiveTetrahedra(mesh.Active.empty() ? nullptr : mesh.Active.data());
  deformer.SetBoundaryDistances(mesh.Distances.empty() ? nullptr : mesh.Distances.data());
}

void Load(VolumeDeformer& deformer, const TightMesh& mesh, StaticMappingForm form)
{
  const UsualArrays arrays = MakeTightArrays(mesh);
  deformer.SetVoxelGrid(mesh.Grid);
  deformer.SetArrays(arrays.Get());
  SetMasks(deformer, mesh);
  const StaticMapping mapping = BuildStaticMapping(
    mesh.Grid.VertexExtent, glm::dvec3(1.0), mesh.Points, mesh.Tetrahedra, false, form);
  if (mapping.Links.empty())
  {
    deformer.SetMesh(mesh.Tetrahedra.data(), mesh.Tetrahedra.size(), mesh.Points.size(),
      mapping.Runs, &mapping.Boundary);
  }
  else
  {
    deformer.SetMesh(mesh.Tetrahedra.data(), mesh.Tetrahedra.size(), mesh.Points.size(),
      mapping.Links.data(), &mapping.Boundary);
  }
  deformer.SetNodeDisplacements(mesh.Displacements.data());
}

TightOutput DeformTight(VolumeDeformer& deformer, const TightMesh& mesh, Resampling method,
  const TightOutput* last, Interpolation interpolation)
{
  TightOutput output;
  const auto count = static_cast<std::size_t>(GetNumberOfPoints(mesh.Output));
  output.Shorts.assign(count, -7);
  output.Values.assign(count, -7.0F);
  output.Labels.assign(2 * count, 7);
  output.Coverage.assign(count, 7);
  DeformRequest request;
  request.Method = method;
  request.Interpolation = interpolation;
  request.OutputExtent = mesh.Output;
  request.Outputs = { output.Shorts.data(), output.Values.data(), output.Labels.data() };
  request.Coverage = output.Coverage.data();
  request.Incremental = true;
  if (last)
  {
    request.LastOutputs = { last->Shorts.data(), last->Values.data(), last->Labels.data() };
    request.LastCoverage = last->Coverage.data();
  }
  output.Report = deformer.Deform(request);
  return output;
}

namespace
{

void CompareTight(const std::vector<TightVoxel>& voxels, const UsualArrays& arrays,
  const TightOutput& output, double bound)
{
  // Both labels of a voxel as one number.
  const auto getLabels = [](const std::vector<std::uint16_t>& labels, std::size_t voxel)
  { return labels[2 * voxel] << 16 | labels[2 * voxel + 1]; };
  std::size_t wrongCoverage = 0;
  std::size_t wrongValues = 0;
  std::size_t wrongLabels = 0;
  std::size_t open = 0;
  std::size_t covered = 0;
  double largest = 0.0;
  for (std::size_t i = 0; i < voxels.size(); ++i)
  {
    const TightVoxel& voxel = voxels[i];
    if (voxel.Covered < 0)
    {
      ++open;
      continue;
    }
    covered += voxel.Covered == 1 ? 1 : 0;
    wrongCoverage += voxel.Covered != output.Coverage[i] ? 1 : 0;
    if (voxel.Covered == 0 && output.Coverage[i] == 0)
    {
      wrongValues += output.Values[i] != 2.0F ? 1 : 0;
      wrongLabels += getLabels(output.Labels, i) != (12 << 16 | 12) ? 1 : 0;
    }
    if (voxel.Covered != 1 || output.Coverage[i] != 1)
    {
      continue;
    }
    double value = 0.0;
    double best = -1.0;
    double second = -1.0;
    int label = 0;
    for (std::size_t k = 0; k < 4; ++k)
    {
      const auto vertex = static_cast<std::size_t>(voxel.Voxels[k]);
      value += voxel.Weights[k] * arrays.Floats[vertex];
      if (voxel.Weights[k] > best)
      {
        second = best;
        best = voxel.Weights[k];
        label = getLabels(arrays.Labels, vertex);
      }
      else
      {
        second = std::max(second, voxel.Weights[k]);
      }
    }
    const double difference = std::abs(value - static_cast<double>(output.Values[i]));
    largest = std::max(largest, difference);
    wrongValues += difference > bound ? 1 : 0;
    wrongLabels += best - second > bound && label != getLabels(output.Labels, i) ? 1 : 0;
  }
  EXPECT_EQ(wrongCoverage, 0U) << "voxels with wrong coverage, of " << voxels.size();
  EXPECT_EQ(wrongValues, 0U) << "voxels with a wrong value; the largest difference is " << largest;
  EXPECT_EQ(wrongLabels, 0U);
  EXPECT_GT(covered, 20U);
  EXPECT_LT(open, voxels.size() / 4);
  EXPECT_EQ(output.Report.NumberOfCoveredVoxels,
    std::count(output.Coverage.begin(), output.Coverage.end(), 1));
}

} // namespace

void ExpectTight(const TightMesh& mesh, const std::vector<TightOutput>& outputs, double bound)
{
  const std::vector<TightVoxel> voxels = FindTightVoxels(mesh);
  const UsualArrays arrays = MakeTightArrays(mesh);
  for (std::size_t number = 0; number < outputs.size(); ++number)
  {
    SCOPED_TRACE(testing::Message() << "output " << number);
    CompareTight(voxels, arrays, outputs[number], bound);
  }
}

void ExpectSame(const TightOutput& one, const TightOutput& other)
{
  EXPECT_EQ(one.Coverage, other.Coverage);
  EXPECT_EQ(one.Labels, other.Labels);
  EXPECT_EQ(one.Shorts, other.Shorts);
  ASSERT_EQ(one.Values.size(), other.Values.size());
  EXPECT_EQ(
    std::memcmp(one.Values.data(), other.Values.data(), one.Values.size() * sizeof(float)), 0);
  EXPECT_EQ(one.Report.NumberOfCoveredVoxels, other.Report.NumberOfCoveredVoxels);
  EXPECT_EQ(one.Report.NumberOfInvertedTetrahedra, other.Report.NumberOfInvertedTetrahedra);
}
