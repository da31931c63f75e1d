// SPDX-License-Identifier: BSD-3-Clause
#include "TetrahedronTiles.h"

#include "BarycentricMap.h"
#include "Error.h"
#include "ParallelFor.h"

#include <algorithm>
#include <atomic>

namespace deformvolume
{

namespace
{

// Number of blocks into which `size` tetrahedra are divided. A thread processes one block at a
// time.
std::int64_t CountBlocks(std::int64_t size)
{
  return std::min<std::int64_t>(64, size);
}

// Calls body(block, begin, end) in parallel for the blocks of `size` tetrahedra.
template <typename Body>
void ForEachBlock(std::int64_t size, Body&& body)
{
  const std::int64_t blocks = CountBlocks(size);
  ParallelFor(0, blocks, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t block = begin; block < end; ++block)
      {
        body(block, size * block / blocks, size * (block + 1) / blocks);
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
  ForEachBlock(static_cast<std::int64_t>(tetrahedra.size()),
    [&](std::int64_t, std::int64_t begin, std::int64_t end)
    {
      std::int64_t flatInBlock = 0;
      for (std::int64_t id = begin; id < end; ++id)
      {
        const Positions positions = GetPositions(tetrahedra[id], restPoints);
        if (!IsWithinLimit(positions))
        {
          beyondLimit = true;
          continue;
        }
        BarycentricMap map;
        flatInBlock += map.SetTetrahedron(tetrahedra[id], restPoints) ? 0 : 1;
        ranges[id] = this->FindRange(positions, margin);
      }
      flat += flatInBlock;
    });
  if (beyondLimit)
  {
    throw Error(
      "The deformation mesh has nodes more than 2147483648 voxels away from index 0 of the "
      "volume. Check the units of the mesh and the spacing of the volume.");
  }
  this->FlatTetrahedra = flat;
  this->MakeLists(ranges);
}

void TetrahedronTiles::MakeLists(const std::vector<Range>& ranges)
{
  const std::int64_t tiles = this->GetNumberOfTiles();
  const auto size = static_cast<std::int64_t>(ranges.size());
  const auto forEachEntry = [&](auto&& body)
  {
    ForEachBlock(size,
      [&](std::int64_t block, std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t i = begin; i < end; ++i)
        {
          this->ForEachTile(ranges[i], [&](std::int64_t tile) { body(block, i, tile); });
        }
      });
  };
  std::vector<std::vector<std::int64_t>> counts(
    CountBlocks(size), std::vector<std::int64_t>(tiles, 0));
  forEachEntry([&](std::int64_t block, std::int64_t, std::int64_t tile) { ++counts[block][tile]; });
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
  forEachEntry([&](std::int64_t block, std::int64_t i, std::int64_t tile)
    { this->Bins[counts[block][tile]++] = static_cast<std::int32_t>(i); });
}

} // namespace deformvolume
