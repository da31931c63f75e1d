// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStretchedTetrahedra_h
#define DeformVolumeStretchedTetrahedra_h

#include "BoundaryFaces.h"
#include "Extent.h"
#include "Tetrahedron.h"
#include "VertexLink.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace deformvolume
{

class FadedLinks;

/// The tetrahedra of the sampling mesh, active or not, that a deformation may stretch because they
/// reach from voxels to others that follow a distant part of the boundary of the deformation mesh.
/// Links are those of FadedLinks, whose faces are given beside them.
class StretchedTetrahedra
{
public:
  /// Finds those that may be stretched. spacing: the world distance of neighbours.
  void Find(const Extent& voxels, const glm::dvec3& spacing,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
    const std::vector<TetrahedronFace>& faces, const std::vector<VertexLink>& links);

  /// Those that are stretched over more than 2 output voxels on an axis. displacements: of the
  /// nodes, three floats each, in output voxels.
  std::int64_t Count(const FadedLinks& links, const std::vector<Tetrahedron>& tetrahedra,
    const float* displacements) const;
  /// Where many may be stretched, the number is an estimate from some of them.
  bool IsCountEstimated() const { return this->Step > 1; }

private:
  std::vector<std::array<VertexLink, 4>> Stretchable; // each Step-th of them
  std::int64_t Step = 1;
};

} // namespace deformvolume

#endif
