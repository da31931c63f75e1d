// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeNodeRotations_h
#define DeformVolumeNodeRotations_h

#include "AbortCheck.h"
#include "BlockMatrix.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Finds, for each of the given nodes, the rotation of its neighborhood between two states of a
/// body: the best fit of the edges at the node.
void FindNodeRotations(AbortCheck& abortCheck, const BlockPattern& pattern,
  const std::vector<std::int32_t>& nodes, const std::vector<glm::dvec3>& before,
  const std::vector<glm::dvec3>& now, std::vector<glm::dmat3>& rotations);

} // namespace deformvolume

#endif
