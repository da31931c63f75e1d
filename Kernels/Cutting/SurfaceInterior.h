// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSurfaceInterior_h
#define DeformVolumeSurfaceInterior_h

#include "Carving.h"
#include "DeformVolumeExport.h"
#include "Sheet.h"
#include "SnappedPoint.h"

namespace deformvolume
{

/// Makes a tool that carves the interior of a closed surface: the points from which a ray crosses
/// the surface an odd number of times. So a body inside another one is a hole, and the orientation
/// of triangles does not matter.
///
/// The interior is decided with integers. Points are rounded to multiples of 1/1024 voxel, which
/// changes neither snapped points nor centroids of tetrahedra. As for sheets, points are shifted
/// symbolically by (e, e^2, e^3). So no point lies on the surface, and a point on the common face
/// of two bodies is in exactly one of them.
///
/// within: a box of all points that will be tested. Throws an Error if the surface is not closed.
DEFORMVOLUME_EXPORT CarvingTool MakeSurfaceInterior(const Sheet& surface, const SnappedBox& within);

} // namespace deformvolume

#endif
