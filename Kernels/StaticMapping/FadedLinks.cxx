// SPDX-License-Identifier: BSD-3-Clause
#include "FadedLinks.h"

#include "BarycentricMap.h"
#include "ClosestFace.h"
#include "Error.h"
#include "OutsideVoxels.h" // for GetFadedWeight
#include "ParallelFor.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>

namespace deformvolume
{

namespace
{

constexpr int BlockSize = 8; // voxels on an axis

glm::dvec3 GetPoint(const std::vector<glm::dvec3>& points, std::int32_t node)
{
  return points[static_cast<std::size_t>(node)];
}

} // namespace

void FadedLinks::Link(const Extent& voxels, const glm::dvec3& spacing,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  double fadeDistance, std::vector<VertexLink>& links, const std::function<void(double)>& progress)
{
  *this = FadedLinks();
  this->FadeDistance = fadeDistance;
  if (fadeDistance > 0.0)
  {
    this->Faces =
      FindBoundaryFaces(restPoints, tetrahedra, FindSolidTetrahedra(restPoints, tetrahedra));
  }
  if (tetrahedra.size() + this->Faces.size() >=
    static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
  {
    throw Error("The voxels outside the deformation mesh cannot be kept: the mesh has " +
      std::to_string(tetrahedra.size()) + " tetrahedra and " + std::to_string(this->Faces.size()) +
      " boundary faces, but together fewer than 2^31 - 1 are possible. Use a coarser mesh.");
  }
  this->LinkRows(
    voxels, spacing, restPoints, tetrahedra, links, [&](double done) { progress(0.9 * done); });
  this->DropUnused(tetrahedra.size(), links);
  this->FindBlocks(voxels, tetrahedra.size(), links);
  progress(0.95);
  this->Stretched.Find(voxels, spacing, restPoints, tetrahedra, this->Faces, links);
  progress(1.0);
}

void FadedLinks::LinkRows(const Extent& voxels, const glm::dvec3& spacing,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  std::vector<VertexLink>& links, const std::function<void(double)>& progress)
{
  std::vector<ClosestFace::Triangle> triangles;
  for (const TetrahedronFace& face : this->Faces)
  {
    const auto nodes = face.GetNodes(tetrahedra[static_cast<std::size_t>(face.Tetrahedron)]);
    triangles.push_back({ { spacing * GetPoint(restPoints, nodes[0]),
      spacing * GetPoint(restPoints, nodes[1]), spacing * GetPoint(restPoints, nodes[2]) } });
  }
  const ClosestFace search(std::move(triangles));
  const auto still = static_cast<std::int32_t>(tetrahedra.size());
  const std::int64_t size = GetSize(voxels, 0);
  const double stepLength = std::abs(spacing.x);
  const auto linkRow = [&](std::int64_t row)
  {
    VertexLink* link = links.data() + row * size;
    glm::dvec3 index(
      0.0, voxels[2] + row % GetSize(voxels, 1), voxels[4] + row / GetSize(voxels, 1));
    std::int32_t nearby = -1;
    std::int64_t farUntil = 0; // voxels of the row before this index are beyond the fade distance
    for (std::int64_t x = 0; x < size; ++x, ++link)
    {
      if (link->Tetrahedron >= 0)
      {
        continue;
      }
      *link = MakeLink(still, glm::dvec3(0.0));
      if (this->Faces.empty() || x < farUntil)
      {
        continue;
      }
      index.x = static_cast<double>(voxels[0] + x);
      const ClosestFace::Result closest = search.Find(spacing * index, nearby);
      nearby = closest.Face;
      const double distance = std::sqrt(closest.SquaredDistance);
      const double weight = GetFadedWeight(distance / this->FadeDistance);
      if (weight > 0.0)
      {
        *link = MakeLink(still + 1 + closest.Face, weight * closest.Weights);
      }
      else
      {
        // From voxel to voxel, the distance decreases at most by the step between them.
        const double steps = (distance - this->FadeDistance) * (1.0 - 1e-9) / stepLength;
        farUntil = x + static_cast<std::int64_t>(std::min(steps, 1e9));
      }
    }
  };
  const std::int64_t rows = GetSize(voxels, 1) * GetSize(voxels, 2);
  constexpr int parts = 16;
  for (int part = 0; part < parts; ++part)
  {
    const std::int64_t first = rows * part / parts;
    ParallelForItems(
      rows * (part + 1) / parts - first, 16, [&](std::int64_t row) { linkRow(first + row); });
    progress((part + 1.0) / parts);
  }
}

void FadedLinks::DropUnused(std::size_t numberOfTetrahedra, std::vector<VertexLink>& links)
{
  if (this->Faces.empty())
  {
    return;
  }
  const auto first = static_cast<std::int32_t>(numberOfTetrahedra) + 1;
  std::vector<std::atomic<unsigned char>> used(this->Faces.size());
  ParallelForItems(links.size(), 1 << 16,
    [&](std::size_t i)
    {
      if (links[i].Tetrahedron >= first)
      {
        used[static_cast<std::size_t>(links[i].Tetrahedron - first)].store(
          1, std::memory_order_relaxed);
      }
    });
  std::vector<TetrahedronFace> kept;
  std::vector<std::int32_t> numbers(this->Faces.size(), -1);
  for (std::size_t face = 0; face < this->Faces.size(); ++face)
  {
    if (used[face] != 0)
    {
      numbers[face] = static_cast<std::int32_t>(kept.size());
      kept.push_back(this->Faces[face]);
    }
  }
  ParallelForItems(links.size(), 1 << 16,
    [&](std::size_t i)
    {
      std::int32_t& number = links[i].Tetrahedron;
      if (number >= first)
      {
        number = first + numbers[static_cast<std::size_t>(number - first)];
      }
    });
  this->Faces = std::move(kept);
}

Tetrahedron FadedLinks::GetFadedTetrahedron(
  std::size_t index, const std::vector<Tetrahedron>& tetrahedra, std::int32_t still) const
{
  if (index == 0)
  {
    return { { still, still, still, still } };
  }
  const TetrahedronFace& face = this->Faces[index - 1];
  const auto nodes = face.GetNodes(tetrahedra[static_cast<std::size_t>(face.Tetrahedron)]);
  return { { nodes[0], nodes[1], nodes[2], still } };
}

void FadedLinks::FindBlocks(
  const Extent& voxels, std::size_t numberOfTetrahedra, const std::vector<VertexLink>& links)
{
  const auto still = static_cast<std::int32_t>(numberOfTetrahedra);
  const std::int64_t size = GetSize(voxels, 0);
  const std::int64_t plane = size * GetSize(voxels, 1);
  struct Layer
  {
    std::vector<Block> Blocks;
    std::vector<std::int32_t> Faces;
    Extent Still = EmptyExtent;
  };
  const auto count = [&](int axis)
  { return static_cast<int>((GetSize(voxels, axis) + BlockSize - 1) / BlockSize); };
  std::vector<Layer> layers(static_cast<std::size_t>(count(2)));
  const auto findBlock = [&](const std::array<int, 3>& index, Layer& layer)
  {
    Block block;
    block.Voxels = EmptyExtent;
    block.GreatestWeight = 0.0;
    const std::size_t first = layer.Faces.size();
    std::int32_t last = -1;
    Extent all;
    for (int axis = 0; axis < 3; ++axis)
    {
      all[2 * axis] = voxels[2 * axis] + index[axis] * BlockSize;
      all[2 * axis + 1] = std::min(all[2 * axis] + BlockSize - 1, voxels[2 * axis + 1]);
    }
    ForEachPoint(all,
      [&](int x, int y, int z)
      {
        const VertexLink& link = links[static_cast<std::size_t>(
          (z - voxels[4]) * plane + (y - voxels[2]) * size + x - voxels[0])];
        if (link.Tetrahedron < still)
        {
          return;
        }
        const Extent voxel{ { x, x, y, y, z, z } };
        if (link.Tetrahedron == still)
        {
          Include(layer.Still, voxel);
          return;
        }
        Include(block.Voxels, voxel);
        const double weight =
          double{ link.Weights[0] } + double{ link.Weights[1] } + double{ link.Weights[2] };
        block.GreatestWeight = std::max(block.GreatestWeight, weight);
        if (link.Tetrahedron != last)
        {
          last = link.Tetrahedron;
          layer.Faces.push_back(last - still - 1);
        }
      });
    if (layer.Faces.size() > first)
    {
      const auto begin = layer.Faces.begin() + static_cast<std::ptrdiff_t>(first);
      std::sort(begin, layer.Faces.end());
      layer.Faces.erase(std::unique(begin, layer.Faces.end()), layer.Faces.end());
      block.FacesEnd = layer.Faces.size();
      layer.Blocks.push_back(block);
    }
  };
  ParallelForItems(count(2), 1,
    [&](int k)
    {
      ForEachPoint({ { 0, count(0) - 1, 0, count(1) - 1, k, k } },
        [&](int i, int j, int) {
          findBlock({ { i, j, k } }, layers[static_cast<std::size_t>(k)]);
        });
    });
  for (const Layer& layer : layers)
  {
    for (Block block : layer.Blocks)
    {
      block.FacesEnd += this->FacesOfBlocks.size();
      this->Blocks.push_back(block);
    }
    this->FacesOfBlocks.insert(this->FacesOfBlocks.end(), layer.Faces.begin(), layer.Faces.end());
    if (GetNumberOfPoints(layer.Still) > 0)
    {
      Include(this->StillVoxels, layer.Still);
    }
  }
}

IndexBounds FadedLinks::ComputeBounds(const VoxelGrid& voxelGrid,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements) const
{
  const OutputTransform transform = GetOutputTransform(voxelGrid);
  const auto move = [&](const Extent& voxels, double weight, const IndexBounds& displacement)
  {
    IndexBounds moved = transform.ToOutput(GetBox(voxels));
    moved.Min += weight * displacement.Min;
    moved.Max += weight * displacement.Max;
    return moved;
  };
  const auto add = [&](const TetrahedronFace& face, IndexBounds& displacement)
  {
    for (const std::int32_t node :
      face.GetNodes(tetrahedra[static_cast<std::size_t>(face.Tetrahedron)]))
    {
      const glm::dvec3 moved = GetVector(displacements, node);
      if (IsFinite(moved))
      {
        displacement.Add(moved);
      }
    }
  };
  IndexBounds none;
  none.Add(glm::dvec3(0.0));
  IndexBounds most = none;
  for (const TetrahedronFace& face : this->Faces)
  {
    add(face, most);
  }
  IndexBounds bounds;
  if (GetNumberOfPoints(this->StillVoxels) > 0)
  {
    bounds = move(this->StillVoxels, 0.0, none);
  }
  std::size_t begin = 0;
  for (const Block& block : this->Blocks)
  {
    // Most blocks do not enlarge the bounds, even with the largest displacements of all faces.
    const IndexBounds widest = move(block.Voxels, block.GreatestWeight, most);
    const bool isInside = bounds.Contains(widest);
    IndexBounds displacement = none;
    for (std::size_t face = begin; face < block.FacesEnd && !isInside; ++face)
    {
      add(this->Faces[static_cast<std::size_t>(this->FacesOfBlocks[face])], displacement);
    }
    begin = block.FacesEnd;
    if (!isInside)
    {
      bounds.Add(move(block.Voxels, block.GreatestWeight, displacement));
    }
  }
  return bounds;
}

glm::dvec3 FadedLinks::Displace(const VertexLink& link, const std::vector<Tetrahedron>& tetrahedra,
  const float* displacements) const
{
  const auto number = static_cast<std::size_t>(link.Tetrahedron);
  glm::dvec3 sum(0.0);
  if (number == tetrahedra.size())
  {
    return sum;
  }
  const auto add = [&](double weight, std::int32_t node)
  { sum += weight * GetVector(displacements, node); };
  const bool isInside = number < tetrahedra.size();
  const TetrahedronFace face =
    isInside ? TetrahedronFace{ link.Tetrahedron, 3 } : this->Faces[number - tetrahedra.size() - 1];
  const Tetrahedron& all = tetrahedra[static_cast<std::size_t>(face.Tetrahedron)];
  const auto nodes = face.GetNodes(all);
  double rest = 1.0;
  for (std::size_t k = 0; k < 3; ++k)
  {
    add(double{ link.Weights[k] }, nodes[k]);
    rest -= double{ link.Weights[k] };
  }
  if (isInside)
  {
    add(rest, all[3]);
  }
  return sum;
}

std::int64_t FadedLinks::CountStretched(const std::vector<Tetrahedron>& tetrahedra,
  const float* displacements,
  const std::function<bool(const StretchedTetrahedra::Candidate&)>& isWhole) const
{
  return this->Stretched.Count(*this, tetrahedra, displacements, isWhole);
}

double FadedLinks::GetLongestDisplacement(const std::vector<Tetrahedron>& tetrahedra,
  const float* displacements, const glm::dvec3& spacing) const
{
  double longest = 0.0;
  for (const TetrahedronFace& face : this->Faces)
  {
    for (const std::int32_t node :
      face.GetNodes(tetrahedra[static_cast<std::size_t>(face.Tetrahedron)]))
    {
      longest = std::max(longest, glm::length(spacing * GetVector(displacements, node)));
    }
  }
  return longest;
}

} // namespace deformvolume
