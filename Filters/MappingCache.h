// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMappingCache_h
#define DeformVolumeMappingCache_h

#include "Deformation.h"
#include "ImageGeometry.h"
#include "StaticMapping.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace deformvolume
{

/// Keeps the static mapping of a volume into a deformation mesh for as long as it serves.
class MappingCache
{
public:
  /// Bytes of the runs of the mapping of a volume and a mesh, 0 where it has links: of the mapping
  /// that is there, or else, about, of that which Update will make.
  std::uint64_t GetRunBytes(
    const Deformation& deformation, const ImageGeometry& volume, bool extrapolate);

  /// Makes the mapping that of a volume and a mesh, with its links or runs. Throws an Error where
  /// the mesh holds no voxel, and Aborted where progress asked for an end.
  void Update(const Deformation& deformation, const ImageGeometry& volume, bool extrapolate,
    const std::function<bool(double)>& progress);

  /// Whether the mapping is that of a volume and a mesh, with or without its links or runs.
  bool IsCurrent(
    const Deformation& deformation, const ImageGeometry& volume, bool extrapolate) const;

  const std::vector<VertexLink>& GetLinks() const { return this->Mapping.Links; }
  const VertexRuns& GetRuns() const { return this->Mapping.Runs; }
  /// Whether it has runs, and not links.
  bool IsByRuns() const { return this->RunBytes > 0; }
  bool HasVoxels() const
  {
    return !this->Mapping.Links.empty() || !this->Mapping.Runs.Runs.empty();
  }
  /// Frees the links or runs.
  void ReleaseVoxels();

  /// Changes with the mapping.
  std::uint64_t GetVersion() const { return this->Version; }
  std::int64_t GetNumberOfFlatTetrahedra() const { return this->Mapping.NumberOfFlatTetrahedra; }
  std::int64_t GetNumberOfBuilds() const { return this->NumberOfBuilds; }

  /// Seconds spent since the last call.
  double TakeTime();

private:
  // What a mapping depends on.
  struct Key
  {
    const Deformation* Source = nullptr;
    std::uint64_t RestVersion = 0;
    ImageGeometry Volume;
    bool Extrapolate = false;
    bool operator==(const Key& other) const
    {
      return this->Source == other.Source && this->RestVersion == other.RestVersion &&
        this->Volume == other.Volume && this->Extrapolate == other.Extrapolate;
    }
  };

  /// The builder for a key, made ahead by GetRunBytes or now.
  StaticMappingBuilder& GetBuilder(const Deformation& deformation, const Key& key);

  StaticMapping Mapping;
  Key MappingKey; // without a source: there is no mapping
  std::uint64_t RunBytes = 0;
  std::unique_ptr<StaticMappingBuilder> Builder;
  Key BuilderKey;
  std::uint64_t Version = 0;
  std::int64_t NumberOfBuilds = 0;
  double Time = 0.0;
};

} // namespace deformvolume

#endif
