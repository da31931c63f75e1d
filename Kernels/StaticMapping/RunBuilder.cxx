// SPDX-License-Identifier: BSD-3-Clause
#include "RunBuilder.h"

#include "BarycentricMap.h"
#include "Error.h"
#include "ParallelFor.h"
#include "VertexRuns.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace deformvolume
{

// Numbers the records in the order of their first runs, which does not depend on threads. A
// tetrahedron has one record, and a sliver has one record for each run. The origin of the record of
// a tetrahedron does not depend on the part of the volume for which the runs are made.
class RunBuilder::Numbering
{
public:
  Numbering(const RunBuilder& builder, const Extent& part, std::vector<RestTetrahedron>& records)
    : Builder(builder)
    , First(part[0], part[2], part[4])
    , Records(records)
    , Known(builder.Tetrahedra.size(), Unknown)
  {
  }

  // voxel: the first voxel of the run.
  std::int32_t GetRecord(std::int32_t tetrahedron, glm::i64vec3 voxel)
  {
    std::int32_t& known = this->Known[tetrahedron];
    if (known >= 0)
    {
      return known;
    }
    const auto record = static_cast<std::int32_t>(this->Records.size());
    if (known == Unknown)
    {
      const bool shared =
        !this->Builder.IsSliver(tetrahedron) && this->Builder.Linker.FindVoxel(tetrahedron, voxel);
      known = shared ? record : Sliver;
    }
    RestTetrahedron rest = this->Builder.MakeRest(tetrahedron, voxel);
    for (int axis = 0; axis < 3; ++axis)
    {
      rest.Origin[axis] = static_cast<double>(voxel[axis] - this->First[axis]);
    }
    this->Records.push_back(rest);
    return record;
  }

  const glm::i64vec3& GetFirst() const { return this->First; }

private:
  static constexpr std::int32_t Unknown = -1;
  static constexpr std::int32_t Sliver = -2;

  const RunBuilder& Builder;
  const glm::i64vec3 First;
  std::vector<RestTetrahedron>& Records;
  std::vector<std::int32_t> Known;
};

RunBuilder::RunBuilder(const VoxelLinker& linker, const Extent& voxels,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra)
  : Linker(linker)
  , Voxels(voxels)
  , RestPoints(restPoints)
  , Tetrahedra(tetrahedra)
{
}

RunBuilder::TileRuns RunBuilder::MakeTileRuns(std::int64_t tile, const VoxelBox& box) const
{
  VoxelTarget<std::int32_t> target;
  std::copy(box.Min.begin(), box.Min.end(), target.First);
  target.Size[0] = box.Max[0] - box.Min[0] + 1;
  target.Size[1] = box.Max[1] - box.Min[1] + 1;
  const std::int64_t rows = target.Size[1] * (box.Max[2] - box.Min[2] + 1);
  std::vector<std::int32_t> tetrahedra(rows * target.Size[0], -1);
  target.Data = tetrahedra.data();

  TileRuns made;
  made.InnerVoxels = this->Linker.LinkTile(tile, box, target);
  made.RunsOfRow.reserve(rows);
  const std::int32_t* row = tetrahedra.data();
  for (std::int64_t r = 0; r < rows; ++r, row += target.Size[0])
  {
    const std::size_t before = made.Runs.size();
    std::int32_t last = -2;
    for (std::int64_t x = 0; x < target.Size[0]; ++x)
    {
      if (row[x] != last)
      {
        last = row[x];
        VertexRun run;
        run.Tetrahedron = last;
        run.Begin = static_cast<std::int32_t>(x);
        made.Runs.push_back(run);
      }
    }
    made.RunsOfRow.push_back(static_cast<std::uint32_t>(made.Runs.size() - before));
  }
  return made;
}

bool RunBuilder::IsSliver(std::int32_t tetrahedron) const
{
  const Tetrahedron& nodes = this->Tetrahedra[tetrahedron];
  glm::dvec3 min(this->Voxels[1], this->Voxels[3], this->Voxels[5]);
  glm::dvec3 max(this->Voxels[0], this->Voxels[2], this->Voxels[4]);
  const glm::dvec3 last = min;
  const glm::dvec3 first = max;
  for (const std::int32_t node : nodes)
  {
    min = glm::min(min, this->RestPoints[node]);
    max = glm::max(max, this->RestPoints[node]);
  }
  const glm::dvec3 extent = glm::min(max, last) - glm::max(min, first);
  BarycentricMap map;
  map.SetTetrahedron(nodes, this->RestPoints);
  for (int node = 0; node < 3; ++node)
  {
    if (!(glm::dot(glm::abs(map.GetGradient(node)), extent) <= LargestWeightVariation))
    {
      return true;
    }
  }
  return false;
}

RestTetrahedron RunBuilder::MakeRest(std::int32_t tetrahedron, const glm::i64vec3& voxel) const
{
  BarycentricMap map; // SetTetrahedron() succeeds: a tetrahedron with voxels is not flat
  map.SetTetrahedron(this->Tetrahedra[tetrahedron], this->RestPoints);
  const glm::dvec3 weights = map.GetWeights(glm::dvec3(voxel));
  RestTetrahedron rest;
  rest.Tetrahedron = tetrahedron;
  for (int i = 0; i < 3; ++i)
  {
    const glm::dvec3 gradient = map.GetGradient(i);
    rest.Weights[i] = weights[i];
    rest.Gradients[i] = { { gradient.x, gradient.y, gradient.z } };
  }
  return rest;
}

std::vector<std::int64_t> RunBuilder::ChooseTiles() const
{
  const TetrahedronTiles& tiles = this->Linker.GetTiles();
  constexpr std::int64_t most = 16;
  const std::int64_t count[2] = { tiles.GetNumberOfTiles(0), tiles.GetNumberOfTiles(1) };
  const std::int64_t samples = std::min(most, tiles.GetNumberOfTiles());
  std::vector<std::int64_t> chosen(samples);
  for (std::int64_t i = 0; i < samples; ++i)
  {
    chosen[i] = i;
    if (samples < tiles.GetNumberOfTiles())
    {
      // A low-discrepancy sequence, to avoid aliasing with a regular mesh: multiples of 1/p and
      // 1/p^2 modulo 1, where p is the plastic number.
      const double y = std::fmod((static_cast<double>(i) + 0.5) * 0.7548776662466927, 1.0);
      const double z = std::fmod((static_cast<double>(i) + 0.5) * 0.5698402909980532, 1.0);
      chosen[i] = static_cast<std::int64_t>(z * static_cast<double>(count[1])) * count[0] +
        static_cast<std::int64_t>(y * static_cast<double>(count[0]));
    }
  }
  return chosen;
}

RunBuilder::Sample RunBuilder::SampleTiles() const
{
  const std::vector<std::int64_t> tiles = this->ChooseTiles();
  std::vector<Sample> samples(tiles.size());
  ParallelForItems(tiles.size(), 1,
    [&](std::size_t i)
    {
      const TileRuns made =
        this->MakeTileRuns(tiles[i], this->Linker.GetTiles().GetVoxels(tiles[i]));
      samples[i].Runs = static_cast<double>(made.Runs.size());
      samples[i].Rows = static_cast<double>(made.RunsOfRow.size());
      samples[i].RunsOfSlivers =
        static_cast<double>(std::count_if(made.Runs.begin(), made.Runs.end(),
          [&](const VertexRun& run)
          { return run.Tetrahedron >= 0 && this->IsSliver(run.Tetrahedron); }));
    });
  Sample sum;
  for (const Sample& sample : samples)
  {
    sum.Rows += sample.Rows;
    sum.Runs += sample.Runs;
    sum.RunsOfSlivers += sample.RunsOfSlivers;
  }
  return sum;
}

void RunBuilder::Append(const std::vector<TileRuns>& tiles, const VoxelBox& firstBox,
  Numbering& numbering, VertexRuns& runs) const
{
  // Each plane of rows passes through all tiles, which are neighbors on y.
  const std::int64_t planes = firstBox.Max[2] - firstBox.Min[2] + 1;
  std::vector<const VertexRun*> next;
  std::vector<const std::uint32_t*> row;
  for (const TileRuns& tile : tiles)
  {
    next.push_back(tile.Runs.data());
    row.push_back(tile.RunsOfRow.data());
  }
  for (std::int64_t z = firstBox.Min[2]; z <= firstBox.Max[2]; ++z)
  {
    std::int64_t y = firstBox.Min[1];
    for (std::size_t tile = 0; tile < tiles.size(); ++tile)
    {
      const std::size_t rows = tiles[tile].RunsOfRow.size() / static_cast<std::size_t>(planes);
      for (std::size_t r = 0; r < rows; ++r, ++y, ++row[tile])
      {
        if (runs.Runs.size() + *row[tile] > std::numeric_limits<std::uint32_t>::max())
        {
          throw Error("The static mapping of the volume has more than 2^32 runs of voxels. Use a "
                      "smaller volume or a coarser mesh.");
        }
        runs.RowBegins.push_back(static_cast<std::uint32_t>(runs.Runs.size()));
        for (std::uint32_t i = 0; i < *row[tile]; ++i)
        {
          VertexRun run = *next[tile]++;
          if (run.Tetrahedron >= 0)
          {
            run.Tetrahedron = numbering.GetRecord(
              run.Tetrahedron, glm::i64vec3(numbering.GetFirst().x + run.Begin, y, z));
          }
          runs.Runs.push_back(run);
        }
      }
    }
  }
}

VertexRuns RunBuilder::Build(const Extent& part, std::int64_t& numberOfInnerVoxels,
  const std::function<void(double)>& progress) const
{
  const TetrahedronTiles& tiles = this->Linker.GetTiles();
  const TetrahedronTiles::Rectangle wanted = tiles.GetTiles(MakeVoxelBox(part));
  const std::int64_t across = wanted.End[0] - wanted.Begin[0];
  const std::int64_t layers = wanted.End[1] - wanted.Begin[1];
  const auto getTile = [&](std::int64_t layer, std::int64_t inLayer)
  { return (wanted.Begin[1] + layer) * tiles.GetNumberOfTiles(0) + wanted.Begin[0] + inLayer; };
  const auto getBox = [&](std::int64_t layer, std::int64_t inLayer)
  { return Intersect(tiles.GetVoxels(getTile(layer, inLayer)), MakeVoxelBox(part)); };
  VertexRuns runs;
  runs.RowBegins.reserve(GetSize(part, 1) * GetSize(part, 2) + 1);
  Numbering numbering(*this, part, runs.Tetrahedra);
  numberOfInnerVoxels = 0;
  // Process enough tiles at a time to keep all threads busy.
  const std::int64_t step = std::max<std::int64_t>(1, 64 / across);
  for (std::int64_t begin = 0; begin < layers; begin += step)
  {
    const std::int64_t end = std::min(begin + step, layers);
    std::vector<std::vector<TileRuns>> made(end - begin, std::vector<TileRuns>(across));
    ParallelForItems((end - begin) * across, 1,
      [&](std::int64_t tile)
      {
        const std::int64_t layer = tile / across;
        const std::int64_t inLayer = tile % across;
        made[layer][inLayer] =
          this->MakeTileRuns(getTile(begin + layer, inLayer), getBox(begin + layer, inLayer));
      });
    for (std::int64_t layer = begin; layer < end; ++layer)
    {
      this->Append(made[layer - begin], getBox(layer, 0), numbering, runs);
      for (const TileRuns& tile : made[layer - begin])
      {
        numberOfInnerVoxels += tile.InnerVoxels;
      }
    }
    progress(static_cast<double>(end) / static_cast<double>(layers));
  }
  runs.RowBegins.push_back(static_cast<std::uint32_t>(runs.Runs.size()));
  return runs;
}

} // namespace deformvolume
