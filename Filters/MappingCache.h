// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMappingCache_h
#define DeformVolumeMappingCache_h

#include "Deformation.h"
#include "ImageGeometry.h"
#include "StaticMapping.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// Keeps the static mapping of a volume into a deformation mesh for as long as it serves.
class MappingCache
{
public:
  /// Makes the mapping that of a volume and a mesh, with its links. Throws an Error where the mesh
  /// holds no voxel, and Aborted where progress asked for an end.
  void Update(const Deformation& deformation, const ImageGeometry& volume, bool extrapolate,
    const std::function<bool(double)>& progress);

  /// Whether the mapping is that of a volume and a mesh, with or without its links.
  bool IsCurrent(
    const Deformation& deformation, const ImageGeometry& volume, bool extrapolate) const;

  const std::vector<VertexLink>& GetLinks() const { return this->Mapping.Links; }
  bool HasLinks() const { return !this->Mapping.Links.empty(); }
  /// Frees the links: 16 bytes a voxel.
  void ReleaseLinks() { std::vector<VertexLink>().swap(this->Mapping.Links); }

  /// Changes with the mapping.
  std::uint64_t GetVersion() const { return this->Version; }
  std::int64_t GetNumberOfFlatTetrahedra() const { return this->Mapping.NumberOfFlatTetrahedra; }
  std::int64_t GetNumberOfBuilds() const { return this->NumberOfBuilds; }

  /// Seconds spent since the last call.
  double TakeTime();

private:
  StaticMapping Mapping;
  std::uint64_t RestVersion = 0;
  ImageGeometry Volume;
  bool Extrapolate = false;
  bool Valid = false;
  std::uint64_t Version = 0;
  std::int64_t NumberOfBuilds = 0;
  double Time = 0.0;
};

} // namespace deformvolume

#endif
