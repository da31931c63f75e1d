// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCoincidentPoints_h
#define DeformVolumeCoincidentPoints_h

#include "DeformVolumeExport.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Returns for each point the lowest number of all points with the same position. A point that is
/// not finite has its own number.
DEFORMVOLUME_EXPORT std::vector<std::int32_t> FindCoincidentPoints(
  const std::vector<glm::dvec3>& points);

} // namespace deformvolume

#endif
