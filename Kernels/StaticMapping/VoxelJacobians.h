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

/// The determinant of the derivative of the deformed position with respect to the position at rest,
/// at each voxel of a volume in a deformation mesh: how many times as large the deformation makes
/// the volume there; less than 0 where it turns it inside out. From displacements as they are
/// given, which no position rounds.
///
/// A voxel has that of the tetrahedron it is linked to, and a voxel without link that of the
/// nearest voxel with one. Where voxels outside the mesh are kept, theirs is found from the
/// differences of the displacements of neighbouring voxels.
class DEFORMVOLUME_EXPORT VoxelJacobians
{
public:
  /// mapping: that of these voxels, with its links or runs; it is looked at in this call only.
  /// spacing: of the volume, in world units. restPoints: in continuous indices of the volume.
  void SetMapping(const Extent& voxels, const glm::dvec3& spacing, const StaticMapping& mapping,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra);

  /// tetrahedra: those of the mapping, of which nodes may have been exchanged for others in the
  /// same places. displacements: three floats a node, in output voxels. jacobians: room for one a
  /// voxel, x varying fastest.
  void Compute(const OutputMap& toOutput, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, const float* displacements, float* jacobians);

private:
  void ComputeOutside(const OutputMap& toOutput, const std::vector<Tetrahedron>& tetrahedra,
    const float* displacements, float* jacobians) const;

  Extent Voxels{ { 0, -1, 0, -1, 0, -1 } };
  std::vector<std::int32_t> Owners; // the tetrahedron of each voxel, or less than 0
  // Where voxels outside are kept:
  std::vector<VertexLink> Links;
  FadedLinks Faded;
};

/// The same of a forward displacement field, from the differences of displacements half a voxel
/// before and after each voxel, or on one side of it where the other is undefined. undefined: one
/// byte a point of the field; empty: all are defined.
DEFORMVOLUME_EXPORT void ComputeFieldJacobians(const VoxelGrid& voxelGrid,
  const DisplacementField& field, const std::vector<unsigned char>& undefined, float* jacobians);

/// The same at the voxels of an output, of an inverse field, which leads from them to the places at
/// rest that are seen there. Infinite where it leads many of them to one place.
DEFORMVOLUME_EXPORT void ComputeInverseFieldJacobians(
  const Extent& output, const DisplacementField& inverse, float* jacobians);

} // namespace deformvolume

#endif
