// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePointOrder_h
#define DeformVolumePointOrder_h

#include "DeformVolumeExport.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The numbers of all points, in an order in which points that follow each other are near to each
/// other: what maps them then finds what it needs in the processor's caches. Points are finite.
DEFORMVOLUME_EXPORT std::vector<std::int64_t> SortBySpace(const std::vector<glm::dvec3>& points);

} // namespace deformvolume

#endif
