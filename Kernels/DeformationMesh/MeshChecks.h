// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshChecks_h
#define DeformVolumeMeshChecks_h

#include "Tetrahedron.h"
#include "VertexLink.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

// The kernels do not check indices: a wrong index would read outside a buffer. (CheckRuns() is in
// VertexRuns.h.)

/// Throws Error if a mesh has no tetrahedra, no nodes or more than 2^30 nodes, or if a tetrahedron
/// refers to a node that does not exist.
void CheckMesh(
  const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra, std::size_t numberOfNodes);

/// Throws Error if one of the tetrahedra begin to end - 1 refers to a node that does not exist.
void CheckTetrahedra(
  const Tetrahedron* tetrahedra, std::size_t begin, std::size_t end, std::size_t numberOfNodes);

/// Throws Error if one of `count` links refers to a tetrahedron that does not exist.
void CheckLinks(const VertexLink* links, std::int64_t count, std::size_t numberOfTetrahedra);

} // namespace deformvolume

#endif
