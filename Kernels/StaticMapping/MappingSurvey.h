// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMappingSurvey_h
#define DeformVolumeMappingSurvey_h

#include "DeformVolumeExport.h"
#include "Extent.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The form of a static mapping: a link for each voxel, or runs of voxels.
enum class StaticMappingForm
{
  /// Runs if voxels outside the mesh are discarded, and if runs are long enough
  /// (LeastMeanRunLength) and need less memory than links. Otherwise links. The lengths are
  /// estimated from a deterministic sample of the volume.
  Automatic,
  /// A link for each voxel.
  Links,
  /// Runs. Only possible if voxels outside the mesh are discarded.
  Runs
};

/// Least mean length of runs, in voxels, for which StaticMappingForm::Automatic chooses runs. With
/// shorter runs, the search for the run of a voxel takes the time that is saved by less memory
/// access.
constexpr double LeastMeanRunLength = 3.0;

/// Counts of a tile of a volume, which consists of rows of voxels.
struct TileSample
{
  /// Number of rows.
  std::int64_t Rows = 0;
  /// Number of runs in these rows.
  std::int64_t Runs = 0;
  /// Number of these runs that are in slivers (LargestWeightVariation).
  std::int64_t RunsOfSlivers = 0;
};

/// The data for the choice between the forms of a static mapping.
struct MappingSurvey
{
  /// The requested form.
  StaticMappingForm Form = StaticMappingForm::Automatic;
  /// Number of tetrahedra of the mesh.
  std::int64_t NumberOfTetrahedra = 0;
  /// Number of tetrahedra without volume at rest.
  std::int64_t NumberOfFlatTetrahedra = 0;
  /// Number of tetrahedra in the lists of all tiles. A tetrahedron in several tiles counts several
  /// times.
  std::int64_t NumberOfEntries = 0;
  /// Counts of some tiles. Empty if only links are possible.
  std::vector<TileSample> Samples;

  /// Estimates the bytes of the runs (GetRunBytes() in VertexRuns.h). 0 if links are chosen.
  DEFORMVOLUME_EXPORT std::uint64_t GetRunBytes(const Extent& voxels) const;
};

} // namespace deformvolume

#endif
