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

struct WorldMasks;

/// Returns the mode in which voxels outside a mesh or a field keep their positions, except within
/// fadeDistance, where the displacement of the border fades to 0. fadeDistance: in world units.
/// Throws an Error if it is not finite or negative.
DEFORMVOLUME_EXPORT OutsideVoxels MakeKeptVoxels(double fadeDistance);

/// Returns a warning if space may fold where the displacement of a border fades within
/// FadeDistance; otherwise "". border: subject and verb of the warning, for example "border of the
/// displacement field moves". longest: the longest displacement of the border, in world units.
DEFORMVOLUME_EXPORT std::string GetFoldWarning(
  const std::string& border, double longest, double fadeDistance);

/// Returns a warning about the fading of displacements outside a mesh: of possible folds, otherwise
/// of the number of tetrahedra between voxels that follow distant parts of the boundary. "" if
/// there is nothing to warn of. displacements: three floats per node, in output voxels. spacing:
/// the spacing of the output. masks: of the volume. Tetrahedra that are switched off, hidden,
/// carved out or divided by a smooth cut do not count.
DEFORMVOLUME_EXPORT std::string GetFadingWarning(const FadedLinks& links,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements, const glm::dvec3& spacing,
  double fadeDistance, const WorldMasks& masks);

/// Returns a warning if the border of a field moves by too much for FadeDistance, and a part of a
/// box is outside the field; otherwise "". box: in the indices that IndexToField of the field
/// takes. spacing: the spacing of the output.
DEFORMVOLUME_EXPORT std::string GetFadingWarning(const DisplacementField& field,
  const IndexBounds& box, const glm::dvec3& spacing, double fadeDistance);

} // namespace deformvolume

#endif
