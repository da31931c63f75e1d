// SPDX-License-Identifier: BSD-3-Clause
#include "VoxelLinker.h"

#include <algorithm>
#include <array>

namespace deformvolume
{

namespace
{

// Rounding moves a node by up to 2^-9 voxel on each axis, and with it a voxel by this far out of
// its tetrahedron, with room to spare.
constexpr double RoundingDistance = 1.0 / 128.0;
// A tetrahedron this thin can be distorted by rounding until its weights leave 0 to 1 noticeably.
constexpr double ThinHeight = 1.0 / 16.0;
constexpr double LeastThinWeight = -1.0 / 8.0;

bool IsLinked(const VertexLink& link)
{
  return link.Tetrahedron >= 0;
}
bool IsLinked(std::int32_t tetrahedron)
{
  return tetrahedron >= 0;
}

void Link(VertexLink& link, std::int32_t id, const glm::dvec3& weights)
{
  link = MakeLink(id, weights);
}
void Link(std::int32_t& tetrahedron, std::int32_t id, const glm::dvec3&)
{
  tetrahedron = id;
}

// Links voxels of a row, from the first one on, that have no tetrahedron yet; returns their number.
std::int64_t LinkRow(std::int32_t id, const BarycentricMap& map, const glm::i64vec3& first,
  std::int64_t count, VertexLink* links)
{
  const glm::dvec3 start = map.GetWeights(glm::dvec3(first));
  const glm::dvec3 step(map.GetGradient(0).x, map.GetGradient(1).x, map.GetGradient(2).x);
  std::int64_t linked = 0;
  for (std::int64_t offset = 0; offset < count; ++offset)
  {
    if (!IsLinked(links[offset]))
    {
      Link(links[offset], id, start + step * static_cast<double>(offset));
      ++linked;
    }
  }
  return linked;
}

std::int64_t LinkRow(std::int32_t id, const BarycentricMap&, const glm::i64vec3&,
  std::int64_t count, std::int32_t* tetrahedra)
{
  std::int64_t linked = 0;
  for (std::int64_t offset = 0; offset < count; ++offset)
  {
    const bool free = !IsLinked(tetrahedra[offset]);
    tetrahedra[offset] = free ? id : tetrahedra[offset];
    linked += free ? 1 : 0;
  }
  return linked;
}

} // namespace

VoxelLinker::VoxelLinker(const Extent& voxels, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra)
  : RestPoints(restPoints)
  , Tetrahedra(tetrahedra)
  , Tiles(voxels, restPoints, tetrahedra, RoundingDistance)
{
}

VoxelLinker::Nodes VoxelLinker::GetNodes(const Tetrahedron& tetrahedron) const
{
  Nodes nodes;
  for (int node = 0; node < 4; ++node)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      nodes[node][axis] = RoundToRaster(this->RestPoints[tetrahedron[node]][axis]);
    }
  }
  return nodes;
}

template <typename Element>
std::int64_t VoxelLinker::LinkTile(std::int64_t tile, const VoxelTarget<Element>& target) const
{
  const VoxelBox tileBox = this->Tiles.GetVoxels(tile);
  std::vector<glm::i64vec3> doubtful;
  std::int64_t linked = 0;
  for (const std::int32_t id : this->Tiles.GetTetrahedra(tile))
  {
    const Nodes nodes = this->GetNodes(this->Tetrahedra[id]);
    RasterPoint min = nodes[0];
    RasterPoint max = nodes[0];
    VoxelBox box;
    for (int axis = 0; axis < 3; ++axis)
    {
      for (int node = 1; node < 4; ++node)
      {
        min[axis] = std::min(min[axis], nodes[node][axis]);
        max[axis] = std::max(max[axis], nodes[node][axis]);
      }
      // Shifts round down, of negative numbers too.
      box.Min[axis] = std::max((min[axis] + RasterUnit - 1) >> RasterBits, tileBox.Min[axis]);
      box.Max[axis] = std::min(max[axis] >> RasterBits, tileBox.Max[axis]);
    }
    if (!box.IsEmpty())
    {
      linked += FitsInt64(min, max)
        ? this->LinkTetrahedron<std::int64_t>(id, nodes, box, target, doubtful)
        : this->LinkTetrahedron<WideInteger>(id, nodes, box, target, doubtful);
    }
  }
  for (const glm::i64vec3& voxel : doubtful)
  {
    linked += this->LinkDoubtful(tile, voxel, target.At(voxel.x, voxel.y, voxel.z)) ? 1 : 0;
  }
  return linked;
}

template <typename Integer, typename Element>
std::int64_t VoxelLinker::LinkTetrahedron(std::int32_t id, const Nodes& nodes, const VoxelBox& box,
  const VoxelTarget<Element>& target, std::vector<glm::i64vec3>& doubtful) const
{
  TetrahedronRaster<Integer> raster;
  if (!raster.SetTetrahedron(nodes, box))
  {
    return 0;
  }
  BarycentricMap map;
  const bool flat = !map.SetTetrahedron(this->Tetrahedra[id], this->RestPoints);
  bool thin = flat;
  for (int node = 0; node < 4 && !thin; ++node)
  {
    const glm::dvec3 gradient = map.GetGradient(node);
    thin = glm::dot(gradient, gradient) * ThinHeight * ThinHeight > 1.0;
  }
  std::int64_t linked = 0;
  raster.ForEachRow(
    [&](std::int64_t y, std::int64_t z, std::int64_t first, std::int64_t last)
    {
      Element* element = &target.At(first, y, z);
      if (!thin)
      {
        linked += LinkRow(id, map, glm::i64vec3(first, y, z), last - first + 1, element);
        return;
      }
      for (std::int64_t x = first; x <= last; ++x, ++element)
      {
        if (IsLinked(*element))
        {
          continue;
        }
        const glm::dvec4 weights = flat ? glm::dvec4(-1.0) : map.GetAllWeights(glm::dvec3(x, y, z));
        if (std::min({ weights.x, weights.y, weights.z, weights.w }) < LeastThinWeight)
        {
          doubtful.emplace_back(x, y, z);
        }
        else
        {
          Link(*element, id, glm::dvec3(weights));
          ++linked;
        }
      }
    });
  return linked;
}

// A voxel in a tetrahedron that has room for it only since its nodes were rounded. By the same
// rounding its true neighbours may have missed the voxel, so the one that holds it best before
// rounding takes it, if any is as near as rounding explains.
template <typename Element>
bool VoxelLinker::LinkDoubtful(std::int64_t tile, const glm::i64vec3& voxel, Element& element) const
{
  if (IsLinked(element))
  {
    return false;
  }
  const glm::dvec3 point(voxel);
  double best = -1.0;
  for (const std::int32_t id : this->Tiles.GetTetrahedra(tile))
  {
    const Tetrahedron& tetrahedron = this->Tetrahedra[id];
    bool near = true;
    for (int axis = 0; axis < 3 && near; ++axis)
    {
      bool above = false;
      bool below = false;
      for (const std::int32_t node : tetrahedron)
      {
        above = above || this->RestPoints[node][axis] + RoundingDistance >= point[axis];
        below = below || this->RestPoints[node][axis] - RoundingDistance <= point[axis];
      }
      near = above && below;
    }
    BarycentricMap map;
    if (!near || !map.SetTetrahedron(tetrahedron, this->RestPoints))
    {
      continue;
    }
    const glm::dvec4 weights = map.GetAllWeights(point);
    double least = weights[0];
    for (int node = 0; node < 4; ++node)
    {
      least = std::min(least, weights[node]);
      near = near && weights[node] >= -RoundingDistance * glm::length(map.GetGradient(node));
    }
    if (near && least > best)
    {
      best = least;
      Link(element, id, glm::dvec3(weights));
    }
  }
  return IsLinked(element);
}

template std::int64_t VoxelLinker::LinkTile(std::int64_t, const VoxelTarget<VertexLink>&) const;
template std::int64_t VoxelLinker::LinkTile(std::int64_t, const VoxelTarget<std::int32_t>&) const;

} // namespace deformvolume
