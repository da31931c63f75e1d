// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRunBuilder_h
#define DeformVolumeRunBuilder_h

#include "Extent.h"
#include "MappingSurvey.h"
#include "Tetrahedron.h"
#include "VertexRuns.h"
#include "VoxelLinker.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// Makes the static mapping by runs, some tiles of a VoxelLinker after the others, in parallel over
/// tiles, without ever holding more than the tetrahedra of the voxels of some tiles. What it is
/// made of must outlive it. The displacement of a voxel is the same to the last bit whatever part
/// of the volume the runs are made for.
class RunBuilder
{
public:
  RunBuilder(const VoxelLinker& linker, const Extent& voxels,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra);

  /// The tiles by which it is estimated how many runs there will be, always the same ones.
  static std::vector<std::int64_t> ChooseTiles(const TileGrid& tiles);
  /// What some tiles are found to have. Voxels outside the mesh form runs, too.
  std::vector<TileSample> SampleTiles(const std::vector<std::int64_t>& tiles) const;

  /// numberOfInnerVoxels: of voxels with a tetrahedron. progress gets the fraction done and may
  /// throw. Throws Error where there are more runs than 32 bits count.
  /// part: voxels of the volume, whole rows.
  VertexRuns Build(const Extent& part, std::int64_t& numberOfInnerVoxels,
    const std::function<void(double)>& progress) const;

private:
  struct TileRuns
  {
    /// Of the tile's rows, one after the other; with tetrahedra of the mesh.
    std::vector<VertexRun> Runs;
    std::vector<std::uint32_t> RunsOfRow;
    std::int64_t InnerVoxels = 0;
  };
  class Numbering;

  /// box: voxels of a tile.
  TileRuns MakeTileRuns(std::int64_t tile, const VoxelBox& box) const;
  void Append(const std::vector<TileRuns>& tiles, const VoxelBox& firstBox, Numbering& numbering,
    VertexRuns& runs) const;
  bool IsSliver(std::int32_t tetrahedron) const;
  RestTetrahedron MakeRest(std::int32_t tetrahedron, const glm::i64vec3& voxel) const;

  const VoxelLinker& Linker;
  const Extent Voxels;
  const std::vector<glm::dvec3>& RestPoints;
  const std::vector<Tetrahedron>& Tetrahedra;
};

} // namespace deformvolume

#endif
