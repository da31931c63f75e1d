// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSurfaceInterior_h
#define DeformVolumeSurfaceInterior_h

#include "Carving.h"
#include "DeformVolumeExport.h"
#include "Sheet.h"
#include "SnappedPoint.h"

namespace deformvolume
{

/// The tool that carves out what a closed surface encloses: the points from which a ray crosses the
/// surface an odd number of times, so that a body within another one is a hole, and the orientation
/// of triangles does not matter.
///
/// Decided in whole numbers for points that are whole numbers of 1/1024 voxel, as centroids are;
/// others are rounded to them. As for sheets, points count as moved by (e, e^2, e^3): none lies on
/// the surface, and of neighbouring bodies that share a face exactly one holds a point there.
///
/// within: a box that holds all points that will be asked for. Throws Error where the surface is
/// not closed.
DEFORMVOLUME_EXPORT CarvingTool MakeSurfaceInterior(const Sheet& surface, const SnappedBox& within);

} // namespace deformvolume

#endif
