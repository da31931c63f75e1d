// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStaticMappingUpdater_h
#define DeformVolumeStaticMappingUpdater_h

#include "DeformVolumeExport.h"
#include "Extent.h"
#include "MappingSurvey.h"
#include "MappingUpdate.h"
#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace deformvolume
{

class VoxelLinker;

/// Brings a static mapping up to date where some tetrahedra of a mesh are replaced by others: maps
/// the voxels of those tiles (TetrahedronTiles.h) anew that tetrahedra which are gone, or new, lie
/// in. Only of these voxels can another tetrahedron be the first one that holds them, as
/// tetrahedra that are kept stay in their order, which decides where several are in one place.
/// What comes out is the mapping that StaticMappingBuilder makes, of the whole volume.
class DEFORMVOLUME_EXPORT StaticMappingUpdater
{
public:
  /// before: that of the mapping of before (StaticMappingBuilder::GetSurvey). The others as for a
  /// StaticMappingBuilder, of now; they must live and stay the same until Build returns.
  StaticMappingUpdater(const Extent& voxels, const MappingSurvey& before,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
    const TetrahedronReplacement& replacement);
  ~StaticMappingUpdater();
  StaticMappingUpdater(const StaticMappingUpdater&) = delete;
  StaticMappingUpdater& operator=(const StaticMappingUpdater&) = delete;

  /// False where the mapping is to be made anew: too many tiles are touched, voxels are
  /// extrapolated, the mapping has another form now, or the mesh may be an error.
  bool IsWorthwhile() const { return this->Worthwhile; }

  ///@{
  /// Where it is worthwhile. See StaticMappingBuilder.
  const MappingSurvey& GetSurvey() const { return this->Survey; }
  std::uint64_t GetRunBytes() const { return this->RunBytes; }
  MappingUpdate Build() const;
  ///@}

private:
  /// False where some are farther away than they may be.
  bool FindTouched(const TetrahedronReplacement& replacement, std::vector<unsigned char>& touched);
  void BuildLinks(MappingUpdate& update) const;

  const Extent Voxels;
  const std::vector<glm::dvec3>& RestPoints;
  const std::vector<Tetrahedron>& Tetrahedra;
  MappingSurvey Survey;
  std::uint64_t RunBytes = 0;
  bool Worthwhile = false;
  std::vector<KeptTetrahedra> Kept;
  std::vector<Extent> Changed;
  std::vector<std::int64_t> Tiles; // that are touched, in ascending order
  std::unique_ptr<VoxelLinker> Linker;
};

} // namespace deformvolume

#endif
