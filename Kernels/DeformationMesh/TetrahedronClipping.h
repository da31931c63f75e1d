// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronClipping_h
#define DeformVolumeTetrahedronClipping_h

#include "BarycentricMap.h"
#include "IndexBounds.h"

#include <array>

namespace deformvolume
{

/// A position at rest and its deformed position.
struct MovedPoint
{
  glm::dvec3 Rest;
  glm::dvec3 Moved;
};

/// Clips a tetrahedron at rest to a box, and adds the deformed positions of the clipped part to
/// bounds. map: barycentric map of the nodes at rest.
void AddClippedTetrahedron(const std::array<MovedPoint, 4>& nodes, const BarycentricMap& map,
  const IndexBounds& box, IndexBounds& bounds);

} // namespace deformvolume

#endif
