// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformedBounds_h
#define DeformVolumeDeformedBounds_h

#include "IndexBounds.h"
#include "VolumeDeformer.h" // for Lattice, Tetrahedron, DisplacementField, VertexLink

#include <vector>

namespace deformvolume
{

/// Bounds of all linked voxels after the deformation: for links that extrapolate.
IndexBounds ComputeDeformedBounds(const Lattice& lattice, const std::vector<VertexLink>& links,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements);

/// Bounds of the part of the volume that a displacement field covers (all of it where the field
/// extrapolates), after the deformation. Exact where the field's points are the voxels, otherwise
/// no smaller than the truth, and exact for a constant field.
IndexBounds ComputeDeformedBounds(const Lattice& lattice, const DisplacementField& field);

} // namespace deformvolume

#endif
