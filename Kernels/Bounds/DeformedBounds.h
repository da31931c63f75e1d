// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformedBounds_h
#define DeformVolumeDeformedBounds_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "IndexBounds.h"
#include "Tetrahedron.h"
#include "VertexLink.h"
#include "VoxelGrid.h"

#include <vector>

namespace deformvolume
{

/// Computes the bounds of all linked voxels after the deformation. For meshes with
/// OutsideVoxels::Modes::Extrapolate. displacements: three floats per node, in output voxels.
DEFORMVOLUME_EXPORT IndexBounds ComputeDeformedBounds(const VoxelGrid& voxelGrid,
  const std::vector<VertexLink>& links, const std::vector<Tetrahedron>& tetrahedra,
  const float* displacements);

/// Computes bounds, after the deformation, of the part of the volume that a displacement field
/// covers. This is the whole volume if the field extrapolates. The bounds are exact if the points
/// of the field are voxels, and for constant fields. Otherwise they may be too large, but never too
/// small.
DEFORMVOLUME_EXPORT IndexBounds ComputeDeformedBounds(
  const VoxelGrid& voxelGrid, const DisplacementField& field);

} // namespace deformvolume

#endif
