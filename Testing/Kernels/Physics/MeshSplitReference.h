// SPDX-License-Identifier: BSD-3-Clause
#ifndef MeshSplitReference_h
#define MeshSplitReference_h

#include "MeshSplit.h"

#include <optional>

namespace physicsTesting
{

using SheetTriangles = std::vector<std::array<std::int64_t, 3>>;

/// What SplitMesh() shall give, by search through all: nothing where a segment meets an edge of the
/// sheet, or ends on it. Exact where coordinates are multiples of 2^-16 and their differences are
/// less than 16.
std::optional<deformvolume::MeshSplit> SplitMeshSlowly(const std::vector<glm::dvec3>& positions,
  const std::vector<deformvolume::Tetrahedron>& tetrahedra, const std::vector<glm::dvec3>& points,
  const SheetTriangles& triangles, const std::vector<deformvolume::TetrahedronPair>& unparted);

} // namespace physicsTesting

#endif
