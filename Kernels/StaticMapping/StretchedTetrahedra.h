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
#include <functional>
#include <vector>

namespace deformvolume
{

class FadedLinks;

/// The tetrahedra of the sampling mesh that a deformation may stretch because their
/// vertices follow distant parts of the boundary of the deformation mesh. The links and faces are
/// those of FadedLinks.
class StretchedTetrahedra
{
public:
  /// A tetrahedron that may be stretched.
  struct Candidate
  {
    /// The numbers of its vertices in the volume.
    std::array<std::int64_t, 4> Vertices;
    /// The number of its cell in the volume.
    std::int64_t Cell;
    /// Its number in the cell.
    int Tetrahedron;
    /// The links of its vertices.
    std::array<VertexLink, 4> Links;
  };

  /// Finds the tetrahedra that may be stretched. spacing: of the volume, in world units.
  void Find(const Extent& voxels, const glm::dvec3& spacing,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
    const std::vector<TetrahedronFace>& faces, const std::vector<VertexLink>& links);

  /// Counts the tetrahedra that are stretched over more than 2 output voxels on an axis.
  /// displacements: three floats per node, in output voxels. isWhole: returns false for a
  /// tetrahedron that does not count; null: all count. Threads call it at the same time.
  std::int64_t Count(const FadedLinks& links, const std::vector<Tetrahedron>& tetrahedra,
    const float* displacements, const std::function<bool(const Candidate&)>& isWhole) const;
  /// Whether Count() returns an estimate from a sample, since many tetrahedra may be stretched.
  bool IsCountEstimated() const { return this->Step > 1; }

private:
  std::vector<Candidate> Candidates; // every Step-th of all
  std::int64_t Step = 1;
};

} // namespace deformvolume

#endif
