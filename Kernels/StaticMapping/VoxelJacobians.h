// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVoxelJacobians_h
#define DeformVolumeVoxelJacobians_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "Extent.h"
#include "StaticMapping.h"
#include "Tetrahedron.h"
#include "VertexLink.h"
#include "VoxelGrid.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Jacobian determinants of the deformation by a mesh, at each voxel of a volume: the determinant
/// of the derivative of the deformed position with respect to the position at rest. It is the
/// factor by which the deformation changes volumes, and negative where the deformation inverts
/// them. It is computed from the given displacements, not from rounded positions.
///
/// A voxel has the determinant of the tetrahedron to which it is linked. A voxel without a link has
/// that of the nearest linked voxel. If voxels outside the mesh are kept, their determinants are
/// computed from finite differences of the displacements of neighboring voxels.
class DEFORMVOLUME_EXPORT VoxelJacobians
{
public:
  /// Set the static mapping of the voxels. The mapping is not used after the call. spacing: of the
  /// volume, in world units. restPoints: in continuous indices of the volume.
  void SetMapping(const Extent& voxels, const glm::dvec3& spacing, const StaticMapping& mapping,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra);

  /// Computes the determinants. tetrahedra: of the mapping; their nodes may have been replaced by
  /// others with the same positions at rest. displacements: three floats per node, in output
  /// voxels. jacobians: one value per voxel, with x varying fastest.
  void Compute(const OutputMap& toOutput, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, const float* displacements, float* jacobians);

private:
  void ComputeOutside(const OutputMap& toOutput, const std::vector<Tetrahedron>& tetrahedra,
    const float* displacements, float* jacobians) const;

  Extent Voxels = EmptyExtent;
  std::vector<std::int32_t> Owners; // the tetrahedron of each voxel; negative: none
  // Used if voxels outside the mesh are kept:
  std::vector<VertexLink> Links;
  FadedLinks Faded;
};

/// Computes the Jacobian determinants of a forward displacement field by central differences, from
/// displacements half a voxel before and after each voxel. If one of these is undefined, the
/// difference is one-sided. undefined: one byte per point of the field; empty: all are defined.
DEFORMVOLUME_EXPORT void ComputeFieldJacobians(const VoxelGrid& voxelGrid,
  const DisplacementField& field, const std::vector<unsigned char>& undefined, float* jacobians);

/// Computes the Jacobian determinants of the deformation that an inverse field describes, at the
/// voxels of an output. The field maps them to positions at rest. Infinite where the derivative of
/// the field's map is singular.
DEFORMVOLUME_EXPORT void ComputeInverseFieldJacobians(
  const Extent& output, const DisplacementField& inverse, float* jacobians);

} // namespace deformvolume

#endif
