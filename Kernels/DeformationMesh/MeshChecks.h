// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshChecks_h
#define DeformVolumeMeshChecks_h

#include "Tetrahedron.h"
#include "VertexLink.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

// The kernels trust these indices: a wrong one would read beyond a buffer. (CheckRuns is in
// VertexRuns.h.)

/// Throws an Error where a mesh has no tetrahedra, no nodes or more than 2^30, or a tetrahedron has
/// a node that is none.
void CheckMesh(
  const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra, std::size_t numberOfNodes);

/// The same for some tetrahedra, from one number to before another.
void CheckTetrahedra(
  const Tetrahedron* tetrahedra, std::size_t begin, std::size_t end, std::size_t numberOfNodes);

/// Throws an Error where one of so many voxels is linked to a tetrahedron that is none.
void CheckLinks(const VertexLink* links, std::int64_t count, std::size_t numberOfTetrahedra);

} // namespace deformvolume

#endif
