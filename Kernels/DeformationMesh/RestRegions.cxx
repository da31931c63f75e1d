// SPDX-License-Identifier: BSD-3-Clause
#include "RestRegions.h"

#include "BarycentricMap.h"
#include "ParallelFor.h"

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>

namespace deformvolume
{

namespace
{

// In voxels: how far a voxel may lie outside the tetrahedron to which it is linked. Nodes are
// rounded to 1/256 voxel when links are computed.
constexpr double LinkTolerance = 1.0 / 64.0;
// In output voxels: an upper bound of the rounding of positions in the kernels.
constexpr double PositionTolerance = 1.0 / 32.0;

constexpr std::int64_t MostRegions = std::int64_t{ 1 } << 17;

} // namespace

RestRegions::RestRegions(const VoxelGrid& voxelGrid)
  : Volume(voxelGrid.VertexExtent)
  , Transform(GetOutputTransform(voxelGrid))
{
  for (;; this->Size *= 2)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const std::int64_t cells = std::max<std::int64_t>(1, GetSize(this->Volume, axis) - 1);
      this->Count[axis] = static_cast<int>((cells + this->Size - 1) / this->Size);
    }
    if (this->GetNumberOfRegions() <= MostRegions)
    {
      break;
    }
  }
  this->Bounds.resize(this->GetNumberOfRegions());
}

std::int64_t RestRegions::GetNumberOfRegions() const
{
  return static_cast<std::int64_t>(this->Count[0]) * this->Count[1] * this->Count[2];
}

Extent RestRegions::GetVoxels(std::int64_t region) const
{
  Extent voxels;
  for (int axis = 0; axis < 3; ++axis)
  {
    const auto index = static_cast<int>(region % this->Count[axis]);
    region /= this->Count[axis];
    voxels[2 * axis] = this->Volume[2 * axis] + index * this->Size;
    voxels[2 * axis + 1] = std::min(voxels[2 * axis] + this->Size, this->Volume[2 * axis + 1]);
  }
  return voxels;
}

RestRegions::RestRegions(const VoxelGrid& voxelGrid, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements)
  : RestRegions(voxelGrid)
{
  for (const Tetrahedron& tetrahedron : tetrahedra)
  {
    this->AddTetrahedron(tetrahedron, restPoints, displacements);
  }
}

void RestRegions::AddTetrahedron(const Tetrahedron& tetrahedron,
  const std::vector<glm::dvec3>& restPoints, const float* displacements)
{
  BarycentricMap map;
  if (!map.SetTetrahedron(tetrahedron, restPoints))
  {
    return; // no voxel is linked to a flat tetrahedron
  }
  IndexBounds rest;
  IndexBounds moved;
  glm::dvec3 nodes[4];
  for (int node = 0; node < 4; ++node)
  {
    const glm::dvec3& point = restPoints[tetrahedron[node]];
    nodes[node] = this->Transform.ToOutput(point) + GetVector(displacements, tetrahedron[node]);
    rest.Add(point);
    moved.Add(nodes[node]);
  }
  // Linked voxels slightly outside the tetrahedron have negative weights. Therefore they also lie
  // outside the deformed tetrahedron. outside: an upper bound of the sum of these weights. Column k
  // of steps: deformed step between neighboring voxels on axis k.
  double outside = 0.0;
  glm::dmat3 steps(0.0);
  for (int node = 0; node < 4; ++node)
  {
    const glm::dvec3 gradient = map.GetGradient(node);
    outside += LinkTolerance * (std::abs(gradient.x) + std::abs(gradient.y) + std::abs(gradient.z));
    for (int axis = 0; axis < 3; ++axis)
    {
      steps[axis] += gradient[axis] * nodes[node];
    }
  }
  const glm::dvec3 widening = outside * (moved.Max - moved.Min);
  moved.Min -= widening;
  moved.Max += widening;
  rest.Min -= LinkTolerance;
  rest.Max += LinkTolerance;

  Extent regions;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double first = this->Volume[2 * axis];
    const double last = this->Volume[2 * axis + 1];
    const double low = std::max(rest.Min[axis], first);
    const double high = std::min(rest.Max[axis], last);
    if (!(low <= high))
    {
      return;
    }
    // Neighboring regions share the voxels between them.
    regions[2 * axis] = std::max(0, static_cast<int>(std::ceil((low - first) / this->Size)) - 1);
    regions[2 * axis + 1] =
      std::min(this->Count[axis] - 1, static_cast<int>(std::floor((high - first) / this->Size)));
  }
  ForEachPoint(regions,
    [&](int x, int y, int z)
    {
      const std::int64_t region =
        (static_cast<std::int64_t>(z) * this->Count[1] + y) * this->Count[0] + x;
      const IndexBounds whole = GetBox(this->GetVoxels(region));
      const IndexBounds box{ glm::max(whole.Min, rest.Min), glm::min(whole.Max, rest.Max) };
      // The deformation of the box is affine: its bounds follow from the center and half sizes.
      const glm::dvec3 center = 0.5 * (box.Min + box.Max);
      const glm::dvec3 half = 0.5 * (box.Max - box.Min);
      const glm::dvec4 weights = map.GetAllWeights(center);
      glm::dvec3 position(0.0);
      for (int node = 0; node < 4; ++node)
      {
        position += weights[node] * nodes[node];
      }
      const glm::dvec3 spread =
        glm::abs(steps[0]) * half.x + glm::abs(steps[1]) * half.y + glm::abs(steps[2]) * half.z;
      IndexBounds landing;
      landing.Min = glm::max(position - spread, moved.Min);
      landing.Max = glm::min(position + spread, moved.Max);
      if (landing.Min.x <= landing.Max.x && landing.Min.y <= landing.Max.y &&
        landing.Min.z <= landing.Max.z)
      {
        this->Bounds[region].Add(landing);
      }
    });
}

RestRegions::RestRegions(const VoxelGrid& voxelGrid, const DisplacementField& field)
  : RestRegions(voxelGrid)
{
  ParallelForItems(this->GetNumberOfRegions(), 16,
    [&](std::int64_t region)
    {
      const Extent voxels = this->GetVoxels(region);
      Extent points;
      bool hasOutside = false;
      for (int axis = 0; axis < 3; ++axis)
      {
        const double* row = &field.IndexToField[4 * axis];
        double from = row[3];
        double to = row[3];
        for (int k = 0; k < 3; ++k)
        {
          from += std::min(row[k] * voxels[2 * k], row[k] * voxels[2 * k + 1]);
          to += std::max(row[k] * voxels[2 * k], row[k] * voxels[2 * k + 1]);
        }
        // The device computes positions in single precision, with an error far below this margin.
        constexpr double margin = 0.25;
        const double end = field.Dimensions[axis] - 1;
        hasOutside = hasOutside || from < 0.0 || to > end;
        points[2 * axis] = static_cast<int>(glm::clamp(std::floor(from - margin), 0.0, end));
        points[2 * axis + 1] = static_cast<int>(glm::clamp(std::ceil(to + margin), 0.0, end));
      }
      IndexBounds displacement;
      if (hasOutside && IsFading(field))
      {
        displacement.Add(glm::dvec3(0.0));
      }
      ForEachPoint(points,
        [&](int x, int y, int z)
        {
          const std::int64_t row = static_cast<std::int64_t>(z) * field.Dimensions[1] + y;
          displacement.Add(GetVector(field, row * field.Dimensions[0] + x));
        });
      IndexBounds& bounds = this->Bounds[region];
      const IndexBounds rest = this->Transform.ToOutput(GetBox(voxels));
      bounds.Add(rest.Min + displacement.Min);
      bounds.Add(rest.Max + displacement.Max);
    });
}

bool RestRegions::HasVoxels() const
{
  return std::any_of(this->Bounds.begin(), this->Bounds.end(),
    [](const IndexBounds& bounds) { return !bounds.IsEmpty(); });
}

Extent RestRegions::Find(const Extent& part) const
{
  Extent found = EmptyExtent;
  for (std::int64_t region = 0; region < this->GetNumberOfRegions(); ++region)
  {
    const IndexBounds& bounds = this->Bounds[region];
    bool lands = !bounds.IsEmpty();
    for (int axis = 0; axis < 3; ++axis)
    {
      lands = lands && bounds.Min[axis] - PositionTolerance <= part[2 * axis + 1] &&
        bounds.Max[axis] + PositionTolerance >= part[2 * axis];
    }
    if (lands)
    {
      Include(found, this->GetVoxels(region));
    }
  }
  if (GetNumberOfPoints(found) == 0)
  {
    found = this->GetVoxels(0);
    for (int axis = 0; axis < 3; ++axis)
    {
      found[2 * axis + 1] = std::min(found[2 * axis + 1], found[2 * axis] + 1);
    }
  }
  // A cell depends on the state of its vertices, which depends on the voxels around them.
  for (int axis = 0; axis < 3; ++axis)
  {
    found[2 * axis] = std::max(found[2 * axis] - 1, this->Volume[2 * axis]);
    found[2 * axis + 1] = std::min(found[2 * axis + 1] + 1, this->Volume[2 * axis + 1]);
  }
  found[0] = this->Volume[0];
  found[1] = this->Volume[1];
  return found;
}

} // namespace deformvolume
