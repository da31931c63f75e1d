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

/// The tetrahedra of the sampling mesh, active or not, that a deformation may stretch because their
/// vertices follow distant parts of the boundary of the deformation mesh. The links and faces are
/// those of FadedLinks.
class StretchedTetrahedra
{
public:
  /// Finds the tetrahedra that may be stretched. spacing: of the volume, in world units.
  void Find(const Extent& voxels, const glm::dvec3& spacing,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
    const std::vector<TetrahedronFace>& faces, const std::vector<VertexLink>& links);

  /// Counts the tetrahedra that are stretched over more than 2 output voxels on an axis.
  /// displacements: three floats per node, in output voxels.
  std::int64_t Count(const FadedLinks& links, const std::vector<Tetrahedron>& tetrahedra,
    const float* displacements) const;
  /// Whether Count() returns an estimate from a sample, since many tetrahedra may be stretched.
  bool IsCountEstimated() const { return this->Step > 1; }

private:
  std::vector<std::array<VertexLink, 4>> Stretchable; // every Step-th candidate
  std::int64_t Step = 1;
};

} // namespace deformvolume

#endif
