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

/// What the output does not show of the volume.
struct HiddenTetrahedra
{
  /// One byte per voxel; null if no voxel is blanked.
  const unsigned char* Blanked = nullptr;
  /// The bits of Blanked that hide a voxel.
  unsigned char BlankedBits = 255;
  /// One byte per cell with a bit for each active tetrahedron; null if all are active.
  const unsigned char* Active = nullptr;
  /// One byte per cell with a bit for each tetrahedron that a smooth cut divides, or null.
  const unsigned char* Cut = nullptr;
  /// Whether tetrahedra between two sides of a split of the deformation mesh are hidden.
  bool OpenSplits = false;
};

/// Jacobian determinants of the deformation by a mesh, at each voxel of a volume: the determinant
/// of the derivative of the deformed position with respect to the position at rest. It is the
/// factor by which the deformation changes volumes, and negative where the deformation inverts
/// them. It is computed from the given displacements, not from rounded positions.
///
/// A voxel has the determinant of the tetrahedron to which it is linked. A voxel without a link has
/// that of the nearest linked voxel. If voxels outside the mesh are kept, they have their volume
/// ratio.
///
/// The volume ratio of a voxel is the deformed volume of the tetrahedra of the sampling mesh around
/// it, divided by their volume at rest. Values that are divided by it keep their sum when they are
/// interpolated over the deformed tetrahedra. Hidden tetrahedra do not count, so the two sides of a
/// cut do not affect each other. A voxel whose tetrahedra are all hidden has its Jacobian instead.
class DEFORMVOLUME_EXPORT VoxelJacobians
{
public:
  /// Set the static mapping of the voxels. The mapping is not used after the call. spacing: of the
  /// volume, in world units. restPoints: in continuous indices of the volume.
  void SetMapping(const Extent& voxels, const glm::dvec3& spacing, const StaticMapping& mapping,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra);

  /// Computes the determinants. tetrahedra: of the mapping; their nodes may have been replaced by
  /// others with the same positions at rest. displacements: three floats per node, in output
  /// voxels. jacobians, ratios: one value per voxel, with x varying fastest. ratios may be null.
  void Compute(const OutputMap& toOutput, const std::vector<glm::dvec3>& restPoints,
    const std::vector<Tetrahedron>& tetrahedra, const float* displacements,
    const HiddenTetrahedra& hidden, float* jacobians, float* ratios) const;

private:
  Extent Voxels = EmptyExtent;
  // The tetrahedron of each voxel. For a discarded voxel ~i, if i is that of the nearest voxel
  // inside.
  std::vector<std::int32_t> Owners;
  std::vector<std::int64_t> Crossed; // see MeshBoundary
  // Used if voxels outside the mesh are kept:
  std::vector<VertexLink> Links;
  FadedLinks Faded;
};

/// Computes the Jacobian determinants of a forward displacement field: the volume ratios of
/// VoxelJacobians. A voxel whose tetrahedra are all hidden has the derivative of the field, by
/// differences between positions half a voxel before and after it, or one-sided next to undefined
/// points. undefined: one byte per point of the field; empty: all are defined.
DEFORMVOLUME_EXPORT void ComputeFieldJacobians(const VoxelGrid& voxelGrid,
  const DisplacementField& field, const std::vector<unsigned char>& undefined,
  const HiddenTetrahedra& hidden, float* jacobians);

/// Computes the Jacobian determinants of the deformation that an inverse field describes, at the
/// voxels of an output. The field maps them to positions at rest. Infinite where the derivative of
/// the field's map is singular.
DEFORMVOLUME_EXPORT void ComputeInverseFieldJacobians(
  const Extent& output, const DisplacementField& inverse, float* jacobians);

} // namespace deformvolume

#endif
