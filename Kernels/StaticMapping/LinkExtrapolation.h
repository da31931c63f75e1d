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

/// Links each voxel without a tetrahedron to that of the nearest voxel with one (index difference
/// times spacing), with weights outside 0 to 1. Where voxels are equally near, which one it is
/// depends on neither threads nor runs. Nothing happens where no voxel has a tetrahedron.
///
/// progress gets the fraction done and may throw, which leaves links in an undefined state.
void ExtrapolateLinks(const Extent& voxels, const glm::dvec3& spacing,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  std::vector<VertexLink>& links, const std::function<void(double)>& progress);

} // namespace deformvolume

#endif
