// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronMatching_h
#define DeformVolumeTetrahedronMatching_h

#include "MappingUpdate.h"
#include "Tetrahedron.h"

#include <optional>
#include <vector>

namespace deformvolume
{

/// The tetrahedra that two lists have in common, by their nodes, in the same order in both: as many
/// as possible where others were removed, inserted or appended. Those that have changed places are
/// not among them. Nothing where more than one in eight is in one list only.
std::optional<std::vector<KeptTetrahedra>> MatchTetrahedra(
  const std::vector<Tetrahedron>& before, const std::vector<Tetrahedron>& after);

} // namespace deformvolume

#endif
