// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFaceNeighbors_h
#define DeformVolumeFaceNeighbors_h

#include "Tetrahedron.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

class AbortCheck;

/// The faces of tetrahedra that have the same nodes. Face 4 * t + k is the face of tetrahedron t
/// that is opposite its node k.
class FaceNeighbors
{
public:
  /// tetrahedra: at most 2^30, with nodes from 0 to numberOfNodes - 1. The time is proportional to
  /// the numbers of tetrahedra and nodes. abortCheck: checks for an abort; may be null.
  FaceNeighbors(const std::vector<Tetrahedron>& tetrahedra, std::size_t numberOfNodes,
    AbortCheck* abortCheck = nullptr);

  /// Returns the face of another tetrahedron with the same nodes, or `face` itself if there is
  /// none. More than two faces with the same nodes form a circular list.
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
