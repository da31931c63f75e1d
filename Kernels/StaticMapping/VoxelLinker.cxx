// SPDX-License-Identifier: BSD-3-Clause
#include "VoxelLinker.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace deformvolume
{

namespace
{

// Upper bound, in voxels, of the distance of a voxel from its tetrahedron that rounding can cause.
// Rounding moves a node by up to 2^-9 voxel on each axis.
constexpr double RoundingDistance = VoxelLinker::Margin;
// In voxels. Rounding can distort a thinner tetrahedron so much that weights are clearly negative
// or greater than 1.
constexpr double ThinHeight = 1.0 / 16.0;
constexpr double LeastThinWeight = -1.0 / 8.0;

std::int32_t GetTetrahedron(const VertexLink& link)
{
  return link.Tetrahedron;
}
std::int32_t GetTetrahedron(std::int32_t tetrahedron)
{
  return tetrahedron;
}

template <typename Element>
bool IsLinked(const Element& element)
{
  return GetTetrahedron(element) >= 0;
}

void Link(VertexLink& link, std::int32_t id, const glm::dvec3& weights)
{
  link = MakeLink(id, weights);
}
void Link(std::int32_t& tetrahedron, std::int32_t id, const glm::dvec3&)
{
  tetrahedron = id;
}

// Whether a voxel lies inside a tetrahedron, and not on its surface within rounding.
bool IsWithin(const BarycentricMap& map, const glm::i64vec3& voxel)
{
  const glm::dvec4 weights = map.GetAllWeights(glm::dvec3(voxel));
  bool isWithin = true;
  for (int node = 0; node < 4; ++node)
  {
    // The weight is the distance from the face times the length of the gradient.
    isWithin = isWithin && weights[node] > RoundingDistance * glm::length(map.GetGradient(node));
  }
  return isWithin;
}

} // namespace

VoxelLinker::VoxelLinker(const Extent& voxels, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra)
  : RestPoints(restPoints)
  , Tetrahedra(tetrahedra)
  , Voxels(MakeVoxelBox(voxels))
  , Tiles(voxels, restPoints, tetrahedra, Margin)
  , Order(restPoints, tetrahedra)
{
}

bool VoxelLinker::TakesVoxel(
  std::int32_t id, const BarycentricMap& map, std::int32_t other, const glm::i64vec3& voxel) const
{
  if (!this->Order.AreInOneBody(id, other))
  {
    // On the surfaces of both bodies, the voxel may lie between them.
    BarycentricMap otherMap;
    otherMap.SetTetrahedron(this->Tetrahedra[other], this->RestPoints);
    if (IsWithin(map, voxel) || IsWithin(otherMap, voxel))
    {
      const std::lock_guard<std::mutex> lock(this->SharedMutex);
      const auto getKey = [](const glm::i64vec3& v) { return std::make_tuple(v.z, v.y, v.x); };
      this->SharedVoxel =
        this->SharedVoxel && getKey(*this->SharedVoxel) < getKey(voxel) ? this->SharedVoxel : voxel;
    }
  }
  return this->Order.ComesBefore(id, other);
}

// Links `count` voxels of a row. Returns the number of voxels that had no tetrahedron before.
std::int64_t VoxelLinker::LinkRow(std::int32_t id, const BarycentricMap& map,
  const glm::i64vec3& first, std::int64_t count, VertexLink* links) const
{
  const glm::dvec3 start = map.GetWeights(glm::dvec3(first));
  const glm::dvec3 step(map.GetGradient(0).x, map.GetGradient(1).x, map.GetGradient(2).x);
  std::int64_t linked = 0;
  for (std::int64_t offset = 0; offset < count; ++offset)
  {
    const bool free = !IsLinked(links[offset]);
    if (free ||
      this->TakesVoxel(
        id, map, links[offset].Tetrahedron, glm::i64vec3(first.x + offset, first.y, first.z)))
    {
      Link(links[offset], id, start + step * static_cast<double>(offset));
    }
    linked += free ? 1 : 0;
  }
  return linked;
}

std::int64_t VoxelLinker::LinkRow(std::int32_t id, const BarycentricMap& map,
  const glm::i64vec3& first, std::int64_t count, std::int32_t* tetrahedra) const
{
  std::int64_t linked = 0;
  for (std::int64_t offset = 0; offset < count; ++offset)
  {
    const bool free = !IsLinked(tetrahedra[offset]);
    tetrahedra[offset] = free ? id : tetrahedra[offset];
    linked += free ? 1 : 0;
  }
  // This loop is rarely needed: few voxels lie in several tetrahedra.
  for (std::int64_t offset = 0; linked < count && offset < count; ++offset)
  {
    if (tetrahedra[offset] != id &&
      this->TakesVoxel(
        id, map, tetrahedra[offset], glm::i64vec3(first.x + offset, first.y, first.z)))
    {
      tetrahedra[offset] = id;
    }
  }
  return linked;
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

VoxelBox VoxelLinker::GetBox(const Nodes& nodes, const VoxelBox& part)
{
  VoxelBox box;
  for (int axis = 0; axis < 3; ++axis)
  {
    const auto ends =
      std::minmax({ nodes[0][axis], nodes[1][axis], nodes[2][axis], nodes[3][axis] });
    // Shifts round down, also for negative numbers.
    box.Min[axis] = std::max((ends.first + RasterUnit - 1) >> RasterBits, part.Min[axis]);
    box.Max[axis] = std::min(ends.second >> RasterBits, part.Max[axis]);
  }
  return box;
}

bool VoxelLinker::FitsInt64(const Nodes& nodes)
{
  RasterPoint min = nodes[0];
  RasterPoint max = nodes[0];
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int node = 1; node < 4; ++node)
    {
      min[axis] = std::min(min[axis], nodes[node][axis]);
      max[axis] = std::max(max[axis], nodes[node][axis]);
    }
  }
  return deformvolume::FitsInt64(min, max);
}

template <typename Integer>
bool VoxelLinker::FindVoxel(const Nodes& nodes, const VoxelBox& box, glm::i64vec3& voxel)
{
  TetrahedronRaster<Integer> raster;
  bool found = false;
  const auto take = [&](std::int64_t y, std::int64_t z, std::int64_t first, std::int64_t last)
  {
    voxel = found ? voxel : glm::i64vec3(first + (last - first) / 2, y, z);
    found = true;
  };
  // Except in small and thin tetrahedra, the row nearest to the centroid has voxels.
  VoxelBox row = box;
  for (int axis = 1; axis < 3; ++axis)
  {
    const std::int64_t sum = nodes[0][axis] + nodes[1][axis] + nodes[2][axis] + nodes[3][axis];
    const std::int64_t middle = (sum + 2 * RasterUnit) >> (RasterBits + 2);
    row.Min[axis] = row.Max[axis] = std::min(std::max(middle, box.Min[axis]), box.Max[axis]);
  }
  if (raster.SetTetrahedron(nodes, row))
  {
    raster.ForEachRow(take);
  }
  for (row = box; !found && row.Min[2] <= box.Max[2]; ++row.Min[2])
  {
    row.Max[2] = row.Min[2];
    if (!raster.SetTetrahedron(nodes, row))
    {
      return false;
    }
    raster.ForEachRow(take);
  }
  return found;
}

bool VoxelLinker::FindVoxel(std::int32_t tetrahedron, glm::i64vec3& voxel) const
{
  const Nodes nodes = this->GetNodes(this->Tetrahedra[tetrahedron]);
  const VoxelBox box = GetBox(nodes, this->Voxels);
  return !box.IsEmpty() &&
    (FitsInt64(nodes) ? FindVoxel<std::int64_t>(nodes, box, voxel)
                      : FindVoxel<WideInteger>(nodes, box, voxel));
}

template <typename Element>
std::int64_t VoxelLinker::LinkTile(
  std::int64_t tile, const VoxelBox& part, const VoxelTarget<Element>& target) const
{
  std::vector<glm::i64vec3> heldByRounding;
  std::int64_t linked = 0;
  for (const std::int32_t id : this->Tiles.GetTetrahedra(tile))
  {
    const Nodes nodes = this->GetNodes(this->Tetrahedra[id]);
    const VoxelBox box = GetBox(nodes, part);
    if (!box.IsEmpty())
    {
      linked += FitsInt64(nodes)
        ? this->LinkTetrahedron<std::int64_t>(id, nodes, box, target, heldByRounding)
        : this->LinkTetrahedron<WideInteger>(id, nodes, box, target, heldByRounding);
    }
  }
  for (const glm::i64vec3& voxel : heldByRounding)
  {
    linked += this->LinkHeldByRounding(tile, voxel, target.At(voxel.x, voxel.y, voxel.z)) ? 1 : 0;
  }
  return linked;
}

template <typename Integer, typename Element>
std::int64_t VoxelLinker::LinkTetrahedron(std::int32_t id, const Nodes& nodes, const VoxelBox& box,
  const VoxelTarget<Element>& target, std::vector<glm::i64vec3>& heldByRounding) const
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
        linked += this->LinkRow(id, map, glm::i64vec3(first, y, z), last - first + 1, element);
        return;
      }
      for (std::int64_t x = first; x <= last; ++x, ++element)
      {
        const bool free = !IsLinked(*element);
        if (!free && (flat || !this->TakesVoxel(id, map, GetTetrahedron(*element), { x, y, z })))
        {
          continue;
        }
        const glm::dvec4 weights = flat ? glm::dvec4(-1.0) : map.GetAllWeights(glm::dvec3(x, y, z));
        const bool byRounding =
          std::min({ weights.x, weights.y, weights.z, weights.w }) < LeastThinWeight;
        if (byRounding && free)
        {
          heldByRounding.emplace_back(x, y, z);
        }
        if (!byRounding)
        {
          Link(*element, id, glm::dvec3(weights));
          linked += free ? 1 : 0;
        }
      }
    });
  return linked;
}

// Links a voxel that lies in a tetrahedron only because the nodes of that tetrahedron are rounded.
// Rounding may also have moved the nodes of the tetrahedron that contains the voxel before
// rounding, so that it does not contain the voxel after rounding. Therefore this function compares
// weights before rounding, and links the voxel to the best tetrahedron within the rounding
// distance, if there is one.
template <typename Element>
bool VoxelLinker::LinkHeldByRounding(
  std::int64_t tile, const glm::i64vec3& voxel, Element& element) const
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
    const bool better = least > best ||
      (IsLinked(element) && least == best && this->Order.ComesBefore(id, GetTetrahedron(element)));
    if (near && better)
    {
      best = least;
      Link(element, id, glm::dvec3(weights));
    }
  }
  return IsLinked(element);
}

template std::int64_t VoxelLinker::LinkTile(
  std::int64_t, const VoxelBox&, const VoxelTarget<VertexLink>&) const;
template std::int64_t VoxelLinker::LinkTile(
  std::int64_t, const VoxelBox&, const VoxelTarget<std::int32_t>&) const;

} // namespace deformvolume
