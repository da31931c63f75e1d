// SPDX-License-Identifier: BSD-3-Clause
#include "StaticMapping.h"

#include "BarycentricMap.h"
#include "LinkExtrapolation.h"
#include "ParallelFor.h"
#include "TetrahedronRaster.h"

#include <algorithm>
#include <atomic>

namespace deformvolume
{

namespace
{

// Nodes farther away (in voxels) would not fit the wide integers; their weights, being floats,
// would mean nothing either.
constexpr double LargestIndex = 2147483648.0;

// Rounding moves a node by up to 2^-9 voxel on each axis, and with it a voxel by this far out of
// its tetrahedron, with room to spare.
constexpr double RoundingDistance = 1.0 / 128.0;
// A tetrahedron this thin can be distorted by rounding until its weights leave 0 to 1 noticeably.
constexpr double ThinHeight = 1.0 / 16.0;
constexpr double LeastThinWeight = -1.0 / 8.0;

/// The rows of voxels in a rectangle of y and z. One thread links all of them, so that nothing has
/// to be locked and the order of the tetrahedra decides.
struct Tiling
{
  std::int64_t First[2];
  std::int64_t Size[2];
  std::int64_t Count[2];

  explicit Tiling(const Extent& voxels)
    : First{ voxels[2], voxels[4] }
    , Size{ 16, 16 }
  {
    constexpr std::int64_t most = 16384;
    const std::int64_t points[2] = { GetSize(voxels, 1), GetSize(voxels, 2) };
    do
    {
      for (int axis = 0; axis < 2; ++axis)
      {
        this->Count[axis] = (points[axis] + this->Size[axis] - 1) / this->Size[axis];
      }
      const int longer = this->Count[0] > this->Count[1] ? 0 : 1;
      this->Size[longer] *= this->GetNumberOfTiles() > most ? 2 : 1;
    } while (this->GetNumberOfTiles() > most);
  }

  std::int64_t GetNumberOfTiles() const { return this->Count[0] * this->Count[1]; }
};

/// The tiles of a tetrahedron, both ends included; empty where it has no voxel.
struct TileRange
{
  std::int16_t Min[2] = { 0, 0 };
  std::int16_t Max[2] = { -1, -1 };
};

class Mapper
{
public:
  Mapper(const Extent& voxels, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, std::vector<VertexLink>& links)
    : Voxels(voxels)
    , RestPoints(restPoints)
    , Tetrahedra(tetrahedra)
    , Links(links)
    , Tiles(voxels)
    , NumberOfTetrahedra(static_cast<std::int64_t>(tetrahedra.size()))
    , NumberOfChunks(std::min<std::int64_t>(64, NumberOfTetrahedra))
  {
  }

  // Lists the tetrahedra of each tile in ascending order.
  void BinTetrahedra();
  // Links the voxels of the tiles, in parallel.
  void LinkTiles(std::int64_t begin, std::int64_t end);

  std::int64_t GetNumberOfTiles() const { return this->Tiles.GetNumberOfTiles(); }
  std::int64_t GetNumberOfFlatTetrahedra() const { return this->FlatTetrahedra; }
  std::int64_t GetNumberOfInnerVoxels() const { return this->InnerVoxels; }

private:
  using Nodes = std::array<RasterPoint, 4>;

  template <typename Body>
  void ForEachChunk(Body&& body)
  {
    ParallelFor(0, this->NumberOfChunks, 1,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType chunk = begin; chunk < end; ++chunk)
        {
          body(chunk, this->NumberOfTetrahedra * chunk / this->NumberOfChunks,
            this->NumberOfTetrahedra * (chunk + 1) / this->NumberOfChunks);
        }
      });
  }
  template <typename Body>
  void ForEachTile(const TileRange& range, Body&& body)
  {
    for (std::int64_t z = range.Min[1]; z <= range.Max[1]; ++z)
    {
      for (std::int64_t y = range.Min[0]; y <= range.Max[0]; ++y)
      {
        body(z * this->Tiles.Count[0] + y);
      }
    }
  }

  bool IsWithinLimit(const Tetrahedron& tetrahedron) const;
  TileRange FindTiles(const Tetrahedron& tetrahedron) const;
  Nodes GetNodes(const Tetrahedron& tetrahedron) const;
  VoxelBox GetTile(std::int64_t tile) const;
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
  const Tiling Tiles;
  const std::int64_t NumberOfTetrahedra;
  const std::int64_t NumberOfChunks;

  // The tetrahedra of tile i are Bins[Offsets[i]] to Bins[Offsets[i + 1]].
  std::vector<std::int64_t> Offsets;
  std::vector<std::int32_t> Bins;
  std::int64_t FlatTetrahedra = 0;
  std::atomic<std::int64_t> InnerVoxels{ 0 };
};

bool Mapper::IsWithinLimit(const Tetrahedron& tetrahedron) const
{
  return std::all_of(tetrahedron.begin(), tetrahedron.end(),
    [this](std::int32_t node)
    {
      const glm::dvec3& point = this->RestPoints[node];
      return std::abs(point.x) <= LargestIndex && std::abs(point.y) <= LargestIndex &&
        std::abs(point.z) <= LargestIndex;
    });
}

TileRange Mapper::FindTiles(const Tetrahedron& tetrahedron) const
{
  glm::dvec3 min = this->RestPoints[tetrahedron[0]];
  glm::dvec3 max = min;
  for (int node = 1; node < 4; ++node)
  {
    min = glm::min(min, this->RestPoints[tetrahedron[node]]);
    max = glm::max(max, this->RestPoints[tetrahedron[node]]);
  }
  TileRange range;
  if (max.x < this->Voxels[0] - RoundingDistance || min.x > this->Voxels[1] + RoundingDistance)
  {
    return range;
  }
  TileRange found;
  for (int axis = 0; axis < 2; ++axis)
  {
    const double first = static_cast<double>(this->Tiles.First[axis]);
    const double last = static_cast<double>(this->Voxels[2 * axis + 3]);
    const double low = std::max(min[axis + 1] - RoundingDistance, first);
    const double high = std::min(max[axis + 1] + RoundingDistance, last);
    // Voxels between low and high, counted from the first one.
    const std::int64_t begin = static_cast<std::int64_t>(low - first);
    const std::int64_t firstVoxel = begin + (static_cast<double>(begin) < low - first ? 1 : 0);
    if (low > high || static_cast<double>(firstVoxel) > high - first)
    {
      return range;
    }
    const std::int64_t lastVoxel = static_cast<std::int64_t>(high - first);
    found.Min[axis] = static_cast<std::int16_t>(firstVoxel / this->Tiles.Size[axis]);
    found.Max[axis] = static_cast<std::int16_t>(lastVoxel / this->Tiles.Size[axis]);
  }
  return found;
}

void Mapper::BinTetrahedra()
{
  const std::int64_t tiles = this->GetNumberOfTiles();
  std::vector<TileRange> ranges(this->NumberOfTetrahedra);
  std::vector<std::vector<std::int64_t>> counts(
    this->NumberOfChunks, std::vector<std::int64_t>(tiles, 0));
  std::atomic<std::int64_t> flat{ 0 };
  std::atomic<bool> beyondLimit{ false };
  this->ForEachChunk(
    [&](std::int64_t chunk, std::int64_t begin, std::int64_t end)
    {
      std::int64_t flatInChunk = 0;
      for (std::int64_t id = begin; id < end; ++id)
      {
        const Tetrahedron& tetrahedron = this->Tetrahedra[id];
        if (!this->IsWithinLimit(tetrahedron))
        {
          beyondLimit = true;
          continue;
        }
        BarycentricMap map;
        flatInChunk += map.SetTetrahedron(tetrahedron, this->RestPoints) ? 0 : 1;
        ranges[id] = this->FindTiles(tetrahedron);
        this->ForEachTile(ranges[id], [&](std::int64_t tile) { ++counts[chunk][tile]; });
      }
      flat += flatInChunk;
    });
  if (beyondLimit)
  {
    throw Error("The deformation mesh has nodes more than 2147483648 voxels away from the volume's "
                "index 0. Check the units of the mesh and the spacing of the volume.");
  }
  this->FlatTetrahedra = flat;

  this->Offsets.assign(tiles + 1, 0);
  std::int64_t offset = 0;
  for (std::int64_t tile = 0; tile < tiles; ++tile)
  {
    this->Offsets[tile] = offset;
    for (auto& count : counts)
    {
      const std::int64_t size = count[tile];
      count[tile] = offset;
      offset += size;
    }
  }
  this->Offsets[tiles] = offset;
  this->Bins.resize(offset);
  this->ForEachChunk(
    [&](std::int64_t chunk, std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t id = begin; id < end; ++id)
      {
        this->ForEachTile(ranges[id],
          [&](std::int64_t tile)
          { this->Bins[counts[chunk][tile]++] = static_cast<std::int32_t>(id); });
      }
    });
}

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

VoxelBox Mapper::GetTile(std::int64_t tile) const
{
  VoxelBox box;
  box.Min[0] = this->Voxels[0];
  box.Max[0] = this->Voxels[1];
  const std::int64_t index[2] = { tile % this->Tiles.Count[0], tile / this->Tiles.Count[0] };
  for (int axis = 0; axis < 2; ++axis)
  {
    box.Min[axis + 1] = this->Tiles.First[axis] + index[axis] * this->Tiles.Size[axis];
    box.Max[axis + 1] = std::min<std::int64_t>(
      box.Min[axis + 1] + this->Tiles.Size[axis] - 1, this->Voxels[2 * axis + 3]);
  }
  return box;
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
  const VoxelBox tileBox = this->GetTile(tile);
  std::vector<glm::i64vec3> doubtful;
  std::int64_t linked = 0;
  for (std::int64_t bin = this->Offsets[tile]; bin < this->Offsets[tile + 1]; ++bin)
  {
    const std::int32_t id = this->Bins[bin];
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
  for (std::int64_t bin = this->Offsets[tile]; bin < this->Offsets[tile + 1]; ++bin)
  {
    const std::int32_t id = this->Bins[bin];
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
  mapper.BinTetrahedra();
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
