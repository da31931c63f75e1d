// SPDX-License-Identifier: BSD-3-Clause
#include "MeshBounds.h"

#include "BarycentricMap.h"
#include "ParallelFor.h"
#include "TetrahedronClipping.h"

#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <atomic>

namespace deformvolume
{

namespace
{

constexpr std::size_t NodeBlock = 512;
constexpr std::size_t ClippedBlock = 64; // to clip a tetrahedron takes some hundred times as long

std::size_t CountBlocks(std::size_t size, std::size_t block)
{
  return (size + block - 1) / block;
}

// For each block of nodes whether one of them is in the ranges.
std::vector<unsigned char> MarkBlocks(const PointRanges* ranges, std::size_t blocks)
{
  if (!ranges)
  {
    return std::vector<unsigned char>(blocks, 1);
  }
  std::vector<unsigned char> marked(blocks, 0);
  for (const auto& range : *ranges)
  {
    const std::size_t end = std::min(CountBlocks(range[1], NodeBlock), blocks);
    for (std::size_t block = range[0] / NodeBlock; block < end; ++block)
    {
      marked[block] = 1;
    }
  }
  return marked;
}

} // namespace

void MeshBounds::SetMesh(const VoxelGrid& voxelGrid, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra)
{
  const IndexBounds box = GetBox(voxelGrid);
  const auto isInside = [&](std::int32_t node)
  {
    return glm::all(glm::greaterThanEqual(restPoints[node], box.Min)) &&
      glm::all(glm::lessThanEqual(restPoints[node], box.Max));
  };
  // Bytes, which several threads may set to the same.
  std::vector<unsigned char> clipped(tetrahedra.size(), 0);
  std::vector<std::atomic<unsigned char>> wanted(restPoints.size());
  ParallelFor(0, static_cast<std::int64_t>(tetrahedra.size()), 0,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t id = begin; id < end; ++id)
      {
        const Tetrahedron& nodes = tetrahedra[id];
        if (!std::all_of(nodes.begin(), nodes.end(), isInside))
        {
          clipped[id] = 1;
          continue;
        }
        BarycentricMap map;
        if (map.SetTetrahedron(nodes, restPoints)) // not flat
        {
          for (const std::int32_t node : nodes)
          {
            wanted[node].store(1, std::memory_order_relaxed);
          }
        }
      }
    });
  *this = MeshBounds();
  this->Shape = voxelGrid;
  for (std::size_t id = 0; id < clipped.size(); ++id)
  {
    if (clipped[id])
    {
      this->ClippedTetrahedra.push_back(static_cast<std::int32_t>(id));
    }
  }
  for (std::size_t node = 0; node < wanted.size(); ++node)
  {
    if (node % NodeBlock == 0)
    {
      this->NodeBegins.push_back(this->Nodes.size());
    }
    if (wanted[node])
    {
      this->Nodes.push_back(static_cast<std::int32_t>(node));
    }
  }
  this->NodeBounds.resize(this->NodeBegins.size());
  this->NodeBegins.push_back(this->Nodes.size());
  this->ClippedBounds.resize(CountBlocks(this->ClippedTetrahedra.size(), ClippedBlock));
}

IndexBounds MeshBounds::Compute(const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements,
  const PointRanges* changes)
{
  const std::vector<unsigned char> changed =
    MarkBlocks(this->IsComputed ? changes : nullptr, this->NodeBounds.size());
  this->IsComputed = false; // half done, if this ends early
  const IndexBounds box = GetBox(this->Shape);
  const glm::dvec3 scale = GetScale(this->Shape);
  const auto move = [&](std::int32_t node)
  { return scale * restPoints[node] + GetVector(displacements, node); };
  const auto addNodes = [&](std::size_t block)
  {
    IndexBounds bounds;
    for (std::size_t i = this->NodeBegins[block]; i < this->NodeBegins[block + 1]; ++i)
    {
      const glm::dvec3 moved = move(this->Nodes[i]);
      if (IsFinite(moved))
      {
        bounds.Add(moved);
      }
    }
    this->NodeBounds[block] = bounds;
  };
  const auto addClipped = [&](const Tetrahedron& tetrahedron, IndexBounds& bounds)
  {
    std::array<MovedPoint, 4> nodes;
    for (int node = 0; node < 4; ++node)
    {
      nodes[node].Rest = restPoints[tetrahedron[node]];
      nodes[node].Moved = move(tetrahedron[node]);
      if (!IsFinite(nodes[node].Moved))
      {
        return;
      }
    }
    BarycentricMap map;
    if (map.SetTetrahedron(tetrahedron, restPoints))
    {
      AddClippedTetrahedron(nodes, map, box, bounds);
    }
  };
  const auto clip = [&](std::size_t block)
  {
    const std::size_t begin = block * ClippedBlock;
    const std::size_t end = std::min(begin + ClippedBlock, this->ClippedTetrahedra.size());
    bool isChanged = false;
    for (std::size_t i = begin; i < end && !isChanged; ++i)
    {
      const Tetrahedron& nodes = tetrahedra[this->ClippedTetrahedra[i]];
      isChanged = std::any_of(nodes.begin(), nodes.end(),
        [&](std::int32_t node) { return changed[static_cast<std::size_t>(node) / NodeBlock]; });
    }
    if (!isChanged)
    {
      return;
    }
    IndexBounds bounds;
    for (std::size_t i = begin; i < end; ++i)
    {
      addClipped(tetrahedra[this->ClippedTetrahedra[i]], bounds);
    }
    this->ClippedBounds[block] = bounds;
  };
  const std::size_t blocks = this->NodeBounds.size();
  ParallelFor(0, static_cast<std::int64_t>(blocks + this->ClippedBounds.size()), 0,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      {
        if (i >= blocks)
        {
          clip(i - blocks);
        }
        else if (changed[i])
        {
          addNodes(i);
        }
      }
    });
  this->IsComputed = true;
  IndexBounds all;
  for (const std::vector<IndexBounds>* parts : { &this->NodeBounds, &this->ClippedBounds })
  {
    for (const IndexBounds& bounds : *parts)
    {
      all.Add(bounds);
    }
  }
  return all;
}

IndexBounds ComputeDeformedBounds(const VoxelGrid& voxelGrid,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  const float* displacements)
{
  MeshBounds bounds;
  bounds.SetMesh(voxelGrid, restPoints, tetrahedra);
  return bounds.Compute(restPoints, tetrahedra, displacements);
}

} // namespace deformvolume
