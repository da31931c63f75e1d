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

/// Bounds of all linked voxels after the deformation: for links that extrapolate.
DEFORMVOLUME_EXPORT IndexBounds ComputeDeformedBounds(const VoxelGrid& voxelGrid,
  const std::vector<VertexLink>& links, const std::vector<Tetrahedron>& tetrahedra,
  const float* displacements);

/// Bounds of the part of the volume that a displacement field covers (all of it where the field
/// extrapolates), after the deformation. Exact where the field's points are the voxels, otherwise
/// no smaller than the truth, and exact for a constant field.
DEFORMVOLUME_EXPORT IndexBounds ComputeDeformedBounds(
  const VoxelGrid& voxelGrid, const DisplacementField& field);

} // namespace deformvolume

#endif
