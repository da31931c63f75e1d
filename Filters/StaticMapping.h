// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStaticMapping_h
#define DeformVolumeStaticMapping_h

#include "VolumeDeformer.h" // for Extent, Tetrahedron, VertexLink

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// The static part of the deformation mapping: a link of each voxel of the volume into the
/// tetrahedra of the deformation mesh at rest.
struct StaticMapping
{
  /// One link a voxel, x varying fastest.
  std::vector<VertexLink> Links;
  /// Voxels inside the mesh (extrapolated ones do not count).
  std::int64_t NumberOfInnerVoxels = 0;
  /// Tetrahedra without volume; they are skipped.
  std::int64_t NumberOfFlatTetrahedra = 0;
};

/// Finds the tetrahedron of each voxel by rasterising the tetrahedra into the voxel grid, in
/// parallel over slabs of voxels, with exact integer arithmetic on positions rounded to 1/256
/// voxel: no voxel inside the mesh is missed, those on its surface included, and the result does
/// not depend on the number of threads. Where tetrahedra overlap the one with the lowest index
/// gets the voxel.
///
/// voxels: structured indices of the volume. restPoints: the nodes at rest in continuous indices
/// of the volume. extrapolate: voxels outside the mesh are linked to the tetrahedron of the
/// nearest voxel (in continuous indices times spacing, hence world distance) inside it, with
/// weights outside 0 to 1; otherwise their link is -1. progress: as in DeformRequest; throws
/// Aborted where it returns false. Throws Error where a tetrahedron has a node more than 2^31
/// voxels away from index 0.
StaticMapping BuildStaticMapping(const Extent& voxels, const glm::dvec3& spacing,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  bool extrapolate, const std::function<bool(double)>& progress = {});

} // namespace deformvolume

#endif
