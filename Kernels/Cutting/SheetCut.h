// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSheetCut_h
#define DeformVolumeSheetCut_h

#include "CrossingSet.h"
#include "DeformVolumeExport.h"
#include "EditProgress.h"
#include "Sheet.h"
#include "TetrahedronSet.h"
#include "VertexPositions.h"

namespace deformvolume
{

/// The tetrahedra of the sampling mesh that a sheet crosses, exactly (TriangleCrossing has the
/// rule). A tetrahedron that it does not cross lies on one side of it: where a sheet has no edge
/// within the volume, no tetrahedron that is left shares a face with one on the other side. A
/// tetrahedron with a vertex that has no position is not crossed. Throws Error where the
/// deformation draws a brick that may be crossed out to more than 2,048 voxels, which is too large
/// for 64 bits.
DEFORMVOLUME_EXPORT TetrahedronSet FindCrossedTetrahedra(
  const VertexPositions& positions, const Sheet& sheet, const EditProgress& progress = nullptr);

/// Where a sheet crosses the edges of the sampling mesh, exactly, for a cut that divides tetrahedra
/// (SmoothCrossings). Which side of the sheet is positive follows from the first triangle of each
/// of its pieces. All else is as above.
DEFORMVOLUME_EXPORT CrossingSet FindSheetCrossings(
  const VertexPositions& positions, const Sheet& sheet, const EditProgress& progress = nullptr);

} // namespace deformvolume

#endif
