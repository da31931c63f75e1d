// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFading_h
#define DeformVolumeFading_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "FadedLinks.h"
#include "IndexBounds.h"
#include "OutsideVoxels.h"
#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <string>
#include <vector>

namespace deformvolume
{

/// Voxels outside a mesh or a field that stay where they are, but for those within a distance of
/// it. Throws an Error where the distance is none.
DEFORMVOLUME_EXPORT OutsideVoxels MakeKeptVoxels(double fadeDistance);

/// Whether space folds where the displacement of a border fades within FadeDistance: a warning, or
/// empty. border: what moves, in words, with the verb. longest: by how much.
DEFORMVOLUME_EXPORT std::string FindFoldsOfFading(
  const std::string& border, double longest, double fadeDistance);

/// What is wrong with how the displacement of a mesh fades outside it: tetrahedra between voxels
/// that follow distant parts of the boundary, and folds; else empty. displacements: of the nodes,
/// three floats each, in output voxels. spacing: of the output.
DEFORMVOLUME_EXPORT std::string FindFaultOfFading(const FadedLinks& links,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements, const glm::dvec3& spacing,
  double fadeDistance);

/// What is wrong with how a displacement fades outside a field: where the border of the field moves
/// by too much for FadeDistance, and any of a box is outside; else empty. box: in the indices that
/// the field takes. spacing: of the output.
DEFORMVOLUME_EXPORT std::string FindFaultOfFading(const DisplacementField& field,
  const IndexBounds& box, const glm::dvec3& spacing, double fadeDistance);

} // namespace deformvolume

#endif
