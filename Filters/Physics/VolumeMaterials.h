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
  /// Of each voxel, x varying fastest, an index into the table.
  std::vector<unsigned char> Indices;
  std::vector<ElasticMaterial> Table;
  /// The ghosts of voxels (FindPointGhosts): those that are hidden or duplicate do not count.
  const unsigned char* Ghosts = nullptr;
  /// Of tetrahedra that no voxel says anything of.
  ElasticMaterial Default;
};

/// What a volume says of tetrahedra.
struct MaterialMeans
{
  std::vector<ElasticMaterial> Materials; // of each tetrahedron
  /// Tetrahedra that hold no voxel, and have the material of the one that is nearest.
  std::int64_t NumberWithNearest = 0;
  /// Those outside the volume, or where voxels do not count.
  std::int64_t NumberWithDefault = 0;
};

/// The mean Young modulus, Poisson ratio and density of the voxels that each tetrahedron holds. A
/// voxel on the border of several counts for one of them, as in the deformation mapping
/// (StaticMappingBuilder). A tetrahedron that holds none has the material of the voxel that is
/// nearest to its centroid. The result does not depend on the number of threads.
///
/// points: world coordinates. progress: as in StaticMappingBuilder::Build; throws Aborted where it
/// returns false.
MaterialMeans FindMaterialMeans(const VolumeMaterials& volume,
  const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra,
  const std::function<bool(double)>& progress);

} // namespace deformvolume

#endif
