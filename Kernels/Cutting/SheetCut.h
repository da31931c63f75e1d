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

/// Finds the tetrahedra of the sampling mesh that a sheet crosses, exactly (rule in
/// TriangleCrossing). A tetrahedron that is not crossed lies on one side of the sheet. So if the
/// sheet has no edge inside the volume, the remaining tetrahedra on one side share no face with the
/// remaining tetrahedra on the other side. Tetrahedra with a vertex without position are not
/// crossed. Throws an Error if a brick that the sheet may cross is deformed to more than 2,048
/// voxels, for which 64 bits are not enough.
DEFORMVOLUME_EXPORT TetrahedronSet FindCrossedTetrahedra(
  const VertexPositions& positions, const Sheet& sheet, const EditProgress& progress = nullptr);

/// Finds where a sheet crosses the edges of the sampling mesh, exactly, for a cut that divides
/// tetrahedra (SmoothCrossings). The first triangle of each connected component of the sheet
/// determines its positive side. Vertices without position and errors: see FindCrossedTetrahedra().
DEFORMVOLUME_EXPORT CrossingSet FindSheetCrossings(
  const VertexPositions& positions, const Sheet& sheet, const EditProgress& progress = nullptr);

} // namespace deformvolume

#endif
