// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFaceNeighbours_h
#define DeformVolumeFaceNeighbours_h

#include "Tetrahedron.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

class Watch;

/// What lies beyond the faces of tetrahedra. Face 4 t + k is that of tetrahedron t which is
/// opposite to its node k.
class FaceNeighbours
{
public:
  /// tetrahedra: at most 2^30, with nodes from 0 to numberOfNodes - 1. Takes time for these
  /// numbers. watch: asked now and then.
  FaceNeighbours(
    const std::vector<Tetrahedron>& tetrahedra, std::size_t numberOfNodes, Watch* watch = nullptr);

  /// The face of another tetrahedron that has the same nodes; the face itself where there is none.
  /// Where a mesh has more than two such faces, they follow each other in a ring.
  std::uint32_t GetNext(std::size_t face) const { return this->Next[face]; }
  /// Whether exactly two tetrahedra share a face.
  bool IsShared(std::size_t face) const
  {
    const std::uint32_t next = this->Next[face];
    return next != face && this->Next[next] == face;
  }
  std::size_t GetNumberOfFaces() const { return this->Next.size(); }

private:
  std::vector<std::uint32_t> Next;
};

} // namespace deformvolume

#endif
