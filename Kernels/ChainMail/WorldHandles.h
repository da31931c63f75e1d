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

/// The matrix of a volume for ChainMailModel::SetVoxelGrid().
DEFORMVOLUME_EXPORT std::array<double, 9> GetVoxelMatrix(const ImageGeometry& volume);

/// Handles of a volume by world coordinates: what each one holds at rest, and where it is now.
/// radius: of all of them, in world units.
DEFORMVOLUME_EXPORT std::vector<ChainMailHandle> MakeHandles(const ImageGeometry& volume,
  const std::vector<glm::dvec3>& rest, const std::vector<glm::dvec3>& now, double radius);

} // namespace deformvolume

#endif
