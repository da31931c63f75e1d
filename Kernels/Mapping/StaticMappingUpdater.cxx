// SPDX-License-Identifier: BSD-3-Clause
#include "StaticMappingUpdater.h"

#include "BarycentricMap.h"
#include "ParallelFor.h"
#include "RunBuilder.h"
#include "VoxelLinker.h"

#include <algorithm>
#include <atomic>

namespace deformvolume
{

namespace
{

// Where more tiles are touched all are better mapped anew, with nothing left over of before.
constexpr double LargestShare = 0.5;

Extent MakeExtent(const VoxelBox& box)
{
  Extent extent;
  for (int axis = 0; axis < 3; ++axis)
  {
    extent[2 * axis] = static_cast<int>(box.Min[axis]);
    extent[2 * axis + 1] = static_cast<int>(box.Max[axis]);
  }
  return extent;
}

bool IsFlat(const TileGrid::Places& places)
{
  BarycentricMap map;
  return !map.SetTetrahedron({ { 0, 1, 2, 3 } }, { places.begin(), places.end() });
}

} // namespace

StaticMappingUpdater::StaticMappingUpdater(const Extent& voxels, const MappingSurvey& before,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  const TetrahedronReplacement& replacement)
  : Voxels(voxels)
  , RestPoints(restPoints)
  , Tetrahedra(tetrahedra)
  , Survey(before)
  , Kept(replacement.Kept)
{
  if (before.IsExtrapolated || GetNumberOfPoints(voxels) == 0)
  {
    return;
  }
  const TileGrid grid(voxels);
  std::vector<unsigned char> touched(grid.GetNumberOfTiles());
  if (!this->FindTouched(replacement, touched))
  {
    return;
  }
  for (std::int64_t tile = 0; tile < grid.GetNumberOfTiles(); ++tile)
  {
    if (touched[tile])
    {
      this->Tiles.push_back(tile);
    }
  }
  if (static_cast<double>(this->Tiles.size()) >
    LargestShare * static_cast<double>(grid.GetNumberOfTiles()))
  {
    return;
  }
  this->Linker = std::make_unique<VoxelLinker>(voxels, restPoints, tetrahedra, touched);
  this->Survey.NumberOfTetrahedra = static_cast<std::int64_t>(tetrahedra.size());
  std::vector<std::int64_t> sampled;
  for (const TileSample& sample : this->Survey.Samples)
  {
    if (touched[sample.Tile])
    {
      sampled.push_back(sample.Tile);
    }
  }
  const std::vector<TileSample> samples =
    RunBuilder(*this->Linker, voxels, restPoints, tetrahedra).SampleTiles(sampled);
  auto next = samples.begin();
  for (TileSample& sample : this->Survey.Samples)
  {
    sample = touched[sample.Tile] ? *next++ : sample;
  }
  this->RunBytes = this->Survey.GetRunBytes(voxels);
  this->Worthwhile = (this->RunBytes > 0) == (before.GetRunBytes(voxels) > 0) &&
    this->Survey.NumberOfFlatTetrahedra < this->Survey.NumberOfTetrahedra;
}

StaticMappingUpdater::~StaticMappingUpdater() = default;

bool StaticMappingUpdater::FindTouched(
  const TetrahedronReplacement& replacement, std::vector<unsigned char>& touched)
{
  const TileGrid grid(this->Voxels);
  const auto add = [&](const TileGrid::Places& places, std::int64_t sign)
  {
    this->Survey.NumberOfFlatTetrahedra += IsFlat(places) ? sign : 0;
    grid.ForEachTile(grid.FindRange(places, VoxelLinker::Reach),
      [&](std::int64_t tile)
      {
        touched[tile] = 1;
        this->Survey.NumberOfEntries += sign;
      });
    // Wider, so that no rounding counts.
    const VoxelBox box = grid.FindBox(places, 2.0 * VoxelLinker::Reach);
    if (!box.IsEmpty())
    {
      this->Changed.push_back(MakeExtent(box));
    }
  };
  for (const RemovedTetrahedron& removed : replacement.Removed)
  {
    add(removed.Places, -1);
  }
  bool areWithinLimit = true;
  ForEachReplaced(replacement.Kept, static_cast<std::int32_t>(this->Survey.NumberOfTetrahedra),
    static_cast<std::int32_t>(this->Tetrahedra.size()),
    [&](std::int32_t, std::int32_t, std::int32_t begin, std::int32_t end)
    {
      for (std::int32_t id = begin; id < end && areWithinLimit; ++id)
      {
        const TileGrid::Places places = TileGrid::GetPlaces(this->Tetrahedra[id], this->RestPoints);
        areWithinLimit = TileGrid::IsWithinLimit(places);
        if (areWithinLimit)
        {
          add(places, 1);
        }
      }
    });
  return areWithinLimit;
}

MappingUpdate StaticMappingUpdater::Build() const
{
  MappingUpdate update;
  update.Kept = this->Kept;
  update.Changed = this->Changed;
  for (const std::int64_t tile : this->Tiles)
  {
    update.Boxes.push_back(MakeExtent(this->Linker->GetTiles().GetVoxels(tile)));
  }
  if (this->RunBytes > 0)
  {
    update.Runs = RunBuilder(*this->Linker, this->Voxels, this->RestPoints, this->Tetrahedra)
                    .BuildTiles(this->Tiles, update.NumberOfInnerVoxels);
  }
  else
  {
    this->BuildLinks(update);
  }
  return update;
}

void StaticMappingUpdater::BuildLinks(MappingUpdate& update) const
{
  std::vector<std::int64_t> begins;
  std::int64_t voxels = 0;
  for (const Extent& box : update.Boxes)
  {
    begins.push_back(voxels);
    voxels += GetNumberOfPoints(box);
  }
  update.Links.resize(voxels);
  std::atomic<std::int64_t> inner{ 0 };
  ParallelForParts(this->Tiles.size(), 1,
    [&](std::size_t i, std::size_t)
    {
      const Extent& box = update.Boxes[i];
      const VoxelTarget<VertexLink> target{ update.Links.data() + begins[i],
        { box[0], box[2], box[4] }, { GetSize(box, 0), GetSize(box, 1) } };
      inner += this->Linker->LinkTile(this->Tiles[i], MakeVoxelBox(box), target);
    });
  update.NumberOfInnerVoxels = inner;
}

} // namespace deformvolume
