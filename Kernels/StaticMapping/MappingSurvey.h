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
  /// Runs where they are long enough (LeastMeanRunLength, by a sample of the volume that is always
  /// the same) and need less memory than links, and voxels outside the mesh are discarded; else
  /// links.
  Automatic,
  /// A link for each voxel.
  Links,
  /// Not where voxels outside the mesh are linked, which needs to see all of them at once.
  Runs
};

/// Runs are made where they are so long on average, in voxels: below, finding the run of a voxel
/// costs what reading less memory gains.
constexpr double LeastMeanRunLength = 3.0;

/// What a tile of a volume, some rows of voxels, is found to have.
struct TileSample
{
  /// Rows of voxels.
  std::int64_t Rows = 0;
  /// Runs in these rows.
  std::int64_t Runs = 0;
  /// Those of them that are in slivers (LargestWeightVariation).
  std::int64_t RunsOfSlivers = 0;
};

/// What the choice between the forms of a static mapping follows from, and what is counted of a
/// mesh.
struct MappingSurvey
{
  /// The form that is asked for.
  StaticMappingForm Form = StaticMappingForm::Automatic;
  /// Whether voxels outside the mesh have links.
  bool IsOutsideLinked = false;
  /// Tetrahedra of the mesh.
  std::int64_t NumberOfTetrahedra = 0;
  /// Tetrahedra of the mesh without volume at rest.
  std::int64_t NumberOfFlatTetrahedra = 0;
  /// Of all tiles; tetrahedra in several are counted several times.
  std::int64_t NumberOfEntries = 0;
  /// None where there is no choice.
  std::vector<TileSample> Samples;

  /// Bytes that runs will take (GetRunBytes in VertexRuns.h), about; 0 where links are made.
  DEFORMVOLUME_EXPORT std::uint64_t GetRunBytes(const Extent& voxels) const;
};

} // namespace deformvolume

#endif
