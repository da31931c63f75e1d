// SPDX-License-Identifier: BSD-3-Clause
#include "TetrahedronTiles.h"

#include "BarycentricMap.h"
#include "Error.h"
#include "ParallelFor.h"

#include <algorithm>
#include <atomic>
#include <limits>

namespace deformvolume
{

namespace
{

// Parts of the tetrahedra that a thread takes at a time, in their order.
std::int64_t CountChunks(std::int64_t size)
{
  return std::min<std::int64_t>(64, size);
}

// Calls body(chunk, begin, end) for parts of so many.
template <typename Body>
void ForEachChunk(std::int64_t size, Body&& body)
{
  const std::int64_t chunks = CountChunks(size);
  ParallelFor(0, chunks, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t chunk = begin; chunk < end; ++chunk)
      {
        body(chunk, size * chunk / chunks, size * (chunk + 1) / chunks);
      }
    });
}

} // namespace

TetrahedronTiles::TetrahedronTiles(const Extent& voxels, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra, double margin)
  : TileGrid(voxels)
{
  std::vector<Range> ranges(tetrahedra.size());
  std::atomic<std::int64_t> flat{ 0 };
  std::atomic<bool> beyondLimit{ false };
  ForEachChunk(static_cast<std::int64_t>(tetrahedra.size()),
    [&](std::int64_t, std::int64_t begin, std::int64_t end)
    {
      std::int64_t flatInChunk = 0;
      for (std::int64_t id = begin; id < end; ++id)
      {
        const Places places = GetPlaces(tetrahedra[id], restPoints);
        if (!IsWithinLimit(places))
        {
          beyondLimit = true;
          continue;
        }
        BarycentricMap map;
        flatInChunk += map.SetTetrahedron(tetrahedra[id], restPoints) ? 0 : 1;
        ranges[id] = this->FindRange(places, margin);
      }
      flat += flatInChunk;
    });
  if (beyondLimit)
  {
    throw Error("The deformation mesh has nodes more than 2147483648 voxels away from the volume's "
                "index 0. Check the units of the mesh and the spacing of the volume.");
  }
  this->FlatTetrahedra = flat;
  this->MakeLists({}, ranges, {});
}

TetrahedronTiles::TetrahedronTiles(const Extent& voxels, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra, double margin,
  const std::vector<unsigned char>& wanted)
  : TileGrid(voxels)
{
  // Most tetrahedra are nowhere near the tiles, which a look at two coordinates tells.
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high(-low);
  for (std::int64_t tile = 0; tile < this->GetNumberOfTiles(); ++tile)
  {
    if (wanted[tile])
    {
      const VoxelBox box = this->GetVoxels(tile);
      low = glm::min(low, glm::dvec3(box.Min[0], box.Min[1], box.Min[2]) - margin);
      high = glm::max(high, glm::dvec3(box.Max[0], box.Max[1], box.Max[2]) + margin);
    }
  }
  const auto isNear = [&](const Places& places)
  {
    bool near = true;
    for (int axis = 1; axis < 3; ++axis)
    {
      near &= std::max({ places[0][axis], places[1][axis], places[2][axis], places[3][axis] }) >=
          low[axis] &&
        std::min({ places[0][axis], places[1][axis], places[2][axis], places[3][axis] }) <=
          high[axis];
    }
    return near;
  };
  struct Found
  {
    std::vector<std::int32_t> Numbers;
    std::vector<Range> Ranges;
  };
  const auto size = static_cast<std::int64_t>(tetrahedra.size());
  std::vector<Found> found(CountChunks(size));
  ForEachChunk(size,
    [&](std::int64_t chunk, std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t id = begin; id < end; ++id)
      {
        const Places places = GetPlaces(tetrahedra[id], restPoints);
        if (!isNear(places))
        {
          continue;
        }
        const Range range = this->FindRange(places, margin);
        bool isWanted = false;
        this->ForEachTile(range, [&](std::int64_t tile) { isWanted |= wanted[tile] != 0; });
        if (isWanted)
        {
          found[chunk].Numbers.push_back(static_cast<std::int32_t>(id));
          found[chunk].Ranges.push_back(range);
        }
      }
    });
  Found all;
  for (const Found& some : found)
  {
    all.Numbers.insert(all.Numbers.end(), some.Numbers.begin(), some.Numbers.end());
    all.Ranges.insert(all.Ranges.end(), some.Ranges.begin(), some.Ranges.end());
  }
  this->MakeLists(all.Numbers, all.Ranges, wanted);
}

void TetrahedronTiles::MakeLists(const std::vector<std::int32_t>& numbers,
  const std::vector<Range>& ranges, const std::vector<unsigned char>& wanted)
{
  const std::int64_t tiles = this->GetNumberOfTiles();
  const auto size = static_cast<std::int64_t>(ranges.size());
  const auto forEachEntry = [&](auto&& body)
  {
    ForEachChunk(size,
      [&](std::int64_t chunk, std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t i = begin; i < end; ++i)
        {
          this->ForEachTile(ranges[i],
            [&](std::int64_t tile)
            {
              if (wanted.empty() || wanted[tile])
              {
                body(chunk, i, tile);
              }
            });
        }
      });
  };
  std::vector<std::vector<std::int64_t>> counts(
    CountChunks(size), std::vector<std::int64_t>(tiles, 0));
  forEachEntry([&](std::int64_t chunk, std::int64_t, std::int64_t tile) { ++counts[chunk][tile]; });
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
  forEachEntry(
    [&](std::int64_t chunk, std::int64_t i, std::int64_t tile)
    {
      this->Bins[counts[chunk][tile]++] =
        numbers.empty() ? static_cast<std::int32_t>(i) : numbers[i];
    });
}

} // namespace deformvolume
