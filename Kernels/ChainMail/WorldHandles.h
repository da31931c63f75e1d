// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldHandles_h
#define DeformVolumeWorldHandles_h

#include "ChainMailTypes.h"
#include "DeformVolumeExport.h"
#include "ImageGeometry.h"

#include <glm/vec3.hpp>

#include <array>
#include <vector>

namespace deformvolume
{

/// Returns the argument indexToWorld of ChainMailModel::SetVoxelGrid() for a volume.
DEFORMVOLUME_EXPORT std::array<double, 9> GetVoxelMatrix(const ImageGeometry& volume);

/// Makes handles from world coordinates. rest: the rest position of each handle. now: its current
/// position. radius: of all handles, in world units.
DEFORMVOLUME_EXPORT std::vector<ChainMailHandle> MakeHandles(const ImageGeometry& volume,
  const std::vector<glm::dvec3>& rest, const std::vector<glm::dvec3>& now, double radius);

} // namespace deformvolume

#endif
