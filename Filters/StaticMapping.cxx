// SPDX-License-Identifier: BSD-3-Clause
#include "StaticMapping.h"

#include "BarycentricMap.h"
#include "LinkExtrapolation.h"
#include "ParallelFor.h"
#include "TetrahedronRaster.h"
#include "TetrahedronTiles.h"

#include <algorithm>
#include <atomic>

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

class Mapper
{
public:
  Mapper(const Extent& voxels, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, std::vector<VertexLink>& links)
    : Voxels(voxels)
    , RestPoints(restPoints)
    , Tetrahedra(tetrahedra)
    , Links(links)
    , Tiles(voxels, restPoints, tetrahedra, RoundingDistance)
  {
  }

  // Links the voxels of the tiles, in parallel.
  void LinkTiles(std::int64_t begin, std::int64_t end);

  std::int64_t GetNumberOfTiles() const { return this->Tiles.GetNumberOfTiles(); }
  std::int64_t GetNumberOfFlatTetrahedra() const { return this->Tiles.GetNumberOfFlatTetrahedra(); }
  std::int64_t GetNumberOfInnerVoxels() const { return this->InnerVoxels; }

private:
  using Nodes = std::array<RasterPoint, 4>;

  Nodes GetNodes(const Tetrahedron& tetrahedron) const;
  VertexLink& GetLink(std::int64_t x, std::int64_t y, std::int64_t z) const;

  void LinkTile(std::int64_t tile);
  template <typename Integer>
  std::int64_t LinkTetrahedron(std::int32_t id, const Nodes& nodes, const VoxelBox& box,
    std::vector<glm::i64vec3>& doubtful) const;
  std::int64_t LinkRow(std::int32_t id, const BarycentricMap& map, std::int64_t y, std::int64_t z,
    std::int64_t first, std::int64_t last) const;
  bool LinkDoubtful(std::int64_t tile, const glm::i64vec3& voxel) const;

  const Extent& Voxels;
  const std::vector<glm::dvec3>& RestPoints;
  const std::vector<Tetrahedron>& Tetrahedra;
  std::vector<VertexLink>& Links;
  const TetrahedronTiles Tiles;
  std::atomic<std::int64_t> InnerVoxels{ 0 };
};

Mapper::Nodes Mapper::GetNodes(const Tetrahedron& tetrahedron) const
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

VertexLink& Mapper::GetLink(std::int64_t x, std::int64_t y, std::int64_t z) const
{
  return this->Links[((z - this->Voxels[4]) * GetSize(this->Voxels, 1) + (y - this->Voxels[2])) *
      GetSize(this->Voxels, 0) +
    (x - this->Voxels[0])];
}

void Mapper::LinkTiles(std::int64_t begin, std::int64_t end)
{
  ParallelFor(begin, end, 1,
    [this](vtkIdType first, vtkIdType last)
    {
      for (vtkIdType tile = first; tile < last; ++tile)
      {
        this->LinkTile(tile);
      }
    });
}

void Mapper::LinkTile(std::int64_t tile)
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
      linked += FitsInt64(min, max) ? this->LinkTetrahedron<std::int64_t>(id, nodes, box, doubtful)
                                    : this->LinkTetrahedron<WideInteger>(id, nodes, box, doubtful);
    }
  }
  for (const glm::i64vec3& voxel : doubtful)
  {
    linked += this->LinkDoubtful(tile, voxel) ? 1 : 0;
  }
  this->InnerVoxels += linked;
}

template <typename Integer>
std::int64_t Mapper::LinkTetrahedron(std::int32_t id, const Nodes& nodes, const VoxelBox& box,
  std::vector<glm::i64vec3>& doubtful) const
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
      if (!thin)
      {
        linked += this->LinkRow(id, map, y, z, first, last);
        return;
      }
      VertexLink* link = &this->GetLink(first, y, z);
      for (std::int64_t x = first; x <= last; ++x, ++link)
      {
        if (link->Tetrahedron >= 0)
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
          *link = MakeLink(id, glm::dvec3(weights));
          ++linked;
        }
      }
    });
  return linked;
}

std::int64_t Mapper::LinkRow(std::int32_t id, const BarycentricMap& map, std::int64_t y,
  std::int64_t z, std::int64_t first, std::int64_t last) const
{
  VertexLink* links = &this->GetLink(first, y, z);
  const glm::dvec3 start = map.GetWeights(glm::dvec3(first, y, z));
  const glm::dvec3 step(map.GetGradient(0).x, map.GetGradient(1).x, map.GetGradient(2).x);
  std::int64_t linked = 0;
  for (std::int64_t offset = 0; offset <= last - first; ++offset)
  {
    if (links[offset].Tetrahedron < 0)
    {
      links[offset] = MakeLink(id, start + step * static_cast<double>(offset));
      ++linked;
    }
  }
  return linked;
}

// A voxel in a tetrahedron that has room for it only since its nodes were rounded. By the same
// rounding its true neighbours may have missed the voxel, so the one that holds it best before
// rounding takes it, if any is as near as rounding explains.
bool Mapper::LinkDoubtful(std::int64_t tile, const glm::i64vec3& voxel) const
{
  VertexLink& link = this->GetLink(voxel.x, voxel.y, voxel.z);
  if (link.Tetrahedron >= 0)
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
      link = MakeLink(id, glm::dvec3(weights));
    }
  }
  return link.Tetrahedron >= 0;
}

} // namespace

StaticMapping BuildStaticMapping(const Extent& voxels, const glm::dvec3& spacing,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  bool extrapolate, const std::function<bool(double)>& progress)
{
  const auto report = [&](double done)
  {
    if (progress && !progress(done))
    {
      throw Aborted();
    }
  };
  StaticMapping mapping;
  const std::int64_t numberOfVoxels = GetNumberOfPoints(voxels);
  mapping.Links.resize(numberOfVoxels);
  if (numberOfVoxels == 0)
  {
    return mapping;
  }
  const double linkingDone = extrapolate ? 0.6 : 1.0;
  report(0.0);

  Mapper mapper(voxels, restPoints, tetrahedra, mapping.Links);
  report(0.25 * linkingDone);
  constexpr int steps = 16;
  const std::int64_t tiles = mapper.GetNumberOfTiles();
  for (int step = 0; step < steps; ++step)
  {
    mapper.LinkTiles(tiles * step / steps, tiles * (step + 1) / steps);
    report(linkingDone * (0.25 + 0.75 * (step + 1) / steps));
  }
  mapping.NumberOfInnerVoxels = mapper.GetNumberOfInnerVoxels();
  mapping.NumberOfFlatTetrahedra = mapper.GetNumberOfFlatTetrahedra();

  if (extrapolate && mapping.NumberOfInnerVoxels > 0 &&
    mapping.NumberOfInnerVoxels < numberOfVoxels)
  {
    ExtrapolateLinks(voxels, spacing, restPoints, tetrahedra, mapping.Links,
      [&](double done) { report(linkingDone + (1.0 - linkingDone) * done); });
  }
  return mapping;
}

} // namespace deformvolume
