// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMappingCache_h
#define DeformVolumeMappingCache_h

#include "DeformVolumeExport.h"
#include "ImageGeometry.h"
#include "MeshAtRest.h"
#include "OutsideVoxels.h"
#include "StaticMapping.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace deformvolume
{

/// The volume for which a static mapping is made.
struct MappedVolume
{
  /// The whole volume.
  ImageGeometry Whole;
  /// The voxels to map: all voxels or, if voxels outside the mesh are discarded, a part with whole
  /// rows.
  Extent Part = EmptyExtent;
  /// The treatment of voxels outside the mesh.
  OutsideVoxels Outside;

  /// Whether the whole volume is mapped.
  bool IsWhole() const { return this->Part == this->Whole.PointExtent; }
  /// Whether the same voxels are mapped in the same way.
  bool operator==(const MappedVolume& other) const
  {
    return this->Whole == other.Whole && this->Part == other.Part && this->Outside == other.Outside;
  }
};

/// Keeps the static mapping of a volume into a deformation mesh until another mapping is needed.
/// Data that all parts of a volume share are computed once.
class DEFORMVOLUME_EXPORT MappingCache
{
public:
  /// Returns the approximate memory, in bytes, of the runs of the mapping of a volume and a mesh; 0
  /// if the mapping has links. The result is the same before and after Update(), so that the choice
  /// of a resampler does not depend on earlier calls.
  std::uint64_t GetRunBytes(const MeshAtRest& mesh, const MappedVolume& volume);

  /// Makes the mapping of a volume and a mesh, with links or runs, unless it is current. Throws an
  /// Error if the mesh contains no voxel of the whole volume, and Aborted if progress returns
  /// false.
  void Update(const MeshAtRest& mesh, const MappedVolume& volume,
    const std::function<bool(double)>& progress);

  /// Whether the mapping is the one of a volume and a mesh, even if its links or runs were
  /// released.
  bool IsCurrent(const MeshAtRest& mesh, const MappedVolume& volume) const;

  /// Returns the mapping of the last Update().
  const StaticMapping& GetMapping() const { return this->Mapping; }
  /// Returns the links of the mapping; empty if it has runs.
  const std::vector<VertexLink>& GetLinks() const { return this->Mapping.Links; }
  /// Whether the mapping has links or runs. False after ReleaseVoxels().
  bool HasLinksOrRuns() const
  {
    return !this->Mapping.Links.empty() || !this->Mapping.Runs.Runs.empty();
  }
  /// Frees the links or runs, and the boundary. FadedLinks of kept voxels are not freed.
  void ReleaseVoxels();

  /// Returns a number that changes with the mapping.
  std::uint64_t GetVersion() const { return this->Version; }
  /// Returns the number of tetrahedra of the mesh without volume at rest.
  std::int64_t GetNumberOfFlatTetrahedra() const { return this->Mapping.NumberOfFlatTetrahedra; }
  /// Returns the number of mappings that Update() has made.
  std::int64_t GetNumberOfBuilds() const { return this->NumberOfBuilds; }

  /// Returns the seconds spent on mappings since the last call.
  double TakeTime();

private:
  // The data that a mapping depends on.
  struct Key
  {
    const void* Owner = nullptr; // identifies the mesh; only compared
    std::uint64_t ShapeVersion = 0;
    MappedVolume Volume;
    bool operator==(const Key& other) const
    {
      return this->Owner == other.Owner && this->ShapeVersion == other.ShapeVersion &&
        this->Volume == other.Volume;
    }
  };

  /// Returns the builder for a key, which GetRunBytes() may have made already.
  StaticMappingBuilder& GetBuilder(const MeshAtRest& mesh, const Key& key);

  StaticMapping Mapping;
  Key MappingKey; // without an owner: there is no mapping
  std::uint64_t RunBytes = 0;
  std::unique_ptr<StaticMappingBuilder> Builder;
  Key BuilderKey; // for the whole volume
  std::uint64_t Version = 0;
  std::int64_t NumberOfBuilds = 0;
  double Time = 0.0;
};

} // namespace deformvolume

#endif
