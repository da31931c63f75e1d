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
constexpr std::size_t ClippedBlock =
  64; // smaller, since clipping takes about a hundred times longer

std::size_t CountBlocks(std::size_t size, std::size_t block)
{
  return (size + block - 1) / block;
}

bool IsInside(
  const Tetrahedron& nodes, const std::vector<glm::dvec3>& restPoints, const IndexBounds& box)
{
  return std::all_of(nodes.begin(), nodes.end(),
    [&](std::int32_t node)
    {
      return glm::all(glm::greaterThanEqual(restPoints[node], box.Min)) &&
        glm::all(glm::lessThanEqual(restPoints[node], box.Max));
    });
}

bool IsFlat(const Tetrahedron& nodes, const std::vector<glm::dvec3>& restPoints)
{
  BarycentricMap map;
  return !map.SetTetrahedron(nodes, restPoints);
}

} // namespace

void MeshBounds::SetMesh(const VoxelGrid& voxelGrid, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra)
{
  const IndexBounds box = GetBox(voxelGrid);
  // Bytes, not bits, so that several threads can set neighboring elements.
  std::vector<unsigned char> clipped(tetrahedra.size(), 0);
  std::vector<std::atomic<std::uint32_t>> uses(restPoints.size());
  ParallelForItems(tetrahedra.size(), 4096,
    [&](std::size_t id)
    {
      const Tetrahedron& nodes = tetrahedra[id];
      if (!IsInside(nodes, restPoints, box))
      {
        clipped[id] = 1;
      }
      else if (!IsFlat(nodes, restPoints))
      {
        for (const std::int32_t node : nodes)
        {
          uses[node].fetch_add(1, std::memory_order_relaxed);
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
  this->Uses.assign(uses.begin(), uses.end());
  this->NodeBounds.resize(CountBlocks(restPoints.size(), NodeBlock));
  this->ClippedBounds.resize(CountBlocks(this->ClippedTetrahedra.size(), ClippedBlock));
  this->StaleNodes.resize(this->NodeBounds.size(), 1);
  this->StaleClipped.resize(this->ClippedBounds.size());
}

void MeshBounds::Resize(std::size_t numberOfNodes)
{
  const std::size_t least = std::min(this->Uses.size(), numberOfNodes);
  this->Uses.resize(std::max(this->Uses.size(), numberOfNodes));
  this->NodeBounds.resize(CountBlocks(numberOfNodes, NodeBlock));
  this->StaleNodes.resize(this->NodeBounds.size());
  for (std::size_t block = least / NodeBlock; block < this->StaleNodes.size(); ++block)
  {
    this->StaleNodes[block] = 1;
  }
}

void MeshBounds::Use(const Tetrahedron& tetrahedron, std::uint32_t uses)
{
  for (const std::int32_t node : tetrahedron)
  {
    const auto index = static_cast<std::size_t>(node);
    if (index >= this->Uses.size()) // the node has been removed
    {
      continue;
    }
    this->Uses[index] += uses;
    if (index / NodeBlock < this->StaleNodes.size())
    {
      this->StaleNodes[index / NodeBlock] = 1;
    }
  }
}

void MeshBounds::ChangeConnectivity(
  const std::vector<glm::dvec3>& restPoints, const std::vector<TetrahedronChange>& changes)
{
  const std::size_t nodes = restPoints.size();
  const IndexBounds box = GetBox(this->Shape);
  this->Resize(nodes);
  for (const TetrahedronChange& change : changes)
  {
    const auto found = std::lower_bound(
      this->ClippedTetrahedra.begin(), this->ClippedTetrahedra.end(), change.Number);
    if (found != this->ClippedTetrahedra.end() && *found == change.Number)
    {
      this->StaleClipped[static_cast<std::size_t>(found - this->ClippedTetrahedra.begin()) /
        ClippedBlock] = 1;
    }
    else if (IsInside(change.After, restPoints, box) && !IsFlat(change.After, restPoints))
    {
      this->Use(change.Before, ~std::uint32_t{ 0 });
      this->Use(change.After, 1);
    }
  }
  this->Uses.resize(nodes);
}

IndexBounds MeshBounds::Compute(const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements,
  const PointRanges* changes)
{
  std::vector<unsigned char> changed = this->StaleNodes;
  if (this->IsComputed && changes)
  {
    MarkBlocks(*changes, NodeBlock, changed);
  }
  else
  {
    changed.assign(changed.size(), 1);
  }
  this->IsComputed = false; // until the end, in case of an exception
  const IndexBounds box = GetBox(this->Shape);
  const OutputTransform transform = GetOutputTransform(this->Shape);
  const auto move = [&](std::int32_t node)
  { return transform.ToOutput(restPoints[node]) + GetVector(displacements, node); };
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
    bool isChanged = this->StaleClipped[block] != 0;
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
  const auto addNodes = [&](std::size_t block)
  {
    if (!changed[block])
    {
      return;
    }
    IndexBounds bounds;
    const std::size_t end = std::min((block + 1) * NodeBlock, this->Uses.size());
    for (std::size_t node = block * NodeBlock; node < end; ++node)
    {
      const glm::dvec3 moved = move(static_cast<std::int32_t>(node));
      if (this->Uses[node] > 0 && IsFinite(moved))
      {
        bounds.Add(moved);
      }
    }
    this->NodeBounds[block] = bounds;
  };
  ParallelForItems(this->NodeBounds.size(), 1, addNodes);
  ParallelForItems(this->ClippedBounds.size(), 1, clip);
  this->IsComputed = true;
  this->StaleNodes.assign(this->StaleNodes.size(), 0);
  this->StaleClipped.assign(this->StaleClipped.size(), 0);
  IndexBounds all;
  for (const std::vector<IndexBounds>* bounds : { &this->NodeBounds, &this->ClippedBounds })
  {
    std::for_each(
      bounds->begin(), bounds->end(), [&](const IndexBounds& block) { all.Add(block); });
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
