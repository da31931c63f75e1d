// SPDX-License-Identifier: BSD-3-Clause
#include "TetrahedronTiles.h"

#include "BarycentricMap.h"
#include "Error.h"
#include "ParallelFor.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace deformvolume
{

namespace
{

// Nodes farther away (in voxels) would not fit the wide integers; their weights, being floats,
// would mean nothing either.
constexpr double LargestIndex = 2147483648.0;

bool IsWithinLimit(const Tetrahedron& tetrahedron, const std::vector<glm::dvec3>& restPoints)
{
  return std::all_of(tetrahedron.begin(), tetrahedron.end(),
    [&restPoints](std::int32_t node)
    {
      const glm::dvec3& point = restPoints[node];
      return std::abs(point.x) <= LargestIndex && std::abs(point.y) <= LargestIndex &&
        std::abs(point.z) <= LargestIndex;
    });
}

} // namespace

template <typename Body>
void TetrahedronTiles::ForEachTile(const Range& range, Body&& body) const
{
  for (std::int64_t z = range.Min[1]; z <= range.Max[1]; ++z)
  {
    for (std::int64_t y = range.Min[0]; y <= range.Max[0]; ++y)
    {
      body(z * this->Count[0] + y);
    }
  }
}

TetrahedronTiles::TetrahedronTiles(const Extent& voxels, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra, double margin)
  : Voxels(voxels)
{
  const std::int64_t size = static_cast<std::int64_t>(tetrahedra.size());
  const std::int64_t chunks = std::min<std::int64_t>(64, size);
  const auto forEachChunk = [&](auto&& body)
  {
    ParallelFor(0, chunks, 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t chunk = begin; chunk < end; ++chunk)
        {
          body(chunk, size * chunk / chunks, size * (chunk + 1) / chunks);
        }
      });
  };

  this->ChooseSize();
  const std::int64_t tiles = this->GetNumberOfTiles();
  std::vector<Range> ranges(tetrahedra.size());
  std::vector<std::vector<std::int64_t>> counts(chunks, std::vector<std::int64_t>(tiles, 0));
  std::atomic<std::int64_t> flat{ 0 };
  std::atomic<bool> beyondLimit{ false };
  forEachChunk(
    [&](std::int64_t chunk, std::int64_t begin, std::int64_t end)
    {
      std::int64_t flatInChunk = 0;
      for (std::int64_t id = begin; id < end; ++id)
      {
        const Tetrahedron& tetrahedron = tetrahedra[id];
        if (!IsWithinLimit(tetrahedron, restPoints))
        {
          beyondLimit = true;
          continue;
        }
        BarycentricMap map;
        flatInChunk += map.SetTetrahedron(tetrahedron, restPoints) ? 0 : 1;
        ranges[id] = this->FindRange(tetrahedron, restPoints, margin);
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
      const std::int64_t number = count[tile];
      count[tile] = offset;
      offset += number;
    }
  }
  this->Offsets[tiles] = offset;
  this->Bins.resize(offset);
  forEachChunk(
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

// Tiles of this size stay in the processor's caches. Larger volumes get larger tiles, as each
// tile costs memory.
void TetrahedronTiles::ChooseSize()
{
  constexpr std::int64_t most = 16384;
  const std::int64_t points[2] = { GetSize(this->Voxels, 1), GetSize(this->Voxels, 2) };
  while (true)
  {
    for (int axis = 0; axis < 2; ++axis)
    {
      this->Count[axis] = (points[axis] + this->Size[axis] - 1) / this->Size[axis];
    }
    if (this->GetNumberOfTiles() <= most)
    {
      return;
    }
    this->Size[this->Count[0] > this->Count[1] ? 0 : 1] *= 2;
  }
}

TetrahedronTiles::Range TetrahedronTiles::FindRange(
  const Tetrahedron& tetrahedron, const std::vector<glm::dvec3>& restPoints, double margin) const
{
  glm::dvec3 min = restPoints[tetrahedron[0]];
  glm::dvec3 max = min;
  for (int node = 1; node < 4; ++node)
  {
    min = glm::min(min, restPoints[tetrahedron[node]]);
    max = glm::max(max, restPoints[tetrahedron[node]]);
  }
  Range range;
  if (max.x < this->Voxels[0] - margin || min.x > this->Voxels[1] + margin)
  {
    return range;
  }
  Range found;
  for (int axis = 0; axis < 2; ++axis)
  {
    const double first = static_cast<double>(this->Voxels[2 * axis + 2]);
    const double last = static_cast<double>(this->Voxels[2 * axis + 3]);
    const double low = std::max(min[axis + 1] - margin, first);
    const double high = std::min(max[axis + 1] + margin, last);
    // Voxels between low and high, counted from the first one.
    const std::int64_t begin = static_cast<std::int64_t>(low - first);
    const std::int64_t firstVoxel = begin + (static_cast<double>(begin) < low - first ? 1 : 0);
    if (low > high || static_cast<double>(firstVoxel) > high - first)
    {
      return range;
    }
    const std::int64_t lastVoxel = static_cast<std::int64_t>(high - first);
    found.Min[axis] = static_cast<std::int16_t>(firstVoxel / this->Size[axis]);
    found.Max[axis] = static_cast<std::int16_t>(lastVoxel / this->Size[axis]);
  }
  return found;
}

VoxelBox TetrahedronTiles::GetVoxels(std::int64_t tile) const
{
  VoxelBox box;
  box.Min[0] = this->Voxels[0];
  box.Max[0] = this->Voxels[1];
  const std::int64_t index[2] = { tile % this->Count[0], tile / this->Count[0] };
  for (int axis = 0; axis < 2; ++axis)
  {
    box.Min[axis + 1] = this->Voxels[2 * axis + 2] + index[axis] * this->Size[axis];
    box.Max[axis + 1] =
      std::min<std::int64_t>(box.Min[axis + 1] + this->Size[axis] - 1, this->Voxels[2 * axis + 3]);
  }
  return box;
}

} // namespace deformvolume
