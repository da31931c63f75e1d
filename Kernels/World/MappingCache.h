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

/// What a static mapping is made for.
struct MappedVolume
{
  /// The whole volume.
  ImageGeometry Whole;
  /// The voxels to map: all of them, or a part with whole rows where voxels outside the mesh are
  /// discarded.
  Extent Part{ { 0, -1, 0, -1, 0, -1 } };
  /// What becomes of voxels outside the mesh.
  OutsideVoxels Outside;

  /// Whether the whole volume is mapped.
  bool IsWhole() const { return this->Part == this->Whole.PointExtent; }
  /// Whether the same voxels are mapped in the same way.
  bool operator==(const MappedVolume& other) const
  {
    return this->Whole == other.Whole && this->Part == other.Part && this->Outside == other.Outside;
  }
};

/// Keeps the static mapping of a volume into a deformation mesh for as long as it serves. What all
/// parts of a volume have in common is found once.
class DEFORMVOLUME_EXPORT MappingCache
{
public:
  /// Bytes that the runs of the mapping of a volume and a mesh take, about; 0 where it has links.
  /// The same before and after Update, so that what is chosen by it does not depend on what came
  /// before.
  std::uint64_t GetRunBytes(const MeshAtRest& mesh, const MappedVolume& volume);

  /// Makes the mapping that of a volume and a mesh, with its links or runs. Throws an Error where
  /// the mesh holds no voxel of the whole volume, and Aborted where progress asked for an end.
  void Update(const MeshAtRest& mesh, const MappedVolume& volume,
    const std::function<bool(double)>& progress);

  /// Whether the mapping is that of a volume and a mesh, with or without its links or runs.
  bool IsCurrent(const MeshAtRest& mesh, const MappedVolume& volume) const;

  /// The mapping of the last Update().
  const StaticMapping& GetMapping() const { return this->Mapping; }
  /// Its links; empty where it has runs.
  const std::vector<VertexLink>& GetLinks() const { return this->Mapping.Links; }
  /// Its runs; empty where it has links.
  const VertexRuns& GetRuns() const { return this->Mapping.Runs; }
  /// Whether it has runs, and not links.
  bool IsByRuns() const { return this->RunBytes > 0; }
  /// Whether the mapping has its links or runs: not after ReleaseVoxels().
  bool HasVoxels() const
  {
    return !this->Mapping.Links.empty() || !this->Mapping.Runs.Runs.empty();
  }
  /// Frees the links or runs, and the boundary; those of kept voxels leave FadedLinks.
  void ReleaseVoxels();

  /// Changes with the mapping.
  std::uint64_t GetVersion() const { return this->Version; }
  /// Tetrahedra of the mesh without volume at rest.
  std::int64_t GetNumberOfFlatTetrahedra() const { return this->Mapping.NumberOfFlatTetrahedra; }
  /// How many mappings Update() has made.
  std::int64_t GetNumberOfBuilds() const { return this->NumberOfBuilds; }

  /// Seconds spent since the last call.
  double TakeTime();

private:
  // What a mapping depends on.
  struct Key
  {
    const void* Owner = nullptr;
    std::uint64_t ShapeVersion = 0;
    MappedVolume Volume;
    bool operator==(const Key& other) const
    {
      return this->Owner == other.Owner && this->ShapeVersion == other.ShapeVersion &&
        this->Volume == other.Volume;
    }
  };

  /// The builder for a key, made ahead by GetRunBytes or now.
  StaticMappingBuilder& GetBuilder(const MeshAtRest& mesh, const Key& key);

  StaticMapping Mapping;
  Key MappingKey; // without an owner: there is no mapping
  std::uint64_t RunBytes = 0;
  std::unique_ptr<StaticMappingBuilder> Builder;
  Key BuilderKey; // that of the whole volume
  std::uint64_t Version = 0;
  std::int64_t NumberOfBuilds = 0;
  double Time = 0.0;
};

} // namespace deformvolume

#endif
