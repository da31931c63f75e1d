// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeMaterials_h
#define DeformVolumeVolumeMaterials_h

#include "ElasticBody.h"
#include "ImageGeometry.h"
#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// The materials of the voxels of a volume.
struct VolumeMaterials
{
  ImageGeometry Volume;
  /// For each voxel an index into Table. x varies fastest.
  std::vector<unsigned char> Indices;
  std::vector<ElasticMaterial> Table;
  /// Ghosts of the voxels (FindPointGhosts()). Hidden and duplicate voxels are ignored.
  const unsigned char* Ghosts = nullptr;
  /// Material of tetrahedra for which no voxel is found.
  ElasticMaterial Default;
};

/// The materials of tetrahedra, as means over voxels.
struct MaterialMeans
{
  std::vector<ElasticMaterial> Materials; // of each tetrahedron
  /// Number of tetrahedra that contain no voxel and have the material of the nearest voxel.
  std::int64_t NumberWithNearest = 0;
  /// Number of tetrahedra with the default material: outside the volume, or near ignored voxels.
  std::int64_t NumberWithDefault = 0;
};

/// Computes the mean Young modulus, Poisson ratio and density of the voxels in each tetrahedron. A
/// voxel that several tetrahedra contain belongs to one of them, as in the static mapping
/// (StaticMappingBuilder). A tetrahedron without voxels has the material of the voxel nearest to
/// its centroid. The result does not depend on the number of threads.
///
/// points: in world coordinates. progress: as in StaticMappingBuilder::Build(). Throws Aborted if
/// it returns false.
MaterialMeans FindMaterialMeans(const VolumeMaterials& volume,
  const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra,
  const std::function<bool(double)>& progress);

} // namespace deformvolume

#endif
