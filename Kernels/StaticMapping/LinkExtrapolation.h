// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLinkExtrapolation_h
#define DeformVolumeLinkExtrapolation_h

#include "Extent.h"
#include "Tetrahedron.h"
#include "VertexLink.h"

#include <glm/vec3.hpp>

#include <functional>
#include <vector>

namespace deformvolume
{

/// Links each voxel without a tetrahedron to the tetrahedron of the nearest voxel that has one,
/// with weights outside 0 to 1. Distances are in world units (index difference times spacing). If
/// several voxels are equally near, the choice is deterministic. Does nothing if no voxel has a
/// tetrahedron.
///
/// progress: called with the fraction done. It may throw; the links are then undefined.
void ExtrapolateLinks(const Extent& voxels, const glm::dvec3& spacing,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  std::vector<VertexLink>& links, const std::function<void(double)>& progress);

} // namespace deformvolume

#endif
