// SPDX-License-Identifier: BSD-3-Clause
#ifndef MeshSplitReference_h
#define MeshSplitReference_h

#include "MeshSplit.h"

#include <optional>

namespace physicsTesting
{

using SheetTriangles = std::vector<std::array<std::int64_t, 3>>;

/// Returns the expected result of SplitMesh(), found by exhaustive search. Returns nothing if a
/// segment between centroids touches an edge of the sheet, or ends on the sheet. The result is
/// exact if coordinates are multiples of 2^-16 and differ by less than 16.
std::optional<deformvolume::MeshSplit> SplitMeshSlowly(const std::vector<glm::dvec3>& positions,
  const std::vector<deformvolume::Tetrahedron>& tetrahedra, const std::vector<glm::dvec3>& points,
  const SheetTriangles& triangles, const std::vector<deformvolume::TetrahedronPair>& unparted);

} // namespace physicsTesting

#endif
