// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRunBuilder_h
#define DeformVolumeRunBuilder_h

#include "Extent.h"
#include "Tetrahedron.h"
#include "VertexRuns.h"
#include "VoxelLinker.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// Builds the static mapping as runs. It processes a few tiles of a VoxelLinker at a time, in
/// parallel, and stores the tetrahedra of the voxels of these tiles only. The arguments of the
/// constructor must outlive the object. The displacement of a voxel does not depend, bit for bit,
/// on the part of the volume for which the runs are made.
class RunBuilder
{
public:
  RunBuilder(const VoxelLinker& linker, const Extent& voxels,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra);

  /// Counts of some tiles: their rows of voxels, the runs in these rows, and those of the runs that
  /// are in slivers (LargestWeightVariation).
  struct Sample
  {
    double Rows = 0.0;
    double Runs = 0.0;
    double RunsOfSlivers = 0.0;
  };
  /// Counts the rows and runs of a deterministic sample of tiles, for an estimate of the number of
  /// runs. Voxels outside the mesh form runs, too.
  Sample SampleTiles() const;

  /// Builds the runs of a part of the volume, which must have complete rows. numberOfInnerVoxels:
  /// returns the number of voxels with a tetrahedron. progress: called with the fraction done; it
  /// may throw. Throws Error if there are more than 2^32 runs.
  VertexRuns Build(const Extent& part, std::int64_t& numberOfInnerVoxels,
    const std::function<void(double)>& progress) const;

private:
  struct TileRuns
  {
    /// The runs of the rows of the tile, in sequence. Their tetrahedra are numbers in the mesh.
    std::vector<VertexRun> Runs;
    std::vector<std::uint32_t> RunsOfRow;
    std::int64_t InnerVoxels = 0;
  };
  class Numbering;

  std::vector<std::int64_t> ChooseTiles() const;
  /// box: the voxels of the tile.
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
