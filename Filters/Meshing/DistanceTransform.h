// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDistanceTransform_h
#define DeformVolumeDistanceTransform_h

#include "BodyLevelSet.h"

namespace deformvolume
{

/// Squares of the distances, in world units, from the nodes of the grid to the nearest voxel of the
/// body, exact but for rounding. complement: to the nearest one that is not of the body, those
/// beyond the volume's border included.
std::vector<float> SquaredDistances(
  const BodyLevelSet& grid, const BodyVoxels& body, bool complement);

} // namespace deformvolume

#endif
